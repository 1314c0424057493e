"""What planners without a memory share: the points of the latest revolution, in the body frame, and the attributes of a decision.

In the place of the firmware's own planner; see docs/architecture.md for the interface.
"""

from array import array

from core.trig import cos14, sin14
from perception.windows import NO_ZONE, Windows
from planner import reasons

_FRAMES = 64
_EACH = 80
_MOST = 448
_NO_POINT = 32767
LOOK_AHEAD = 700  # mm: serves these best


class Scanning:
    """Gathers frames; an heir has `decide()`, called once a revolution, which sets af, ar (0.1 deg) and v."""

    def __init__(self, config):
        self.config = config
        self.windows = Windows(config, _MOST)
        self.x_mm = array("h", bytes(2 * _MOST))
        self.y_mm = array("h", bytes(2 * _MOST))
        self.points_window = self.windows.window
        self.points_count = 0
        self.points_ordered = True
        self.points_x = array("H", bytes(2 * _MOST))  # as the windows want them, mm + 8192
        self.points_y = array("H", bytes(2 * _MOST))
        self._frames = config.lidar_frames
        self._x = array("h", bytes(2 * _FRAMES * _EACH))
        self._y = array("h", bytes(2 * _FRAMES * _EACH))
        self._n = bytearray(_FRAMES)
        self._slot = 0
        self._due = 2 * self._frames
        self._reach = LOOK_AHEAD + config.robot_length // 2
        self.af = 0
        self.ar = 0
        self.v = 90
        self.mode = 0
        self.window = 0
        self.zone = NO_ZONE
        self.free = 0
        self.block_x = _NO_POINT
        self.block_y = _NO_POINT
        self.why = reasons.WAITING
        self.decisions = 0
        self.decision = self
        self.busy = False  # nothing to do at once, between revolutions

    def frame(self, lidar, odometry):
        """Take in one measurement frame, in the place of the one a revolution ago."""
        at = self._slot * _EACH
        m = 0
        for i in range(lidar.n):
            d = lidar.distances[i] >> 2
            if d:
                a = lidar.bearings[i]
                x = d * sin14(a) >> 14
                y = d * cos14(a) >> 14
                if -self._reach <= x <= self._reach and -self._reach <= y <= self._reach:
                    self._x[at + m] = x
                    self._y[at + m] = y
                    m += 1
        self._n[self._slot] = m
        self._slot = (self._slot + 1) % self._frames
        if self._due:
            self._due -= 1

    def guard(self, odometry, speed):
        """Between revolutions nothing is looked at."""
        return False

    def observe(self, odometry, why, af, ar, v):
        """Somebody else decides."""
        self.why = why
        self.af, self.ar, self.v = af, ar, v

    def step(self, odometry):
        """True once a revolution, when there is a new decision."""
        if self._due:
            return False
        self._due = self._frames
        n = 0
        for slot in range(self._frames):
            for i in range(slot * _EACH, slot * _EACH + self._n[slot]):
                if n < _MOST:
                    self.points_x[n] = self._x[i] + 8192
                    self.points_y[n] = self._y[i] + 8192
                    n += 1
        self.points_count = n
        self.window = self.windows.sort(self.points_x, self.points_y, n)  # changes their order
        for i in range(n):
            self.x_mm[i] = self.points_x[i] - 8192
            self.y_mm[i] = self.points_y[i] - 8192
        self.zone = self.windows.zone()
        self.decide()
        self.decisions += 1
        return True

    def within(self, windows, zones):
        """Number of points in any of the zones of any of the windows."""
        found = 0
        for i in range(self.points_count):
            if self.points_window[i] in windows and self.windows.zone_of(self.x_mm[i], self.y_mm[i]) in zones:
                found += 1
        return found

    def take(self, af, ar, v, why):
        """Decide for a steering in degrees."""
        self.af, self.ar, self.v, self.why = af * 10, ar * 10, v, why
