"""Worlds from files: what is read, what is refused, and runs through the whole firmware in one of each kind."""

import json
import subprocess
import sys
from math import pi

import numpy as np
import pytest
from PIL import Image

from host.twin import cli, courses, run, worlds
from host.twin.scene import Encounters, Scene
from host.twin.world import World

HALLWAY = [[-400, -800, -400, 2600], [400, -800, 400, 2600], [-400, -800, 400, -800]]


def write(path, value):
    path.write_text(value if isinstance(value, str) else json.dumps(value))
    return str(path)


@pytest.fixture
def hallway(tmp_path):
    """The same hallway, 800 mm wide, closed behind the start, as an image with its YAML."""
    cells = np.full((80, 60), 254, np.uint8)  # 50 mm a cell, the top row first
    cells[:70, 20] = cells[:70, 39] = cells[69, 20:40] = 0
    cells[75:, :5] = 205  # unknown
    Image.fromarray(cells).save(tmp_path / "map.png")
    Image.fromarray(cells).save(tmp_path / "map.pgm")
    write(tmp_path / "map.yaml", "image: map.png\nresolution: 0.05\norigin: [-1.5, -2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")
    return tmp_path


def test_a_map_of_the_map_server_by_its_yaml_and_by_its_image(hallway):
    found = [worlds.load(hallway / name, start=(0, 0, 0)).segments for name in ("map.yaml", "map.png", "map.pgm")]
    assert len(found[0]) and all(np.array_equal(found[0], other) for other in found)
    inside = World(found[0])
    # Free between the cells 20 and 39, so from -450 to 450 mm, and from -1450 mm up.
    assert inside.ranges(np.zeros(3), np.zeros(3), np.array([pi / 2, -pi / 2, pi])) == pytest.approx([450, 450, 1450])
    assert worlds.load(hallway / "map.png", start=(0, 0, 0), scale=0.5).segments == pytest.approx(found[0] / 2)


def test_a_turned_origin_turns_the_map(hallway):
    text = (hallway / "map.yaml").read_text().replace("0.0]", "1.5707963267948966]")
    write(hallway / "map.yaml", text)
    low, high = worlds.extent(worlds.load(hallway / "map.png", start=(0, 0, 0)).segments)
    assert low == pytest.approx((-1500 - 4000, -2000 + 1000)) and high == pytest.approx((-1500 - 500, -2000 + 2000))


def test_borders_of_cells_are_joined_to_long_pieces():
    solid = np.zeros((4, 5), bool)
    solid[1, 1:4] = True
    pieces = {tuple(sorted([(a, b), (c, d)])) for a, b, c, d in worlds.outlines(solid)}
    assert pieces == {((2, 2), (5, 2)), ((2, 3), (5, 3)), ((2, 2), (2, 3)), ((5, 2), (5, 3))} or pieces == {
        ((1, 1), (4, 1)),
        ((1, 2), (4, 2)),
        ((1, 1), (1, 2)),
        ((4, 1), (4, 2)),
    }


WORLD = """<sdf version='1.6'><world name='default'>
<model name='ground'><link name='link'><collision name='c'><geometry><plane><size>100 100</size></plane></geometry></collision></link></model>
<model name='post'><pose>1 2 0.5 0 0 0</pose><link name='link'><collision name='c'><geometry><cylinder><radius>0.1</radius><length>1</length></cylinder>
</geometry></collision></link></model>
<model name='crate'><pose>-1 2 0 0 0 0</pose><link name='link'><pose>0.5 0 0 0 0 0</pose><collision name='c'><geometry><box><size>0.2 0.4 1</size></box></geometry>
</collision></link></model>
<state world_name='default'><model name='post'><pose>3 2 0.5 0 0 0</pose></model></state>
</world></sdf>"""


def test_a_gazebo_world_as_it_stands_in_its_state(tmp_path):
    layout = worlds.load(write(tmp_path / "w.world", WORLD), scale=0.5)
    low, high = worlds.extent(layout.segments)
    assert low[0] == pytest.approx(-600 / 2) and high[0] == pytest.approx(3100 / 2)
    assert layout.start == (-1000, 1500, 0) and layout.goal == (-1000, 6500) and layout.reached == 500


def test_a_grid_of_cylinders(tmp_path):
    cells = np.zeros((4, 6))
    cells[1, 2] = 1
    np.save(tmp_path / "grid.npy", cells)
    low, high = worlds.extent(worlds.load(tmp_path / "grid.npy", start=(0, 0, 0)).segments)
    assert low == pytest.approx((150, 300)) and high == pytest.approx((300, 450))


