"""Steerings that a wheel's limits forbid are no candidates. Loaded when the drive first refuses one, for hardly a robot has such limits.

There are few candidates, and their wheels' angles take some time to find: all are gone through at once, while the robot stands.
"""

from micropython import const

from planner.candidates import LENGTHS
from planner.move_cost import NOTHING

_MIRRORINGS = const(4)
_MIRRORING = const(6)  # of the job of move_cost.py
_FIRST = const(7)
_LAST = const(8)
_STRIDE = const(9)


class Barred:
    """Which candidates cannot be steered. As MoveCost.bar it takes them out of what has just been scored."""

    def __init__(self, candidates, drive):
        self._count = count = candidates.count
        self._barred = barred = bytearray(_MIRRORINGS * count)
        self.left = 0  # how many of those that turn can be steered: straight on every wheel can
        self._by = by = {}  # how many each wheel forbids
        for mirroring in range(_MIRRORINGS):
            for k in range(count):
                wheel = drive.beyond(candidates.af_of(mirroring, k), candidates.ar_of(mirroring, k))
                if wheel >= 0:
                    barred[mirroring * count + k] = 1
                    by[wheel] = by.get(wheel, 0) + 1
                elif k < candidates.arcs and (k >= candidates.astern_first if mirroring & 2 else k < candidates.ahead_end):
                    self.left += 1

    def wheel(self):
        """Index of the wheel that forbids most; the first of several."""
        return max(sorted(self._by), key=self._by.get)

    def __call__(self, job, free, scores):
        barred = self._barred
        at = job[_MIRRORING] * self._count
        for k in range(job[_FIRST], job[_LAST], job[_STRIDE]):
            if barred[at + k]:
                free[k] = 0
                for i in range(LENGTHS * k, LENGTHS * (k + 1)):
                    scores[i] = NOTHING


def bar(robot):
    """Take out what cannot be steered. Text of what is wrong if nothing is left that turns the robot, else ""."""
    decision = robot.avoid.decision
    decision.move_cost.bar = barred = Barred(decision.candidates, robot.drive)
    if barred.left:
        return ""
    k = barred.wheel()
    config = robot.config
    axle, side = k // 2 + 1, "right" if k & 1 else "left"
    limits = config.servos_low[k] // 10, config.servos_high[k] // 10
    return "no steering is left that turns: axle %d %s may turn %d to %d degrees only (servos.low, servos.high)" % ((axle, side) + limits)
