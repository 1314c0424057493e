"""host.map and host.floorplan: what people have becomes the board's map, and what is wrong with it is said."""

import json
import struct

import numpy as np
import pytest
from PIL import Image

from host import link
from host.floorplan import board_file, drawn, field, picture
from host.floorplan.errors import MapError
from host.map import check
from host.map.__main__ import main
from host.map.send import send
from host.twin.image import ROOT

HOUSE = ROOT / "maps" / "house.json"


def test_the_papers_house_is_readable_and_well():
    house = drawn.read(HOUSE)
    assert house.cells.shape == (30, 30) and [(d.x, d.y, d.normal, d.width) for d in house.doors] == [(4650, 6450, 90, 900)]
    assert house.at(1805.5, 2800) == (9, 6) and house.at(7150, 5005) == (16, 23)
    assert check.faults(house) == []
    assert struct.unpack_from("<4sBBBB", board_file.encode(house)) == (b"GSMP", 1, 30, 30, 1)


def test_the_field_shows_the_walls_where_they_are():
    house = drawn.read(HOUSE)
    spacing, nodes = field.best(house.walls, house.pixel, board_file.spacings(*house.size))
    y = np.arange(700.0, 5800, 37)
    for x, far in ((300, 0), (4500, 0), (4800, 0), (8700, 0), (4450, 50), (4900, 100)):
        assert np.abs(field.interpolated(nodes, spacing, np.full_like(y, x), y) - far).max() < 6


ROWS = ["11111", "10001", "10001", "11111"]


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ([], "an object with"),
        ({"rows": ["11", "1"]}, "row 2 has 1 cells"),
        ({"rows": ["12", "11"]}, "row 1, column 2 is '2'"),
        ({"rows": ROWS, "cell": 5}, "cell is 5"),
        ({"rows": ROWS, "start": [1, 2]}, "start is [1, 2]"),
        ({"rows": ROWS, "roof": 1}, "unknown key roof"),
        ({"rows": ["1" * 60] * 40}, "the board holds 1600"),
    ],
)
def test_drawings_that_cannot_be_are_refused(values, said):
    with pytest.raises(MapError, match=said.replace("[", r"\[").replace("]", r"\]")):
        board_file.encode(drawn.parse(values, "x.json"))


def test_what_is_wrong_with_a_map_is_said(tmp_path, capsys):
    path = tmp_path / "bad.json"
    path.write_text(
        json.dumps(
            {
                "cell": 200,
                "rows": ["1111111", "1001001", "100x001", "1001001", "1111111"],
                "start": [300, 300, 0],
                "places": {"bed": [700, 300], "far": [9000, 1]},
            }
        )
    )
    assert main([str(path)]) == 1
    said = capsys.readouterr().out
    assert "door 1 at 700, 500 is 200 mm wide" in said and "bed at 700, 300 lies in a wall" in said and "far" not in said.split("wrong")[0]
    assert main([str(tmp_path / "none.json")]) == 2
    assert "cannot be read" in capsys.readouterr().err


def ros(folder, wide=240, high=160, resolution=0.05):
    """A map as the map_server writes them: grey is unknown, two rooms and a gap between."""
    grey = np.full((high, wide), 205, np.uint8)
    grey[20:140, 20:220] = 254
    grey[20:24, 20:220] = grey[136:140, 20:220] = 0
    grey[20:140, 20:24] = grey[20:140, 216:220] = 0
    grey[20:140, 118:122] = 0
    grey[70:90, 118:122] = 254
    Image.fromarray(grey).save(folder / "office.pgm")
    (folder / "office.yaml").write_text(
        f"image: office.pgm\nresolution: {resolution}\norigin: [-6.0, -4.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return folder / "office.yaml"


def test_a_map_of_ros_is_coarsened_to_what_the_board_holds(tmp_path, capsys):
    path = ros(tmp_path)
    assert main([str(path), "--output", str(tmp_path / "map.bin"), "--picture", str(tmp_path / "map.png")]) == 0
    said = capsys.readouterr().out
    assert "coarsened to cells of" in said and "pixels of 50 mm" in said
    house = picture.read(path)
    assert house.cells.size <= board_file.MOST_CELLS and house.origin == (-5000.0, -3000.0)
    assert (house.cells[house.at(2500, 3000)], house.cells[house.at(4950, 1000)]) == (1, 0)
    assert check.distances(house, house.at(2500, 3000))[house.at(7500, 3000)] > 0  # through the gap
    assert (tmp_path / "map.bin").read_bytes() == board_file.encode(house)


def test_a_picture_has_its_doors_in_a_colour(tmp_path):
    rgb = np.full((60, 100, 3), 255, np.uint8)
    rgb[:2] = rgb[-2:] = 0
    rgb[:, :2] = rgb[:, -2:] = 0
    rgb[:, 49:51] = 0
    rgb[20:38, 49:51] = 200, 30, 30
    Image.fromarray(rgb).save(tmp_path / "flat.png")
    with pytest.raises(MapError, match="needs flat.json"):
        picture.read(tmp_path / "flat.png")
    (tmp_path / "flat.json").write_text(json.dumps({"mm_per_pixel": 50, "start": [1000, 1500, 0], "places": {"sofa": [4000, 1500]}}))
    house = picture.read(tmp_path / "flat.png")
    assert len(house.doors) == 1 and (house.doors[0].width, house.doors[0].normal) == (900, 90)
    assert check.faults(house) == []


def test_a_map_is_sent_to_the_board_and_a_damaged_one_is_not_kept():
    data = board_file.encode(drawn.read(ROOT / "maps" / "three-rooms.json"))
    with link.connect("twin:Z?speed=max&autostart=0") as robot:
        robot.begin()
        assert robot.wait_for("hello", 30)
        assert "counts from the next start" in send(robot, data)
        with pytest.raises(MapError, match="is no map"):
            send(robot, b"NOPE" + data[4:])
