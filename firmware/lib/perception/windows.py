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

import micropython
from micropython import const

NONE = const(0)
GREEN = const(1)
RED = const(2)
BLUE = const(3)
YELLOW = const(4)
NO_ZONE = const(255)


BAND_MM = const(12)  # points nearer to the outline than this beyond the soft margin are "near": the collision check looks at them one by one

# Layout of Windows._size
_HALF_WIDTH = const(0)
_HALF_LENGTH = const(1)
_RED_MM = const(2)
_BLUE_MM = const(3)
_SIDE = const(4)
_AHEAD = const(5)
_BAND = const(6)  # mm round the outline
_GAP = const(7)  # of the nearest point that lies in a window: mm + _GAP_ZERO, 0 where there is none
_X = const(8)  # and where it is
_Y = const(9)
_SIZES = const(10)
_GAP_ZERO = const(1000)
_NO_GAP = const(30000)
_BODY_ZERO = const(8192)  # added to coordinates of the body frame, mm


@micropython.viper
def _sort(size: ptr32, px: ptr16, py: ptr16, n: int, window: ptr8, classify: int) -> int:
    """Bring the points nearer to the outline than the band to the front; returns how many.

    With `classify` the window of each goes to window, in the same order, and the nearest in any window to size.
    """
    hw = size[_HALF_WIDTH]
    hl = size[_HALF_LENGTH]
    blue = size[_BLUE_MM]
    band = size[_BAND]
    best = _NO_GAP
    near = 0
    w = 0
    i = 0
    while i < n:
        x = px[i]
        y = py[i]
        gx = x - _BODY_ZERO
        if gx < 0:
            gx = 0 - gx
        gy = y - _BODY_ZERO
        if gy < 0:
            gy = 0 - gy
        gx -= hw
        gy -= hl
        gap = gx
        if gy > gx:
            gap = gy
        if classify:
            w = 0
            if gap >= blue:
                if gx < size[_SIDE] and gy < size[_AHEAD]:
                    w = YELLOW
            elif gap <= 0:
                w = GREEN
            elif gap < size[_RED_MM]:
                w = RED
            else:
                w = BLUE
            if w and gap < best:
                best = gap
                size[_X] = x
                size[_Y] = y
            window[i] = w
        if gap < band:
            px[i] = px[near]
            py[i] = py[near]
            px[near] = x
            py[near] = y
            if classify:
                window[i] = window[near]
                window[near] = w
            near += 1
        i += 1
    if classify:
        size[_GAP] = 0
        if best < _NO_GAP:
            size[_GAP] = best + _GAP_ZERO
    return near


class Windows:
    """Sorts points into windows, and those near the outline to the front. Points: body frame, array('H') of mm + 8192.

    window    bytearray: window of each point sorted last
    near      how many of them lie nearer to the outline than the soft margin and BAND_MM
    urgent    the most urgent window that has a point, NONE if none has
    """

    def __init__(self, config, capacity):
        from perception.build import windows

        windows(self, config, capacity, BAND_MM)
        self.configure(config)

    def configure(self, config):
        """Take over margins that may have been tuned; the band and the look-ahead count from the start on, as in the planner's tables."""
        size = self._size
        size[_RED_MM] = config.windows_red
        size[_BLUE_MM] = config.windows_blue
        size[_SIDE] = config.windows_side

    def sort(self, px, py, n):
        """Classify n points and bring the near ones to the front. Returns `urgent`."""
        size = self._size
        self.near = _sort(size, px, py, n, self.window, 1)
        gap = size[_GAP] - _GAP_ZERO
        if gap == -_GAP_ZERO:
            self.urgent = NONE
        elif gap <= 0:
            self.urgent = GREEN
        elif gap < size[_RED_MM]:
            self.urgent = RED
        else:
            self.urgent = BLUE if gap < size[_BLUE_MM] else YELLOW
        return self.urgent

    def sort_near(self, px, py, n):
        """Bring the near ones of n points to the front, and return how many; what `sort` found stays."""
        return _sort(self._size, px, py, n, self.window, 0)

    def zone(self):
        """Zone of the point nearest to the body of those in a window; NO_ZONE if there is none."""
        size = self._size
        return self.zone_of(size[_X] - _BODY_ZERO, size[_Y] - _BODY_ZERO) if size[_GAP] else NO_ZONE

    def zone_of(self, x, y):
        """Zone of a point outside the outline, mm in the body frame; one inside counts to the nearer end's side."""
        size = self._size
        if abs(y) > size[_HALF_LENGTH]:
            if abs(x) <= size[_HALF_WIDTH]:
                return 0 if y > 0 else 5
            if x > 0:
                return 1 if y > 0 else 4
            return 9 if y > 0 else 6
        if x > 0:
            return 2 if y >= 0 else 3
        return 8 if y >= 0 else 7
