"""The whole firmware in the twin: a lidar that answers and sees nothing, a robot that does not move as its wheels do, and no fault where there is none."""

from math import inf

import numpy as np
import pytest

from host.twin import courses, run

FAULT = 13  # planner/reasons.py
REVOLUTION_MS = 1000 / 6.6
# From the fault to still wheels, ms. A scan that repeats itself is known for one when it has come twice.
BLIND = 1.5 * REVOLUTION_MS
TWICE = 3 * REVOLUTION_MS
HELD = 1500


@pytest.mark.parametrize(
    ("fault", "most_ms"),
    [
        ("lidar-frozen", BLIND),
        ("lidar-stuck", TWICE),
        ("lidar-blind", BLIND),
        ("lidar-far", BLIND),
        ("lidar-near", BLIND),
        ("lidar-half", BLIND),
        ("lidar-front", BLIND),
        ("lidar-hole", 2.1 * REVOLUTION_MS),
        ("slip", HELD),
        ("slip-half", HELD),
        ("reversed", HELD),
        ("side-dead", HELD),
        ("held", HELD),
    ],
)
def test_it_stands_in_time(fault, most_ms):
    result = run("random", gap=380, seed=2, fault=f"{fault}@7", chip=inf, record=False)
    outcome = result.fault
    assert outcome.still_ms is not None and outcome.still_ms <= most_ms
    if fault.startswith("lidar"):
        assert outcome.touched_after == 0  # one that does not go where it is steered may meet a wall before it notices
    assert outcome.driven_after_s < 4, "backed out once at the most"
    assert result.log[-1].why == FAULT


def test_with_its_cover_on_it_never_starts():
    outcome = run("Z", 550, fault="lidar-covered", chip=inf, record=False).fault
    assert (outcome.still_ms, outcome.driven_after_s, outcome.touched_after) == (0, 0, 0)


@pytest.mark.parametrize(("width", "seed"), [(600, 0), (500, 2)])
def test_glass_ahead_is_not_driven_into(width, seed):
    outcome = run("Z", width, seed=seed, fault="lidar-glass", chip=inf, record=False).fault
    assert outcome.touched_after == 0


def faults_of(result):
    """Decisions for a fault after the start, when trust has been earned."""
    return [decision for decision in result.log if decision.why == FAULT and decision.time_us > 4e6]


@pytest.mark.parametrize(
    ("course", "settings"),
    [
        ("Z", dict(width=550, seed=1)),
        ("Z", dict(width=430, seed=9)),
        ("U", dict(width=560, seed=4)),
        ("S", dict(width=560, seed=2)),
        ("random", dict(gap=300, seed=5)),
        ("Z", dict(width=600, seed=3, mode="naws")),
    ],
)
def test_no_fault_where_there_is_none(course, settings):
    result = run(course, chip=inf, record=False, **settings)
    assert result.result == "pass"
    assert faults_of(result) == []


def test_dead_servos_are_noticed_by_how_the_robot_turns():
    outcome = run("Z", 550, seed=1, fault="servos-dead@6", chip=inf, record=False, limit_s=14).fault
    assert outcome.still_ms is not None and outcome.still_ms <= HELD and outcome.touched_after == 0


def test_a_frame_lost_now_and_then_stops_nothing():
    result = run("random", gap=380, seed=2, fault="lidar-lost@3", chip=inf, record=False, limit_s=16)
    assert result.fault.driven_after_s > 5 and faults_of(result) == [] and not result.contacts


def hall(far):
    """A square room, `far` mm from its middle to each wall; the robot stands in the middle."""
    walls = np.array([[-far, -far, far, -far], [far, -far, far, far], [far, far, -far, far], [-far, far, -far, -far]])
    return courses.Course("Z", 2 * far, walls, walls[:, :2], (0.0, 0.0, 0.0), (0.0, 3000.0, 0.0, far))


@pytest.mark.parametrize(("far", "returns", "passes"), [(5000.0, 20, True), (9000.0, 0, True), (9000.0, 20, False)])
def test_halls(far, returns, passes):
    result = run(hall(far), changes={"lidar.returns": returns}, chip=inf, limit_s=30, record=False)
    assert (result.result == "pass") == passes
    assert (faults_of(result) == []) == passes
