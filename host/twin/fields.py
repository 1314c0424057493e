"""Fields of cylinders, made as those of the BARN data set are: a grid filled at random and smoothed by a cellular automaton.

D. Perille, A. Truong, X. Xiao, P. Stone, Benchmarking Metric Ground Navigation, 2020. Lengths in mm; the same seed gives the same field. Not every field can be passed:
`best.seconds` says.
"""

from dataclasses import replace

import numpy as np

from . import courses

CELL, RADIUS = 150.0, 75.0  # at scale 1
ACROSS, ALONG = 30, 30
SCALE = 0.6
_SIDES = 12
_BEFORE = 1000.0  # free floor before the field, and behind it


def cells(seed):
    """(ALONG, ACROSS) bool: where a cylinder stands. A fifth to a third of the cells at first, then one to three rounds: one with five neighbours or more stands, one
    with less than two goes."""
    random = np.random.default_rng([seed, 41])
    filled = random.random((ALONG, ACROSS)) < random.uniform(0.15, 0.3)
    for _ in range(int(random.integers(1, 4))):
        padded = np.pad(filled, 1)
        shifts = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
        count = np.sum([np.roll(padded, shift, (0, 1)) for shift in shifts], axis=0)[1:-1, 1:-1]
        filled = (filled & (count >= 2)) | (count >= 5)
    return filled


def field(seed, scale=SCALE):
    """The Course of a seed: a straight corridor as wide as the field, which stands in its middle."""
    size = CELL * scale
    width, length = ACROSS * size, ALONG * size
    course = courses.corridor("field", np.array([[width / 2, 0.0], [width / 2, length + 2 * _BEFORE]]), width)
    turn = np.arange(_SIDES) * 2 * np.pi / _SIDES
    circle = RADIUS * scale * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    boxes = np.array([circle + ((i + 0.5) * size, _BEFORE + (j + 0.5) * size) for j, i in np.argwhere(cells(seed))]).reshape(-1, _SIDES, 2)
    sides = [np.hstack([box, np.roll(box, -1, axis=0)]) for box in boxes]
    return replace(course, segments=np.vstack([course.segments, *sides]), boxes=boxes)
