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
def _sort(px: ptr16, py: ptr16, n: int, size: ptr32, window: ptr8, band: int) -> int:
    """The window of each point; those nearer than band mm to the outline come to the front. Returns how many these are.

    size: half width, half length, red, blue, side, look-ahead (mm); then gap + 1000 (0 none), x, y of the nearest point in any window
    """
    hw = size[0]
    hl = size[1]
    red = size[2]
    blue = size[3]
    side = size[4]
    ahead = size[5]
    best = 30000
    near = 0
    i = 0
    while i < n:
        x = px[i]
        y = py[i]
        gx = x - 8192
        if gx < 0:
            gx = 0 - gx
        gy = y - 8192
        if gy < 0:
            gy = 0 - gy
        gx -= hw
        gy -= hl
        gap = gx
        if gy > gx:
            gap = gy
        w = 0
        if gap >= blue:
            if gx < side:
                if gy < ahead:
                    w = 4
        elif gap <= 0:
            w = 1
        elif gap < red:
            w = 2
        else:
            w = 3
        if w:
            if gap < best:
                best = gap
                size[7] = x
                size[8] = y
        if gap < band:
            px[i] = px[near]
            py[i] = py[near]
            window[i] = window[near]
            px[near] = x
            py[near] = y
            window[near] = w
            near += 1
        else:
            window[i] = w
        i += 1
    size[6] = 0
    if best < 30000:
        size[6] = best + 1000
    return near


class Windows:
    """Sorts points into windows.

    window    bytearray: window of each point sorted last
    near      how many of them lie nearer to the outline than the band
    urgent    the most urgent window that has a point, NONE if none has
    """

    def __init__(self, config, capacity):
        self.window = bytearray(capacity)
        self.near = 0
        self.urgent = NONE
        self._size = size = array("i", [0] * 9)
        size[0] = config.robot_width // 2
        size[1] = config.robot_length // 2
        size[5] = config.windows_look_ahead  # counts from the next start, like the planner's tables
        self.configure(config)

    def configure(self, config):
        """Take over margins that may have been tuned."""
        size = self._size
        size[2] = config.windows_red
        size[3] = config.windows_blue
        size[4] = config.windows_side

    def sort(self, px, py, n, band=-1000):
        """Classify n points (body frame, mm + 8192), those nearer than band mm to the outline first. Returns `urgent`."""
        size = self._size
        self.near = _sort(px, py, n, size, self.window, band)
        gap = size[6] - 1000
        if gap == -1000:
            self.urgent = NONE
        elif gap <= 0:
            self.urgent = GREEN
        elif gap < size[2]:
            self.urgent = RED
        else:
            self.urgent = BLUE if gap < size[3] else YELLOW
        return self.urgent

    def zone(self):
        """Zone of the point nearest to the body of those in a window; NO_ZONE if there is none."""
        size = self._size
        return self.zone_of(size[7] - 8192, size[8] - 8192) if size[6] else NO_ZONE

    def zone_of(self, x, y):
        """Zone of a point outside the outline, mm in the body frame; one inside counts to the nearer end's side."""
        size = self._size
        if abs(y) > size[1]:
            if abs(x) <= size[0]:
                return 0 if y > 0 else 5
            if x > 0:
                return 1 if y > 0 else 4
            return 9 if y > 0 else 6
        if x > 0:
            return 2 if y >= 0 else 3
        return 8 if y >= 0 else 7
