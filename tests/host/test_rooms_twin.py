"""Rooms as they are, through the whole firmware in the twin: what is closed is remembered, what is gone is forgotten, and one false beam stops nobody.

A few seeds of what `python -m host.experiments.rooms` does with many.
"""

import statistics
from math import inf

import numpy as np
import pytest

from host.experiments.rooms import Dust, Effect, straight_out_s, under_way_s
from host.twin import Observer, courses, rooms, run

QUICK = dict(chip=inf, record=False)


@pytest.mark.parametrize(("width", "length"), [(450, 2500), (560, 3500)])
def test_out_of_a_blind_alley_backward(width, length):
    results = [run("alley", width, length=length, seed=seed, limit_s=40, **QUICK) for seed in (1, 2, 3)]
    assert [(result.result, result.contacts) for result in results] == [("pass", 0)] * 3
    assert statistics.median(under_way_s(result) / straight_out_s(result) for result in results) <= 1.5


def test_a_hallway_is_left_by_its_open_end_not_by_its_blind_arms():
    result = run(rooms.hallway(3), seed=3, **QUICK)  # it starts with its nose in an arm
    assert (result.result, result.contacts) == ("pass", 0)


def test_an_arm_that_opens_later_is_left_by_it():
    """What was found closed is closed until it changes: the alley's end goes while the robot looks on."""

    class Opens(Observer):
        def step(self, simulation):
            if simulation.now > 9e6 and len(simulation.scene.walls.segments) == len(course.segments):
                gone = np.delete(course.segments, 1, axis=0)
                simulation.scene.walls.__init__(gone)

    closed = courses.make("alley", 560, length=3500)
    # The mouth is shut, and its end is opened after a while.
    walls = np.vstack([closed.segments[:3], [(-280, 0, 280, 0), (-280, 3500, -2500, 3500), (280, 3500, 2500, 3500), (-2500, 6500, 2500, 6500)]])
    course = courses.Course("opens", 560, walls, closed.floor, (0.0, 2200.0, 0.0), (0.0, 4000.0, 0.0, 2500.0))
    result = run(course, seed=1, watch=Opens(), limit_s=60, **QUICK)
    assert (result.result, result.contacts) == ("pass", 0)


def test_one_false_beam_in_a_hundred_costs_little_and_three_stop_nobody():
    clean, one, three = ([run("Z", 600, seed=seed, watch=Dust(share), limit_s=80, **QUICK) for seed in (1, 2, 3)] for share in (0, 0.01, 0.03))
    assert {(r.result, r.contacts) for r in clean + one + three} == {("pass", 0)}
    assert sum(map(under_way_s, one)) <= 1.3 * sum(map(under_way_s, clean))


def test_the_longest_distance_for_no_return_is_not_taken_for_free():
    far = Effect(lambda signals, counts, bearings: (signals, np.where(counts == 0, 8000 * 4, counts)))
    result = run("Z", 550, seed=1, watch=far, limit_s=80, **QUICK)
    assert (result.result, result.contacts) == ("pass", 0)


def test_a_post_on_the_robot_itself_is_the_robot():
    def post(signals, counts, bearings):
        own = np.abs(bearings - 30) < 1.5
        return np.where(own, 90, signals), np.where(own, 224 * 4, counts)

    result = run("Z", 600, seed=1, watch=Effect(post), limit_s=80, **QUICK)
    assert (result.result, result.contacts) == ("pass", 0)


def test_a_sector_left_out_does_not_stop_it():
    """A cable that hangs 400 mm ahead to the left of the lidar, outside of the outline."""

    def cable(signals, counts, bearings):
        own = np.abs(bearings + 50) < 1.5
        return np.where(own, 90, signals), np.where(own, 400 * 4, counts)

    told = run("Z", 700, seed=1, watch=Effect(cable), changes={"lidar.left_out": [[-53, -47]]}, limit_s=60, **QUICK)
    assert (told.result, told.contacts) == ("pass", 0)
    not_told = run("Z", 700, seed=1, watch=Effect(cable), limit_s=12, **QUICK)
    assert not_told.result != "pass"


def test_people_who_have_left_are_forgotten():
    """They stand all round a robot that is held, in a hall wider than the lidar sees, and go: it drives off within 3 s."""
    angles = np.arange(0, 2 * np.pi, np.pi / 9)
    legs = [box_at(465 * np.sin(a), 620 * np.cos(a)) for a in angles]
    walls = np.array([(-9000, -9000, 9000, -9000), (9000, -9000, 9000, 9000), (9000, 9000, -9000, 9000), (-9000, 9000, -9000, -9000)], float)
    hall = courses.Course("hall", 18000, walls, walls[:, :2], (0.0, 0.0, 0.0), (0.0, 1500.0, 0.0, 9000.0))

    class Crowd(Observer):
        here = True

        def __init__(self):
            self.away = None

        def step(self, simulation):
            if simulation.now < 7e6:
                if self.here:
                    simulation.scene.walls.__init__(np.vstack([walls, *legs]))
                    self.here = False
            elif self.away is None:
                self.away = simulation.now
                simulation.scene.walls.__init__(walls)

    result = run(hall, seed=0, watch=Crowd(), limit_s=30, changes={"lidar.returns": 0}, **QUICK)
    assert (result.result, result.contacts) == ("pass", 0)
    drove = next(decision.time_us for decision in result.log if decision.time_us > 7e6 and decision.v > 95)
    assert drove < 10e6


def box_at(x, y, half=60.0):
    corners = np.array([(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)])
    return np.hstack([corners, np.roll(corners, -1, axis=0)])


@pytest.mark.parametrize("seed", [2, 5])
def test_nobody_who_crosses_or_comes_is_touched_by_its_own_motion(seed):
    """At 0.3 to 1.2 m/s: the robot stands while somebody is near, and goes on."""
    result = run(rooms.people(seed), seed=seed + 1, **QUICK)
    assert (result.result, result.contacts) == ("pass", 0)
    stood = [decision.time_us for decision in result.log if decision.why == 17 and decision.time_us > 2e6]  # reasons.BLOCKED
    assert stood and 0.3e6 < stood[-1] - stood[0] < 6e6
