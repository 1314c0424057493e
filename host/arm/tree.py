"""A way from one pose to another by a tree that grows from both ends (RRT-Connect, Kuffner and LaValle 2000): for scenes in which the genetic algorithm finds none.

It looks for joint angles at which the arm could rest all along: clear of obstacles, within its limits, no torque at rest over its limit. Gone slowly enough, stopping at each
corner, such a way is a valid trajectory, if not a cheap one.
"""

import math
from dataclasses import replace

import numpy as np

from . import check, clearance, dynamics, reach
from .model import Arm
from .problem import CLEARANCE

_STEP = 0.15  # rad, of the tree
_FINE = 0.02  # rad, between two looks at an edge
_NODES = 3000
_SPARE = 0.0015  # m of clearance, for what lies between two looks
_SHORTCUTS = 150
_SLOWEST = 40.0  # s for a stretch


def way(arm: Arm, obstacles, start, end, seed: int, clear: float = CLEARANCE) -> np.ndarray | None:
    """Corners (K, n) of a way, straight in the joints' angles between two of them; None if there is none, or it was not found."""
    random = np.random.default_rng(seed)
    wanted = clear + _SPARE
    trees: list[list] = [[(start, -1)], [(end, -1)]]
    if _edge(arm, obstacles, start, end, wanted):
        return np.array([start, end])
    for number in range(_NODES):
        grown = _extend(arm, obstacles, trees[0], random.uniform(arm.low, arm.high), wanted)
        while grown is not None and (step := _extend(arm, obstacles, trees[1], grown, wanted)) is not None:
            if np.abs(step - grown).max() < 1e-9:
                first, second = (trees[0], trees[1]) if number % 2 == 0 else (trees[1], trees[0])
                return _shorter(arm, obstacles, np.array(_back(first)[::-1] + _back(second)[1:]), random, wanted)
        trees.reverse()
    return None


def timed(arm: Arm, corners: np.ndarray) -> np.ndarray | None:
    """Times (K,) s at which the corners are reached, at rest in each; None where even slowly a limit is broken."""
    times = [0.0]
    for one, other in zip(corners[:-1], corners[1:]):
        span = max(float((np.abs(other - one) / arm.speeds).max()) * 1.9, 0.2)  # a quintic's highest speed is 1.875 times the mean
        while not _bears(arm, one, other, span):
            span *= 1.3
            if span > _SLOWEST:
                return None
        times.append(times[-1] + span)
    return np.array(times)


def as_reach(problem, way, told):
    """The Reach of (corners, times), at rest in each corner, with its figures."""
    corners, times = way
    rest = np.zeros_like(corners)
    made = reach.from_points(problem.arm, problem.obstacles, times, corners, rest, rest)
    return replace(made, told=check.check(made)[1] | {"way": "tree"} | told)


def _bears(arm, one, other, span):
    s = np.linspace(0, 1, 60)
    shape, first, second = 10 * s**3 - 15 * s**4 + 6 * s**5, 30 * s**2 - 60 * s**3 + 30 * s**4, 60 * s - 180 * s**2 + 120 * s**3
    d = (other - one)[:, None]
    a, ad, add = (np.cumsum(v, axis=0) for v in (one[:, None] + d * shape, d * first / span, d * second / span**2))
    return bool((np.abs(dynamics.torques(arm, a, ad, add)) <= 0.9995 * arm.torques[:, None]).all())


def _rests(arm, obstacles, q, wanted) -> np.ndarray:
    """(K,) whether the arm can rest at angles (K, n)."""
    a = np.cumsum(q, axis=1).T
    cos, sin = np.cos(a), np.sin(a)
    x, y = clearance.corners(arm, cos, sin)
    zero = np.zeros_like(a)
    torque = np.abs(dynamics.torques_from(arm, cos, sin, zero, zero))
    good = clearance.least(arm, x, y, cos, sin, obstacles) >= wanted
    return good & (torque <= 0.999 * arm.torques[:, None]).all(axis=0) & ((q >= arm.low) & (q <= arm.high)).all(axis=1)


def _edge(arm, obstacles, one, other, wanted) -> bool:
    """Whether all between two angles is free; of its ends what is not the tree's own: they may be nearer than is wanted between looks."""
    count = max(math.ceil(float(np.abs(other - one).max()) / _FINE), 1)
    return bool(_rests(arm, obstacles, one + np.linspace(0, 1, count + 1)[:, None] * (other - one), wanted).all())


def _extend(arm, obstacles, tree, goal, wanted):
    nodes = np.array([node for node, _ in tree])
    k = int(np.argmin(np.abs(nodes - goal).max(axis=1)))
    far = float(np.abs(goal - nodes[k]).max())
    if far < 1e-12:
        return None
    step = nodes[k] + (goal - nodes[k]) * min(1.0, _STEP / far)
    if not _edge(arm, obstacles, nodes[k], step, wanted):
        return None
    tree.append((step, k))
    return step


def _back(tree):
    """From the newest node of a tree to its root."""
    found, k = [], len(tree) - 1
    while k >= 0:
        node, k = tree[k]
        found.append(node)
    return found


def _shorter(arm, obstacles, corners, random, wanted):
    """Corners left out where there is a straight way past them."""
    for _ in range(_SHORTCUTS):
        if len(corners) < 3:
            break
        i, j = sorted(random.choice(len(corners), 2, replace=False))
        if j - i > 1 and _edge(arm, obstacles, corners[i], corners[j], wanted):
            corners = np.delete(corners, np.s_[i + 1 : j], axis=0)
    return corners