@pytest.mark.parametrize(
    "name, text, said",
    [
        ("a.json", "{", "not JSON"),
        ("a.json", {"walls": []}, '"segments"'),
        ("a.json", {"segments": [[0, 0, 1]]}, "segments[0] is [0, 0, 1]; 4 numbers are needed"),
        ("a.json", {"segments": HALLWAY, "strat": [0, 0, 0]}, "'strat' is not known"),
        ("a.json", {"segments": HALLWAY}, "--start"),
        ("a.json", {"segments": []}, "no wall"),
        ("a.json", {"segments": HALLWAY, "moving": [{"size": [1, 1], "path": [[1, 0, 0], [1, 5, 5]]}]}, "times must rise"),
        ("a.json", {"segments": HALLWAY, "moving": [{"size": [1], "path": [[1, 0, 0]]}]}, "moving[0].size"),
        ("a.yaml", "resolution: x", "is no map"),
        ("a.yaml", "a: [", "not YAML"),
        ("a.pgm", "P5", "must lie beside it"),
        ("a.world", "<sdf>", "not a Gazebo world"),
        ("a.npy", "nothing", "not an array"),
        ("missing.json", None, "cannot be read: No such file"),
        ("missing.png", None, "no such file"),
    ],
)
def test_what_cannot_be_read_is_said_in_a_line(tmp_path, name, text, said, capsys):
    path = str(tmp_path / name) if text is None else write(tmp_path / name, text)
    assert cli.main([path, "--json"]) == 2
    error = capsys.readouterr().err
    assert said in error and name in error and error.count("\n") == 1


def test_what_belongs_to_the_other_kind_of_course_is_refused(tmp_path, capsys):
    path = write(tmp_path / "a.json", HALLWAY)
    for arguments, said in [
        ([path, "--start=0,0,0", "--width=500"], "width"),
        (["Z", "--start=0,0,0"], "start"),
        (["Z", "--length=900"], "length"),
        (["alley", "--length=90"], "900 to 20000"),
        ([path, "--start=380,0,0"], "stands in a wall"),
    ]:
        assert cli.main(arguments) == 2
        assert said in capsys.readouterr().err


def test_alley_is_closed_ahead_and_out_is_700_mm_outside():
    course = courses.make("alley", length=3000)
    x, y, heading = course.start
    assert World(course.segments).ranges(np.array([x]), np.array([y]), np.array([heading])) == pytest.approx([450])
    assert not course.through(0, -690) and course.through(0, -710) and course.through(2000, -710)
    aside = courses.make("alley", side=True, mirror=True)
    assert World(aside.segments).ranges(np.zeros(1), np.zeros(1), np.array([pi])) == pytest.approx([2500])
    assert aside.through(-225 - 710, -225) and not aside.through(225 + 710, -225)


class Still:
    x = y = heading = now = 0.0
    fastest = 0.0


def test_contacts_of_a_robot_that_stands_are_counted_apart():
    path = {"size": [300, 300], "path": [[0, 2000, 0], [4, -2000, 0]]}
    course = courses.Course("a", 1, np.array(HALLWAY, float), np.zeros((0, 2)), (0, 0, 0), None, moving=(worlds.mover(path, "m"),))
    scene, body = Scene(course), Still()
    ahead = scene.ranges(np.zeros(1), np.zeros(1), np.array([pi / 2]))
    assert ahead == pytest.approx([400])  # the wall; the box is behind it
    met = Encounters(scene, body, 125, 300)
    for ms in range(0, 4000, 10):
        body.now = ms * 1000.0
        scene.at(body.now)
        met.look()
    assert len(met.touched_by) == 1 and not met.touches
    # 275 mm from centre to centre where they meet, at 1 mm a ms
    assert met.touched_by[0].time == pytest.approx(1_725_000, abs=10_000)
    body.fastest = 100.0
    scene.at(2e6)
    met.look()
    assert len(met.touches) == 1


def test_a_run_in_a_map_and_one_with_a_box_that_moves(hallway, tmp_path, capsys):
    result = run(str(hallway / "map.png"), start=(0, -1000, 0), goal=(0, 1400), seed=1, record=str(tmp_path / "run.rec"))
    assert (result.result, result.contacts) == ("pass", 0)
    replayed = subprocess.run([sys.executable, "-m", "host.replay", str(tmp_path / "run.rec")], capture_output=True, text=True)
    assert replayed.returncode == 0, replayed.stdout + replayed.stderr
    moving = [{"size": [300, 300], "path": [[0, -3000, 900], [6, 3000, 900]], "again": True}]
    path = write(tmp_path / "box.json", {"segments": HALLWAY, "start": [0, -400, 0], "goal": [0, 2600], "moving": moving})
    assert cli.main([path, "--json", "--no-record", "--seed=1", f"--picture={tmp_path / 'box.png'}", "--limit=4"]) == 1
    figures = json.loads(capsys.readouterr().out)
    assert figures["reason"] == "4 s are over" and figures["touched_by"] >= 0 and (tmp_path / "box.png").stat().st_size
