"""The best time possible: known values, symmetry, and where there is no way."""

from math import inf, pi

import numpy as np
import pytest

from host.twin import best, courses, load_config
from host.twin.vehicle import Vehicle

VEHICLE = Vehicle.from_settings(load_config())
SPEED = 256.0


def corridor(length, width=600, wall=False):
    course = courses.corridor("straight", np.array([[0.0, 0.0], [0.0, length]]), width)
    if not wall:
        return course
    from dataclasses import replace

    return replace(course, segments=np.vstack([course.segments, [[-width / 2, length / 2, width / 2, length / 2]]]))


@pytest.mark.parametrize(
    "name, width, wanted",
    [("Z", 620, 10.9), ("Z", 550, 11.8), ("Z", 450, 13.3), ("Z", 430, 13.5), ("Z", 415, 13.9), ("U", 520, 17.1), ("S", 575, 17.6), ("S-sharp", 500, 19.0)],
)
def test_values_of_another_make(name, width, wanted, tmp_path):
    course = courses.make(name, width)
    travel = best.best(course, VEHICLE, tmp_path).from_pose(*course.start, best.outer_wheels(VEHICLE))
    assert travel / SPEED == pytest.approx(wanted, rel=0.03)


def test_straight_on_takes_what_the_way_is_long(tmp_path):
    course = corridor(1500)
    travel = best.best(course, VEHICLE, tmp_path).from_pose(*course.start, best.outer_wheels(VEHICLE))
    assert travel == pytest.approx(1500 + courses.START + courses.GOAL, abs=3)


def test_turned_by_half_a_turn_it_is_the_same(tmp_path):
    course = courses.make("Z", 550)
    found = best.best(course, VEHICLE, tmp_path)
    x, y, heading = course.start
    wheels = best.outer_wheels(VEHICLE)
    assert found.from_pose(x, y, heading + pi, wheels) == pytest.approx(found.from_pose(x, y, heading, wheels), rel=1e-6)


def test_no_way_through_a_wall_or_a_passage_too_narrow(tmp_path):
    for course in (corridor(1500, wall=True), courses.make("Z", 380)):
        assert best.best(course, VEHICLE, tmp_path).from_pose(*course.start, best.outer_wheels(VEHICLE)) == inf


def test_a_course_is_worked_out_once(tmp_path, monkeypatch):
    course = corridor(1500)
    first = best.best(course, VEHICLE, tmp_path)
    monkeypatch.setattr(best, "_make", lambda *_: pytest.fail("worked out again"))
    again = best.best(course, VEHICLE, tmp_path)
    assert np.array_equal(first.travel, again.travel) and again.step == first.step
    (kept,) = tmp_path.glob("*.npz")
    kept.write_bytes(b"cut short")
    monkeypatch.undo()
    assert np.array_equal(best.best(course, VEHICLE, tmp_path).travel, first.travel)
