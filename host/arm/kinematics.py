"""Forward and inverse kinematics of a planar arm. Angles rad, counter-clockwise; joint angles are relative, link directions a_i = q_1 + .. + q_i (paper D, (1) to (6))."""

import math

import numpy as np

from .model import Arm

_STEPS = 60  # of the numeric solution, at most
_STARTS = 24
_CLOSE = 1e-9


def directions(q):
    """Directions of the links, (..., n), from joint angles (..., n)."""
    return np.cumsum(q, axis=-1)


def points(arm: Arm, q) -> np.ndarray:
    """Joints and end, (..., n + 1, 2) m, the base first, for joint angles (..., n)."""
    a = directions(np.asarray(q, float))
    steps = np.stack((arm.lengths * np.cos(a), arm.lengths * np.sin(a)), axis=-1)
    base = np.zeros((*steps.shape[:-2], 1, 2)) + np.array(arm.base)
    return np.concatenate((base, np.array(arm.base) + np.cumsum(steps, axis=-2)), axis=-2)


def pose(arm: Arm, q) -> tuple[float, float, float]:
    """(x, y, angle) of the end: m and rad."""
    x, y = points(arm, q)[-1]
    return float(x), float(y), float(np.sum(q))


def inverse(arm: Arm, x: float, y: float, angle: float) -> list[np.ndarray]:
    """Joint angles that put the end at (x, y), its link pointing along `angle`: every branch, the one with arm.elbow's sign first; not wrapped to limits yet.

    Empty where the pose is out of reach. An arm of one joint takes the angle alone, and (x, y) must fit it to 1 mm; with two joints `angle` is not looked at; with
    more than three a few solutions out of infinitely many are found numerically.
    """
    x, y = x - arm.base[0], y - arm.base[1]
    n = arm.joints
    if n == 1:
        reached = math.hypot(arm.lengths[0] * math.cos(angle) - x, arm.lengths[0] * math.sin(angle) - y) < 1e-3
        return [np.array([angle])] if reached else []
    if n == 2:
        return [np.array(pair) for pair in _two_links(arm.lengths[0], arm.lengths[1], x, y, arm.elbow)]
    wrist = x - arm.lengths[-1] * math.cos(angle), y - arm.lengths[-1] * math.sin(angle)  # (4)
    if n == 3:
        return [np.array((q1, q2, angle - q1 - q2)) for q1, q2 in _two_links(arm.lengths[0], arm.lengths[1], *wrist, arm.elbow)]
    return _many_links(arm, wrist, angle)


def _two_links(first, second, x, y, elbow):
    """(5), (6): both branches, [(q1, q2)], the one whose q2 has elbow's sign first; one where the arm is stretched; none out of reach."""
    square = x * x + y * y
    cos2 = (square - first * first - second * second) / (2 * first * second)
    if abs(cos2) > 1 + _CLOSE:
        return []
    q2 = math.acos(max(-1.0, min(1.0, cos2)))
    found = []
    for sign in (elbow, -elbow) if q2 > 1e-12 else (1,):
        found.append((math.atan2(y, x) - math.atan2(second * math.sin(sign * q2), first + second * math.cos(q2)), sign * q2))
    return found


def _many_links(arm, wrist, angle):
    """Newton's method with damping from several starts, always the same ones, for the links before the last."""
    lengths = arm.lengths[:-1]
    if math.hypot(*wrist) > lengths.sum() + _CLOSE:
        return []
    random = np.random.default_rng(0)
    low, high = arm.low[:-1], arm.high[:-1]
    found: list[np.ndarray] = []
    for k in range(_STARTS):
        q = (low + high) / 2 if k == 0 else random.uniform(low, high)
        for _ in range(_STEPS):
            a = np.cumsum(q)
            error = np.array(wrist) - (lengths @ np.cos(a), lengths @ np.sin(a))
            if np.hypot(*error) < _CLOSE:
                break
            columns = np.array((-lengths * np.sin(a), lengths * np.cos(a)))
            jacobian = np.cumsum(columns[:, ::-1], axis=1)[:, ::-1]
            step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + 1e-6 * np.eye(2), error)
            q = np.clip(q + step * min(1.0, 0.5 / (np.abs(step).max() + 1e-12)), low, high)
        else:
            continue
        whole = np.append(q, angle - q.sum())
        if all(np.abs(whole - other).max() > 0.05 for other in found):
            found.append(whole)
    return sorted(found, key=lambda q: (q[1] * arm.elbow < 0, float(np.abs(q).sum())))


def within(arm: Arm, q, near=None) -> np.ndarray | None:
    """The same pose with each joint turned by whole turns into its limits, as near as possible to `near` (or the middle of the limits); None if one cannot be."""
    near = (arm.low + arm.high) / 2 if near is None else near
    turned = np.empty(arm.joints)
    for k, value in enumerate(q):
        turns = [value + 2 * math.pi * m for m in range(-3, 4) if arm.low[k] - _CLOSE <= value + 2 * math.pi * m <= arm.high[k] + _CLOSE]
        if not turns:
            return None
        turned[k] = min(turns, key=lambda v: abs(v - near[k]))
    return np.clip(turned, arm.low, arm.high)
