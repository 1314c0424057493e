"""Courses: walls where the specification has them."""

from math import hypot, pi

import numpy as np
import pytest

from host.twin import boxes, courses
from host.twin.world import World


def room(course, heading_offset=0.0):
    x, y, heading = course.start
    return World(course.segments).clearance(x, y, heading + heading_offset, 125, 300)[0]


def test_z_walls_are_the_mitred_offset_curves():
    course = courses.make("Z", 550)
    points = {tuple(np.round(p, 6)) for p in course.segments.reshape(-1, 2)}
    # Right wall of the first leg ends in the inner corner, 275 mm below and right of the bend.
    for point in [(0, -700), (550, -700), (0, 1065), (550, 515), (1610, 1065), (2160, 515), (1610, 2480), (2160, 2480)]:
        assert point in points
    assert len(course.segments) == 7  # three on each side and the closed entrance


def test_start_and_goal_of_the_reference_courses():
    for name, start, goal in [
        ("Z", (275, -50, 0), (1885, 1630, 0)),
        ("U", (1885, 1630, pi), (275, 1630, 0)),
        ("S", (3600, 1400, -pi / 2), (-50, 1350, -pi / 2)),
    ]:
        course = courses.make(name, 550)
        assert course.start == pytest.approx(start)
        assert course.goal[:3] == pytest.approx(goal)
        assert room(course) == pytest.approx(150)


def test_u_is_through_only_on_the_exit_side():
    course = courses.make("U", 550)
    assert not course.through(1885, 1700)
    assert not course.through(275, 1600)
    assert course.through(275, 1640)


def test_sharp_s_moves_one_corner():
    a, b = courses.centre_line("S", 550), courses.centre_line("S-sharp", 550)
    assert (a != b).sum() == 1
    assert b[2, 0] == 2520


def test_walls_are_half_a_width_from_the_centre_line():
    for name in ("Z", "U", "S", "S-sharp", "bend"):
        line = courses.centre_line(name, 500, angle=70)
        for side in (250, -250):
            wall = courses.offset(line, side)
            for p, q, a, b in zip(line, line[1:], wall, wall[1:]):
                along = (q - p) / hypot(*(q - p))
                for corner in (a, b):
                    relative = corner - p
                    assert abs(along[0] * relative[1] - along[1] * relative[0]) == pytest.approx(250)


def test_mirror_and_reverse():
    plain, mirrored = courses.make("Z", 550), courses.make("Z", 550, mirror=True)
    assert mirrored.start[0] == pytest.approx(2160 - plain.start[0])
    turned = courses.make("Z", 550, reverse=True)
    assert turned.start[:2] == pytest.approx((1885, 1630))
    assert turned.start[2] == pytest.approx(pi)
    assert [room(mirrored), room(turned)] == pytest.approx([150, 150])


def test_bend_of_90_degrees_has_the_legs_of_z():
    assert courses.centre_line("bend", 550, 90) == pytest.approx(courses.centre_line("Z", 550) - (275, 0))


def test_entrance_is_closed_and_exit_is_open():
    course = courses.make("Z", 550)
    x, y, heading = course.start
    world = World(course.segments)
    behind = world.ranges(np.array([x]), np.array([y]), np.array([heading + pi]))[0]
    assert behind == pytest.approx(650)
    gx, gy, heading, _ = course.goal
    assert world.ranges(np.array([gx]), np.array([gy]), np.array([heading]))[0] > 1e6


@pytest.mark.parametrize("seed", range(12))
def test_random_keeps_its_gaps_and_a_free_start(seed):
    course = courses.make("random", gap=450, seed=seed)
    assert len(course.boxes) <= 9
    for i, box in enumerate(course.boxes):
        assert all(boxes.distance(box, other) >= 450 for other in course.boxes[:i])
        for wall in (box[:, 0].min(), 1500 - box[:, 0].max()):
            assert wall <= 0 or wall >= 450
    for entered in (course, courses.make("random", gap=450, seed=seed, reverse=True)):
        assert room(entered) > 90
        assert room(entered, np.radians(5)) > 60


def test_random_depends_on_the_seed_alone():
    one, two, other = (courses.make("random", gap=450, seed=seed).segments for seed in (3, 3, 4))
    assert np.array_equal(one, two)
    assert one.shape != other.shape or not np.array_equal(one, other)


@pytest.mark.parametrize("name", courses.NAMES)
def test_the_scale_is_that_of_the_area_not_of_the_width(name):
    one, two = (courses.make(name, 500, gap=300, scale=scale) for scale in (1, 1.5))
    line = [np.array([course.start[:2], course.goal[:2]]) for course in (one, two)]
    ends = 1.5 * np.diff(line[0], axis=0), np.diff(line[1], axis=0)
    # What lies before the start and behind the goal does not grow.
    assert np.abs(ends[0] - ends[1]).max() < 700
    assert np.hypot(*(ends[1] - ends[0] / 1.5).T) > 300
    assert two.width == (500 if name != "random" else 2250)


@pytest.mark.parametrize(
    "settings, said",
    [
        (dict(name="Q"), "courses are"),
        (dict(name="Z", width=100), "width 100 .*accepted"),
        (dict(name="bend", angle=5), "angle 5 .*accepted"),
        (dict(name="Z", angle=80), "an angle is for the bend"),
        (dict(name="random", gap=1), "gap 1 .*accepted"),
        (dict(name="Z", scale=0.1), "scale 0.1 .*accepted"),
        (dict(name="U", width=900, scale=0.5), "make it narrower or the scale larger"),
    ],
)
def test_what_cannot_be_built_is_refused_with_what_can(settings, said):
    with pytest.raises(ValueError, match=said):
        courses.make(**settings)
