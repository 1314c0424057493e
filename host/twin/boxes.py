"""Boxes scattered at random over a field between two walls."""

import numpy as np

COUNT = 9
SIDES = 120.0, 420.0
CLEAR = 400.0  # no box reaches so far down to the entrance: the body starts with its front at 250
BAY = 450.0, 350.0  # width and depth of the place in the middle of the other end that stays free for who enters there
TRIES = 60


def scatter(size, gap, random):
    """Corners of up to nine boxes, (m, 4, 2), in a field of `size` (width, length) with walls on its left and right.

    Each is at least `gap` from every other, and at least `gap` from a wall or touching it.
    """
    width, length = size
    boxes: list[np.ndarray] = []
    for _ in range(COUNT):
        for _ in range(TRIES):
            box = _box(random, width, length)
            if _fits(box, boxes, gap, width, length):
                boxes.append(box)
                break
    return np.array(boxes).reshape(-1, 4, 2)


def _box(random, width, length):
    a, b = random.uniform(*SIDES, 2) / 2
    turn = random.uniform(0, np.pi)
    s, c = np.sin(turn), np.cos(turn)
    corners = np.array([(-a, -b), (a, -b), (a, b), (-a, b)])
    return corners @ np.array([(c, s), (-s, c)]) + (random.uniform(0, width), random.uniform(0, length))


def _fits(box, others, gap, width, length):
    if box[:, 1].min() < CLEAR or box[:, 1].max() > length:
        return False
    across, depth = BAY
    if box[:, 1].max() > length - depth and box[:, 0].min() < (width + across) / 2 and box[:, 0].max() > (width - across) / 2:
        return False
    for room in (box[:, 0].min(), width - box[:, 0].max()):
        if 0 < room < gap:
            return False
    return all(distance(box, other) >= gap for other in others)


def distance(first, second):
    """Distance between two convex polygons, (n, 2) and (m, 2) corners; 0 when they overlap."""
    if not _separated(first, second):
        return 0.0
    return min(_corner_distance(first, second), _corner_distance(second, first))


def _separated(first, second):
    for polygon in (first, second):
        sides = np.roll(polygon, -1, axis=0) - polygon
        for normal in np.stack([sides[:, 1], -sides[:, 0]], axis=1):
            a, b = first @ normal, second @ normal
            if a.max() < b.min() or b.max() < a.min():
                return True
    return False


def _corner_distance(corners, polygon):
    """Least distance from the corners of one polygon to the sides of another."""
    starts = polygon
    sides = np.roll(polygon, -1, axis=0) - polygon
    relative = corners[:, None] - starts
    along = np.clip((relative * sides).sum(-1) / (sides**2).sum(-1), 0, 1)
    return np.sqrt(((relative - along[..., None] * sides) ** 2).sum(-1).min())
