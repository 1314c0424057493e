"""Windows and zones: how urgent a point is, and on which side of the body it stands (paper A, section 4.1).

    window  1 green   inside the body's outline: a collision
            2 red     within the emergency margin
            3 blue    within the caution margin
            4 yellow  within the planning window
            0         none of them: dropped

    zone    9 | 0 | 1     0 front, 1 right front corner, 2 and 3 right side front and rear half,
            8 |   | 2     4 right rear corner, 5 rear, 6 left rear corner, 7 and 8 left side rear and front half,
            7 |   | 3     9 left front corner
            6 | 5 | 4
"""

from array import array

import micropython
from micropython import const

NONE = const(0)
GREEN = const(1)
RED = const(2)
BLUE = const(3)
YELLOW = const(4)
NO_ZONE = const(255)


@micropython.viper
def _sort(px: ptr16, py: ptr16, n: int, size: ptr32, window: ptr8, counts: ptr16, nearest: ptr32):
    """size: half width, half length, red, blue, side, look-ahead (mm); nearest: gap + 1000, index of the nearest point per window."""
    hw = size[0]
    hl = size[1]
    red = size[2]
    blue = size[3]
    side = size[4]
    ahead = size[5]
    i = 0
    while i < 50:
        counts[i] = 0
        i += 1
    i = 0
    while i < 5:
        nearest[2 * i] = 65535
        i += 1
    i = 0
    while i < n:
        x = px[i] - 8192
        y = py[i] - 8192
        ax = x
        if x < 0:
            ax = 0 - x
        ay = y
        if y < 0:
            ay = 0 - y
        gx = ax - hw
        gy = ay - hl
        gap = gx
        if gy > gx:
            gap = gy
        if gap <= 0:
            w = 1
        elif gap < red:
            w = 2
        elif gap < blue:
            w = 3
        elif gx < side and gy < ahead:
            w = 4
        else:
            w = 0
        window[i] = w
        if w:
            if gy > 0:
                if gx > 0:
                    if y > 0:
                        z = 1
                        if x < 0:
                            z = 9
                    else:
                        z = 4
                        if x < 0:
                            z = 6
                else:
                    z = 0
                    if y < 0:
                        z = 5
            elif x > 0:
                z = 2
                if y < 0:
                    z = 3
            else:
                z = 8
                if y < 0:
                    z = 7
            counts[w * 10 + z] += 1
            if gap + 1000 < nearest[2 * w]:
                nearest[2 * w] = gap + 1000
                nearest[2 * w + 1] = (z << 16) + i
        i += 1


class Windows:
    """Sorts points into windows and zones. `counts[10 * window + zone]` points each; `window[i]` of each point."""

    def __init__(self, config, capacity):
        self.window = bytearray(capacity)
        self.counts = array("H", bytes(100))
        self._nearest = array("i", [0] * 10)
        self._size = array("i", [0] * 6)
        self.configure(config)

    def configure(self, config):
        size = self._size
        size[0] = config.robot_width // 2
        size[1] = config.robot_length // 2
        size[2] = config.windows_red
        size[3] = config.windows_blue
        size[4] = config.windows_side
        size[5] = config.windows_look_ahead

    def sort(self, px, py, n):
        """Classify n points (body frame, mm + 8192). Returns the most urgent window that has one: 1..4, 0 none."""
        _sort(px, py, n, self._size, self.window, self.counts, self._nearest)
        near = self._nearest
        for w in (GREEN, RED, BLUE, YELLOW):
            if near[2 * w] != 65535:
                return w
        return NONE

    def gap(self, w):
        """Distance of the window's nearest point from the body, mm."""
        return self._nearest[2 * w] - 1000

    def zone(self, w):
        """Zone of the window's nearest point."""
        return self._nearest[2 * w + 1] >> 16

    def point(self, w):
        """Index of the window's nearest point."""
        return self._nearest[2 * w + 1] & 0xFFFF
