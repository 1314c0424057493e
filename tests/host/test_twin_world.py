"""Rays and contact against brute force."""

import numpy as np
import pytest

from host.twin.world import FAR, World


def test_rays_hit_the_nearest_wall():
    world = World([(-100, 500, 100, 500), (-100, 900, 100, 900), (300, -100, 300, 100)])
    zero = np.zeros(4)
    ranges = world.ranges(zero, zero, np.radians([0, 90, 180, -90]))
    assert ranges == pytest.approx([500, 300, FAR, FAR])


def test_a_ray_starts_where_it_is_sent_from():
    world = World([(-1000, 500, 1000, 500)])
    ranges = world.ranges(np.array([0.0, 200.0]), np.array([0.0, 100.0]), np.radians([60, -60]))
    assert ranges == pytest.approx([1000, 800])


def outline(x, y, heading, half_width, half_length, step=0.5):
    """Points all round a rectangle."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) * (half_width, half_length)
    sides = zip(corners, corners[1:])
    points = np.concatenate([a + np.linspace(0, 1, int(np.hypot(*(b - a)) / step) + 1)[:, None] * (b - a) for a, b in sides])
    s, c = np.sin(heading), np.cos(heading)
    return points @ np.array([(c, -s), (s, c)]) + (x, y)


def test_clearance_equals_brute_force():
    random = np.random.default_rng(4)
    for _ in range(60):
        segment = random.uniform(-900, 900, 4)
        x, y, heading = *random.uniform(-300, 300, 2), random.uniform(-4, 4)
        clearance, _ = World([segment]).clearance(x, y, heading, 125, 300)
        p, q = segment[:2], segment[2:]
        points = outline(x, y, heading, 125, 300)
        along = np.clip((points - p) @ (q - p) / ((q - p) @ (q - p)), 0, 1)
        distance = np.hypot(*(points - p - along[:, None] * (q - p)).T).min()
        if clearance > 0:
            assert clearance == pytest.approx(distance, abs=0.3)
        else:  # overlap: the outline crosses the segment, or the segment lies within
            s, c = np.sin(heading), np.cos(heading)
            dx, dy = (p + q) / 2 - (x, y)
            within = abs(dx * c - dy * s) < 125 and abs(dx * s + dy * c) < 300
            assert distance < 0.3 or within


def test_depth_is_the_shortest_way_out():
    wall = World([(-1000, 290, 1000, 290)])
    assert wall.clearance(0, 0, 0, 125, 300)[0] == pytest.approx(-10)
    corner = World([(119, 50, 500, 50), (119, 50, 119, -900)])  # an inner corner of a bend at the body's side
    assert corner.clearance(0, 0, 0, 125, 300)[0] == pytest.approx(-6)
    turned = World([(-1000, 1000, 1000, 1000)])
    reach = 125 * np.sin(0.3) + 300 * np.cos(0.3)
    assert turned.clearance(0, 1003 - reach, 0.3, 125, 300)[0] == pytest.approx(-3)


def test_the_nearest_wall_is_named():
    world = World([(-1000, 400, 1000, 400), (-1000, -350, 1000, -350)])
    assert world.clearance(0, 0, 0, 125, 300) == (pytest.approx(50), 1)
