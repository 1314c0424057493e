"""The arm's planner: cost and violations on cases made by hand, what it finds, what it refuses, and the independent check."""

import json
import math
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from host.arm import check, cli, model, reach, refuse, scenes, search, tree
from host.arm.errors import ArmError
from host.arm.problem import Guard, Problem

ROOT = Path(__file__).resolve().parents[2]
PAPER = model.load("paper-3r")


def _problem(name="paper-1", **changes):
    scene = scenes.scene(name)
    start = refuse.place(PAPER, "start", scene.start, scene.obstacles, 0.003)[0]
    end = refuse.place(PAPER, "end", scene.end, scene.obstacles, 0.003)[0]
    return replace(Problem(PAPER, start, end, scene.obstacles), **changes)


def _one_joint(torque=1000.0, obstacles=(), mass=2.0):
    arm = model.read({"joints": [{"length_mm": 500, "mass_kg": mass, "low_deg": -10, "high_deg": 190, "speed_deg_s": 90, "torque_nm": torque}]})
    return Problem(arm, np.array([0.0]), np.array([math.pi]), obstacles, intervals=200)


def test_cost_by_hand():
    """Half a turn of one link of 0.5 m in 4 s: travel pi, path half a circle; torque at the start m g L, over a limit of nothing."""
    problem = _one_joint()
    genes = np.array([[math.pi / 2, 15 / 8 * math.pi / 4, 2.0, 2.0]])  # the node in the middle, with the speed of a quintic there
    found = problem.look(genes)
    assert found.travel[0] == pytest.approx(math.pi, rel=1e-6)
    assert found.path[0] == pytest.approx(math.pi / 2, rel=1e-4)
    assert found.over[0] == 0 and found.clearance[0] == np.inf
    assert found.cost[0] == pytest.approx(2 * math.pi + math.pi + 4, rel=1e-4)
    assert found.load[0] == pytest.approx(2 * 9.81 * 0.5 / 1000, rel=0.2)
    assert found.valid()[0]


def test_torque_over_its_limit_does_not_weigh_more_on_a_finer_grid():
    weak = _one_joint(torque=5.0)
    genes = np.array([[math.pi / 2, 1.0, 4.0, 4.0]])
    coarse, fine = weak.look(genes, 50), weak.look(genes, 1000)
    assert coarse.over[0] == pytest.approx(fine.over[0], rel=0.05) and coarse.over[0] > 1
    assert not coarse.valid()[0]
    assert _one_joint(torque=20.0).look(genes).valid()[0]


@pytest.mark.parametrize(("radius", "free"), [(0.39, True), (0.41, False)])
def test_what_meets_an_obstacle_has_fitness_0(radius, free):
    """A disc that a link of 0.5 m, turning over the top, passes at 0.1 m or cuts."""
    problem = _one_joint(obstacles=(scenes.Disc(0.0, 0.9, radius),))
    found = problem.look(np.array([[math.pi / 2, 1.0, 3.0, 3.0]]))
    assert found.clearance[0] == pytest.approx(0.4 - radius, abs=1e-4)
    assert bool(found.valid()[0]) == free
    assert np.isfinite(problem.strict(found)[0]) == free


def test_limits_of_angle_and_speed():
    problem = _one_joint()
    assert problem.look(np.array([[math.pi / 2, 1.7, 1.0, 1.0]])).speed[0] > 0  # half a turn in 2 s at most 90 deg/s
    assert problem.look(np.array([[math.pi + 0.3, 0.0, 4.0, 4.0]])).angle[0] == pytest.approx(0.3 - math.radians(10), abs=1e-3)
    assert not problem.look(np.array([[math.pi + 0.3, 0.0, 4.0, 4.0]])).valid()[0]


@pytest.mark.parametrize(("name", "seed"), [("paper-1", 0), ("paper-2", 0)])
def test_the_papers_experiments(name, seed):
    plan = search.plan(_problem(name), search.Options(seed=seed))
    assert plan.found is not None and plan.found.cost[0] <= 16.50  # the paper's: 17.19 and 18.49
    paper = {"paper-1": (4.0013, 3.4612, 3.1343), "paper-2": (3.9325, 4.1246, 3.1535)}[name]
    for found, most in zip((plan.found.time, plan.found.travel, plan.found.path), paper):
        assert found[0] <= most
    whole = reach.of_plan(plan.problem, plan.genes, plan.found, {})
    wrong, figures = check.check(reach.from_dict(json.loads(json.dumps(reach.as_dict(whole)))))
    assert wrong == []
    assert figures["cost"] == pytest.approx(whole.told["cost"], abs=0.005)
    assert figures["clearance_m"] == pytest.approx(whole.told["clearance_m"], abs=2e-5)


def test_the_same_seed_finds_the_same():
    options = search.Options(seed=3, generations=5, limit_s=60)
    one, other = (search.plan(_problem(), replace(options, method="ga")) for _ in range(2))
    assert one.history == other.history and len(one.history) == 6


