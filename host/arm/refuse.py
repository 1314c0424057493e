"""What is impossible, and why, said before anything is searched: out of reach, joint limit, collision at rest, torque at rest over its limit."""

import math

import numpy as np

from . import clearance, dynamics, kinematics
from .errors import ArmError
from .model import Arm

Pose = tuple[float, float, float]  # m, m, rad


def place(arm: Arm, where: str, wanted: Pose, obstacles, clear: float, near=None) -> list[np.ndarray]:
    """Joint angles at which the arm can rest in a pose, the wanted branch first. ArmError says why there are none."""
    x, y, angle = wanted
    words = f"{where} ({1000 * x:g}, {1000 * y:g}) mm at {math.degrees(angle):g} deg"
    branches = kinematics.inverse(arm, x, y, angle)
    if not branches:
        raise ArmError(f"{words}: out of reach: {_reach(arm, wanted)}")
    good, reasons = [], []
    for q in branches:
        turned = kinematics.within(arm, q, near)
        why = limit_reason(arm, q) if turned is None else rest_reason(arm, turned, obstacles, clear)
        if turned is None or why:
            reasons.append(why)
        else:
            good.append(turned)
    if not good:
        raise ArmError(f"{words}: {'; or, with the elbow the other way, '.join(dict.fromkeys(reasons))}")
    return good


def joints(arm: Arm, where: str, degrees, obstacles, clear: float) -> list[np.ndarray]:
    """As place(), for joint angles in degrees."""
    if len(degrees) != arm.joints:
        raise ArmError(f"{where}: {len(degrees)} angles for an arm of {arm.joints} joints")
    q = np.radians(degrees)
    why = limit_reason(arm, q, turn=False) or rest_reason(arm, q, obstacles, clear)
    if why:
        raise ArmError(f"{where}: {why}")
    return [q]


def _reach(arm, wanted):
    x, y, angle = wanted[0] - arm.base[0], wanted[1] - arm.base[1], wanted[2]
    if arm.joints == 1:
        return (
            f"with one joint the end lies at ({1000 * arm.lengths[0] * math.cos(angle):.0f}, {1000 * arm.lengths[0] * math.sin(angle):.0f}) mm for that angle"
        )
    inner = arm.lengths
    what, far = "the end", math.hypot(x, y)
    if arm.joints > 2:
        inner = arm.lengths[:-1]
        what, far = "the last joint would", math.hypot(x - arm.lengths[-1] * math.cos(angle), y - arm.lengths[-1] * math.sin(angle))
    low, high = max(2 * inner.max() - inner.sum(), 0.0), inner.sum()
    return f"{what} lie{'s' if arm.joints < 3 else ''} {1000 * far:.0f} mm from the base, and it can be {1000 * low:.0f} .. {1000 * high:.0f} mm away"


def limit_reason(arm: Arm, q, turn: bool = True) -> str:
    """The first joint that would have to leave its limits; "" if none. turn: whether whole turns are free."""
    for k, value in enumerate(q):
        tries = [value + 2 * math.pi * m for m in range(-3, 4)] if turn else [value]
        if not any(arm.low[k] - 1e-9 <= one <= arm.high[k] + 1e-9 for one in tries):
            shown = min(tries, key=lambda one: max(arm.low[k] - one, one - arm.high[k]))
            return (
                f"joint {k + 1} would stand at {math.degrees(shown):.1f} deg, its limits are {math.degrees(arm.low[k]):.1f} .. {math.degrees(arm.high[k]):.1f}"
            )
    return ""


def rest_reason(arm: Arm, q, obstacles, clear: float) -> str:
    """Why the arm cannot rest there; "" if it can."""
    a = np.cumsum(q)[:, None]
    cos, sin = np.cos(a), np.sin(a)
    x, y = clearance.corners(arm, cos, sin)
    for number, obstacle in enumerate(obstacles, 1):
        distance = float(clearance.least(arm, x, y, cos, sin, (obstacle,))[0])
        if distance < clear:
            kind = type(obstacle).__name__.lower().replace("halfplane", "half plane")
            how = f"a link is {-1000 * distance:.0f} mm inside" if distance < 0 else f"a link is {1000 * distance:.1f} mm from"
            return f"collision: {how} obstacle {number} ({kind}); {1000 * clear:g} mm are kept"
    torque = np.abs(dynamics.at_rest(arm, q))
    for k in range(arm.joints):
        if torque[k] > arm.torques[k]:
            return f"joint {k + 1} needs {torque[k]:.2f} N m to hold it at rest, its limit is {arm.torques[k]:g}"
    return ""


def pairs(arm: Arm, starts: list[np.ndarray], ends: list[np.ndarray]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Which start goes with which end, the most promising first: the first branch of the start, and an end that keeps its elbow."""

    def rank(pair):
        start, end = pair[1]
        flips = arm.joints > 1 and (start[1] < 0) != (end[1] < 0)
        return (pair[0][0] > 0, flips, float(np.abs(end - start).sum()))

    numbered = [((i, j), (start, end)) for i, start in enumerate(starts) for j, end in enumerate(ends)]
    return [pair for _, pair in sorted(numbered, key=rank)]
