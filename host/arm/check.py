"""An independent look at a trajectory, whoever made it. It shares the reading of files with the planner and nothing else: the curve is sampled in time instead of at nodes,
links are points a millimetre apart instead of segments, torques come from Lagrange's matrices instead of from forces.
"""

import math

import numpy as np

from . import dynamics
from .problem import CLEARANCE, NODES, WEIGHTS
from .reach import Reach
from .scenes import Box, Disc

_STEP_S = 0.002
_POINT_M = 0.001
_INSIDE = 9  # places looked at between two points, at least
_SLACK = 1e-6  # of rounding
_REST = math.radians(0.5)  # rad/s: the fastest that counts as rest


def check(reach: Reach, wanted: float = CLEARANCE, step_s: float = _STEP_S) -> tuple[list[str], dict]:
    """(what is wrong, one line each; figures). Nothing is wrong where the list is empty."""
    arm = reach.arm
    when = np.linspace(0, reach.total, max(round(reach.total / step_s), 50) + 1)
    inside = reach.times[:-1, None] + np.diff(reach.times)[:, None] * np.linspace(0, 1, _INSIDE)  # a jump may hide between two steps
    when = np.unique(np.concatenate((when, inside.ravel())))
    q, qd, qdd = reach.at(when)
    wrong: list[str] = []
    _limits(reach, when, q, qd, wrong)
    torque = np.array([_torque(arm, *state) for state in zip(q, qd, qdd)])
    over = np.maximum(np.abs(torque) - arm.torques, 0)
    for k in range(arm.joints):
        t = int(np.argmax(over[:, k]))
        if over[t, k] > arm.torques[k] * _SLACK:
            wrong.append(f"joint {k + 1}: torque {torque[t, k]:.2f} N m at {when[t]:.2f} s, its limit is {arm.torques[k]:g}")
    clear, where = _clearance(reach, q)
    if clear < wanted - _SLACK:
        wrong.append(f"{1000 * clear:.2f} mm from obstacle {where[1] + 1} at {when[where[0]]:.2f} s; {1000 * wanted:g} mm are to be kept")
    tips = np.sum(arm.lengths * np.exp(1j * np.cumsum(q, axis=1)), axis=1)
    figures: dict = {
        "time_s": round(reach.total, 4),
        "travel_rad": round(float(np.abs(np.diff(q, axis=0)).sum()), 4),
        "path_m": round(float(np.abs(np.diff(tips)).sum()), 4),
        "clearance_m": round(clear, 6) if math.isfinite(clear) else None,
        "torque_over_nm": round(float(over.mean(axis=0).sum() * NODES), 4),
    }
    parts = (figures["torque_over_nm"], figures["travel_rad"], figures["path_m"], figures["time_s"])
    return wrong, {"cost": round(sum(w * part for w, part in zip(WEIGHTS, parts)), 4), **figures}


def _limits(reach, when, q, qd, wrong):
    arm = reach.arm
    for k in range(arm.joints):
        beyond = np.maximum(arm.low[k] - q[:, k], q[:, k] - arm.high[k])
        t = int(np.argmax(beyond))
        if beyond[t] > _SLACK:
            low, high = math.degrees(arm.low[k]), math.degrees(arm.high[k])
            wrong.append(f"joint {k + 1}: {math.degrees(q[t, k]):.2f} deg at {when[t]:.2f} s, its limits are {low:.1f} .. {high:.1f}")
        t = int(np.argmax(np.abs(qd[:, k])))
        if abs(qd[t, k]) > arm.speeds[k] * (1 + _SLACK):
            wrong.append(f"joint {k + 1}: {math.degrees(qd[t, k]):.1f} deg/s at {when[t]:.2f} s, its limit is {math.degrees(arm.speeds[k]):.1f}: a jump?")
    for words, speeds in (("begins", reach.qd[0]), ("ends", reach.qd[-1])):
        if np.abs(speeds).max() > _REST:
            wrong.append(f"it {words} while moving: {math.degrees(np.abs(speeds).max()):.1f} deg/s; rest is needed")
    for k, one in enumerate(arm.extra):
        values = reach.extra[:, k]
        if values.min() < one["low_deg"] - _SLACK or values.max() > one["high_deg"] + _SLACK:
            wrong.append(f"{one['name']}: {values.min():g} .. {values.max():g} deg, its limits are {one['low_deg']:g} .. {one['high_deg']:g}")
        fastest = 1.5 * np.abs(np.diff(values) / np.diff(reach.times)).max()
        if fastest > one["speed_deg_s"] * (1 + _SLACK):
            wrong.append(f"{one['name']}: {fastest:.1f} deg/s, its limit is {one['speed_deg_s']:g}: a jump?")


def _torque(arm, q, qd, qdd):
    inertia, coriolis, gravity = dynamics.matrices(arm, q, qd)
    return inertia @ qdd + coriolis @ qd + gravity


def _clearance(reach, q):
    """(least distance m, (place in q, number of the obstacle))."""
    arm = reach.arm
    base = complex(*arm.base)
    joints = base + np.concatenate((np.zeros((len(q), 1)), np.cumsum(arm.lengths * np.exp(1j * np.cumsum(q, axis=1)), axis=1)), axis=1)
    least, where = math.inf, (0, 0)
    for number, obstacle in enumerate(reach.obstacles):
        stands = _distance(obstacle, np.array([base]))[0] < 0.01  # what the base stands on: of link 1 only the far end counts
        for i in range(arm.joints):
            shares = np.linspace(0, 1, max(math.ceil(arm.lengths[i] / _POINT_M), 1) + 1)
            if stands and i == 0:
                shares = shares[-1:]
            for t in range(0, len(q), 256):
                z = joints[t : t + 256, i, None] + (joints[t : t + 256, i + 1, None] - joints[t : t + 256, i, None]) * shares
                distance = _distance(obstacle, z).min(axis=1) - arm.radii[i]
                k = int(np.argmin(distance))
                if distance[k] < least:
                    least, where = float(distance[k]), (t + k, number)
    return least, where


def _distance(obstacle, z):
    """Signed distance of points (complex) from an obstacle."""
    away = z - complex(obstacle.x, obstacle.y)
    if isinstance(obstacle, Disc):
        return np.abs(away) - obstacle.radius
    away = away * np.exp(-1j * obstacle.angle)
    if isinstance(obstacle, Box):
        x, y = np.abs(away.real) - obstacle.width / 2, np.abs(away.imag) - obstacle.height / 2
        return np.hypot(np.maximum(x, 0), np.maximum(y, 0)) + np.minimum(np.maximum(x, y), 0)
    return away.real