def test_roulette_takes_the_cheap_more_often():
    histories = {}
    for selection in ("tournament", "roulette"):
        histories[selection] = search.plan(_problem("free"), search.Options("ga", selection, seed=1, generations=40)).history
        costs = [row[1] for row in histories[selection]]
        assert costs[-1] < costs[0] - 2 and all(b <= a + 1e-9 for a, b in zip(costs, costs[1:]))  # the best is kept
    assert histories["tournament"] != histories["roulette"]


def test_a_guard_makes_the_nodes_stricter():
    problem = _problem()
    genes = search.plan(problem, search.Options(generations=20)).genes
    found = problem.look(genes[None])
    assert problem.led(found)[0] == pytest.approx(found.cost[0])
    guarded = replace(problem, guard=Guard(0.05, 0.05))
    assert guarded.led(guarded.look(genes[None]))[0] > found.cost[0] + 1


def _plan(*arguments):
    return cli.main(["plan", *arguments])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--from", "2600,0,0", "--to", "-2000,500,190"), "start (2600, 0) mm at 0 deg: out of reach: the last joint would lie 2100 mm from the base"),
        (("--scene", "paper-1", "--to", "2400,0,0"), "end (2400, 0) mm at 0 deg: joint 1 needs 51.50 N m to hold it at rest, its limit is 45"),
        (("--scene", "paper-1", "--obstacle", "-2000,500,100"), "end (-2000, 500) mm at 190 deg: collision: a link is 100 mm inside obstacle 2 (disc)"),
        (("--scene", "paper-1", "--to", "300,-1800,-90"), "joint 1 would stand at"),
        (("--from", "500,2000,100"), "no end: give --to"),
        (("--scene", "paper-1", "--arm", "nothing.json"), "nothing.json: cannot be read"),
        (("--scene", "paper-1", "--from-joints", "1,2"), "start: 2 angles for an arm of 3 joints"),
        (("--scene", "paper-1", "--from-joints", "207,0,0"), "start: joint 1 would stand at 207.0 deg"),
    ],
)
def test_what_is_impossible_is_said_before_it_searches(arguments, words, capsys, monkeypatch):
    monkeypatch.setattr(search, "plan", None)
    assert _plan(*arguments, "--json") == 2
    told = capsys.readouterr()
    assert words in told.err and words in json.loads(told.out)["refused"]
    assert told.err.count("\n") == 1


def test_options_that_are_none_are_refused(capsys):
    for arguments in (("--from", "1,2"), ("--method", "luck"), ("--seed", "-1"), ("--obstacle", "nan,0,1"), ("--limit-time", "0")):
        with pytest.raises(SystemExit) as caught:
            _plan("--scene", "paper-1", *arguments)
        assert caught.value.code == 2
    assert "X,Y,ANGLE is needed" in capsys.readouterr().err


