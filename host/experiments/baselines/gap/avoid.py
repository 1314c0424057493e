"""Follow the gap, for a body taken to be a disc: the usual planner of round robots, on the long one.

Every point hides the bearings at which a disc of the radius would touch it; the widest run of bearings left is the gap, and the robot
steers for its middle, the more so the nearer the nearest point is. No gap: it stands.
Source: Sezer and Gokasan, A novel obstacle avoidance algorithm: Follow the Gap Method (2012), without its goal: straight ahead stands for it.
"""

from math import asin, atan2, pi, sqrt

from disc import radius, reach
from scanning import Scanning

from planner import reasons

_STEP = 3  # degrees a bearing
_SIDE = 40  # bearings to each side: 120 degrees
_LARGEST = 38  # degrees of steering
_WEIGHT = 300  # mm: so near the gap counts as much as straight ahead
_CRUISE = 108


class Avoid(Scanning):
    """In the place of the firmware's planner."""

    def __init__(self, config):
        super().__init__(config)
        self.radius = radius(config)
        self.range = reach(config)

    def decide(self):
        """Steer for the widest gap."""
        free = bytearray(b"\1" * (2 * _SIDE + 1))
        nearest = self.range
        for i in range(self.points_count):
            x, y = self.x_mm[i], self.y_mm[i]
            d = sqrt(x * x + y * y)
            if d < self.range:
                nearest = min(nearest, d - self.radius)
                bearing = atan2(x, y) * 180 / pi
                half = asin(self.radius / d) * 180 / pi if d > self.radius else 90
                first = max(int((bearing - half) // _STEP) + 1 + _SIDE, 0)
                last = min(int((bearing + half) // _STEP) + _SIDE, 2 * _SIDE)
                for k in range(first, last + 1):
                    free[k] = 0
        best, middle, run = 0, 0, 0
        for k in range(2 * _SIDE + 2):
            if k <= 2 * _SIDE and free[k]:
                run += 1
            else:
                if run > best:
                    best, middle = run, k - 1 - run / 2 + 0.5 - _SIDE
                run = 0
        if not best:
            self.take(0, 0, 90, reasons.BOXED)
            return
        weight = _WEIGHT / max(nearest, 10)
        angle = int(min(max(middle * _STEP * weight / (weight + 1), -_LARGEST), _LARGEST))
        self.take(angle, -angle, _CRUISE, reasons.BEND if angle else reasons.ON)
