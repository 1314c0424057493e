"""Touching a wall, being held by it, and getting away."""

import pytest

from host.twin.contact import HELD, RESOLUTION, TOUCH, Contact
from host.twin.world import World

STEP_US = 10_000.0


class Slider:
    """A body of 250 x 600 mm that is pushed about by hand."""

    def __init__(self, x, y):
        self.x, self.y, self.heading = x, y, 0.0
        self.now, self.count, self.fastest = 0.0, 1, 0.0

    def put_back(self, count, pose):
        self.x, self.y, self.heading = pose


def push(body, contact, dx, dy, steps):
    """Move by (dx, dy) mm in each of so many steps of 10 ms."""
    for _ in range(steps):
        body.fastest = (dx * dx + dy * dy) ** 0.5 * 1e6 / STEP_US
        body.x += dx
        body.y += dy
        body.now += STEP_US
        body.count += 1
        contact.follow(STEP_US)


def beside_a_wall(room):
    """A wall along y on the right, so far from the body."""
    body = Slider(0.0, 0.0)
    wall = 125.0 + room
    return body, Contact(World([(wall, -5000, wall, 5000)]), body, 125, 300)


def test_driving_past_is_no_contact():
    body, contact = beside_a_wall(20)
    push(body, contact, 0, 3, 200)
    assert contact.touches == []
    assert contact.nearest == pytest.approx(20)


def test_the_least_clearance_is_remembered():
    body, contact = beside_a_wall(50)
    push(body, contact, 1, 0, 30)
    push(body, contact, -1, 0, 30)
    assert contact.nearest == pytest.approx(20, abs=RESOLUTION)
    assert contact.clearance() == pytest.approx(50)


def test_scraping_is_one_contact_and_the_run_goes_on():
    body, contact = beside_a_wall(10)
    push(body, contact, 1, 3, 15)
    push(body, contact, 0, 3, 100)
    assert len(contact.touches) == 1
    assert contact.nearest == pytest.approx(-5)
    assert contact.refused is None
    assert body.y == pytest.approx(345)


def test_a_second_contact_counts_when_the_first_was_over():
    body, contact = beside_a_wall(10)
    for _ in range(2):
        push(body, contact, 1, 0, 15)
        push(body, contact, -1, 0, 15)
    assert len(contact.touches) == 2


def test_a_wall_holds_what_goes_deeper():
    body, contact = beside_a_wall(10)
    push(body, contact, 3, 0, 100)
    assert -TOUCH <= contact.nearest < 0
    assert -TOUCH <= contact.clearance() < 0
    assert contact.refused == body.now
    assert contact.held_us > 0.8e6


def test_what_is_held_can_go_back():
    body, contact = beside_a_wall(10)
    push(body, contact, 3, 0, 50)
    push(body, contact, -3, 0, 20)
    assert contact.clearance() == pytest.approx(10 - body.x)
    assert body.x < -HELD
    assert contact.held_us == 0


def test_fast_steps_do_not_jump_over_a_wall():
    body, contact = beside_a_wall(10)
    push(body, contact, 14, 0, 60)  # more than full speed
    assert body.x < 10 + TOUCH