def test_plan_writes_what_it_tells(tmp_path, capsys):
    out, csv = tmp_path / "reach.json", tmp_path / "curves.csv"
    assert _plan("--scene", "paper-2", "--generations", "20", "--json", "--out", str(out), "--csv", str(csv)) == 0
    told = json.loads(capsys.readouterr().out)
    written = json.loads(out.read_text())
    assert {key: written[key] for key in told} == told
    assert {"cost", "time_s", "travel_rad", "path_m", "clearance_m", "torque_over_nm", "seconds"} <= set(told)
    rows = csv.read_text().splitlines()
    assert rows[0].startswith("time_s,angle_deg_1") and rows[0].endswith("x_mm,y_mm")
    assert [float(v) for v in rows[1].split(",")[-2:]] == pytest.approx([500, 2000], abs=0.01)
    assert [float(v) for v in rows[-1].split(",")[-2:]] == pytest.approx([-2000, 500], abs=0.01)
    assert cli.main(["check", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["valid"]


def test_time_limit_and_no_way(tmp_path, capsys):
    """A wall that no link can pass: it says what the best still breaks."""
    arguments = ("--scene", "paper-1", "--box", "-800,1500,100,3000", "--limit-time", "2", "--json")
    assert _plan(*arguments) == 1
    told = capsys.readouterr()
    assert "inside an obstacle" in json.loads(told.out)["why"] and "no valid trajectory" in told.err


def test_ctrl_c_keeps_the_best_so_far(tmp_path):
    out = tmp_path / "reach.json"
    command = [sys.executable, "-m", "host.arm", "plan", "--scene", "paper-1", "--method", "ga", "--generations", "100000", "--out", str(out)]
    search_at_work = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    for line in search_at_work.stderr:
        if "nothing violated" in line:
            break
    search_at_work.send_signal(signal.SIGINT)
    said, _ = search_at_work.communicate(timeout=20)
    assert search_at_work.returncode == 0 and "broken off by Ctrl-C" in said
    assert check.check(reach.read(out))[0] == []


def test_a_check_of_its_own_finds_what_is_wrong():
    plan = search.plan(_problem("paper-2"), search.Options(generations=30))
    good = reach.as_dict(reach.of_plan(plan.problem, plan.genes, plan.found, {}))

    def wrong_with(change):
        values = json.loads(json.dumps(good))
        change(values)
        return " / ".join(check.check(reach.from_dict(values))[0])

    assert wrong_with(lambda v: None) == ""
    assert "mm from obstacle 4" in wrong_with(lambda v: v["obstacles"].append({"disc": [-900, 1150, 100]}))
    assert "torque" in wrong_with(lambda v: v["arm"]["joints"][1].update(torque_nm=10))
    assert "its limits are" in wrong_with(lambda v: v["arm"]["joints"][0].update(high_deg=150))
    assert "deg/s at" in wrong_with(lambda v: v["arm"]["joints"][0].update(speed_deg_s=20))
    assert "begins while moving" in wrong_with(lambda v: v["points"][0].update(speeds_deg_s=[5, 0, 0]))

    def jump(v):
        v["points"].insert(1, json.loads(json.dumps(v["points"][0])))
        v["points"][1]["time_s"] = 0.002
        v["points"][1]["angles_deg"][0] += 10

    assert "a jump?" in wrong_with(jump)


def _bad(tmp_path, text):
    (tmp_path / "reach.json").write_text(text)
    with pytest.raises(ArmError) as caught:
        reach.read(tmp_path / "reach.json")
    assert "\n" not in str(caught.value) and "reach.json" in str(caught.value)
    return str(caught.value)


def test_bad_files_are_refused(tmp_path):
    two = {"format": reach.FORMAT, "arm": PAPER.source, "points": [{"time_s": 0, "angles_deg": [90, 0, 0]}, {"time_s": 2, "angles_deg": [100, 0, 0]}]}
    whole = json.dumps(two)
    (tmp_path / "reach.json").write_text(whole)
    assert check.check(reach.read(tmp_path / "reach.json"))[0] == []  # speeds and accelerations may be left out
    assert "cut off" in _bad(tmp_path, whole[: len(whole) // 2])
    assert "NaN is no number" in _bad(tmp_path, whole.replace("100", "NaN"))
    assert "points[1].time_s = 0" in _bad(tmp_path, whole.replace('"time_s": 2', '"time_s": 0'))
    assert "time goes back" in _bad(tmp_path, whole.replace('"time_s": 2', '"time_s": 0'))
    assert "points[0].time_s = 1: 0 is needed" in _bad(tmp_path, whole.replace('"time_s": 0', '"time_s": 1'))
    assert "points[1].angles_deg: a list of 3" in _bad(tmp_path, whole.replace("[100, 0, 0]", "[100, 0]"))
    assert "format" in _bad(tmp_path, whole.replace(reach.FORMAT, "gcode"))
    assert "arm: joints" in _bad(tmp_path, json.dumps(two | {"arm": {"name": "x"}}))
    assert "unknown key speed" in _bad(tmp_path, whole.replace('"time_s": 2', '"speed": 1, "time_s": 2'))
    assert "obstacles[0]" in _bad(tmp_path, json.dumps(two | {"obstacles": [{"ball": [1, 2, 3]}]}))
    assert "2 .. 5000" in _bad(tmp_path, json.dumps(two | {"points": two["points"][:1]}))


def test_where_the_genetic_algorithm_finds_none_a_tree_finds_a_way():
    """Slowly from corner to corner: valid by the check of its own."""
    obstacles = (scenes.Disc(0.9, 1.25, 0.2),)
    strong = json.loads(json.dumps(PAPER.source))
    for joint in strong["joints"]:
        joint["torque_nm"] = 200
    arm = model.read(strong)
    start, end = np.radians([20, 20, 10]), np.radians([100, -40, 20])
    corners = tree.way(arm, obstacles, start, end, 1)
    assert corners is not None and (corners[0] == start).all() and (corners[-1] == end).all() and len(corners) > 2
    times = tree.timed(arm, corners)
    made = tree.as_reach(Problem(arm, start, end, obstacles), (corners, times), {})
    assert check.check(made)[0] == [] and made.told["way"] == "tree"
    walled = (scenes.Box(0.9, 1.25, 0.1, 9),)
    assert tree.way(arm, walled, start, end, 1) is None


def test_an_arm_of_every_number_of_joints_is_planned_for(capsys, tmp_path):
    for joints in (1, 2, 4, 6):
        one = {"length_mm": 1200 // joints, "mass_kg": 0.2, "low_deg": -150, "high_deg": 150, "speed_deg_s": 120, "torque_nm": 50}
        path = tmp_path / f"arm{joints}.json"
        path.write_text(json.dumps({"joints": [one] * joints}))
        ends = [",".join(str(v) for v in [first] + [second] * (joints - 1)) for first, second in ((40, 20 / joints), (100, -20 / joints))]
        assert _plan("--arm", str(path), "--from-joints", ends[0], "--to-joints", ends[1], "--floor", "-100", "--generations", "10", "--json") == 0
        assert json.loads(capsys.readouterr().out)["cost"] < 20
