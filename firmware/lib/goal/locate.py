"""Finds the robot on the map while it stands: near the pose that somebody has given, or anywhere. Loaded when it is needed, let go after.

Near by: every shift of up to 240 mm and every turn of up to 8 degrees, in steps of 60 mm and 2 degrees, is scored by how far the points lie from the map's walls; from the
best one Gauss-Newton goes on (pose.py). Anywhere: likewise from the middle of each free cell in 72 headings, with a part of the points; the best four that lie apart are
looked at closely. The best of them is believed only if it fits well and the next is clearly worse: rooms look alike.
"""

from array import array

from micropython import const

from goal import pose

_COLS = const(0)  # layer.py
_SIZE = const(1)
_CELL = const(2)
_COUNT = const(7)
_USED = const(17)
_FITTED = const(18)
_FAULTS = const(19)
_X = const(24)
_Y = const(25)
_CX = const(29)
_CY = const(30)
_CT = const(31)
_SIDE = const(9)  # shifts, and turns
_STEP = const(480)  # 60 mm, 1/8 mm
_ANGLE = const(572)  # 2 deg, 1/16384 rad
_HEADINGS = const(72)
_HEADING = const(1430)  # 5 deg
_PART = const(3)  # one point in so many, for a first look
_PLACES = const(4)
_APART = const(4800)  # 600 mm
_TURNED = const(8000)  # 28 deg
_TRIES = const(20)  # in a slice
_FITS = const(60)  # percent
_FITS_ANYWHERE = const(75)
_CLEAR = const(14)  # tenths: how much worse the next place has to fit
_MIDDLE = const(16384)  # mm: points to all sides have room there
_WORST = const(0x3FFFFFFF)
_ROUND = const(102944)  # 1/16384 rad


class Locate:
    """goal: the Goal. near: somebody has said where the robot is about."""

    def __init__(self, goal, near):
        self.goal = goal
        self.numbers = n = goal.numbers
        self.near = near
        self.places = array("i", [_WORST, 0, 0, 0] * _PLACES)  # cost, shift x, y (1/8 mm), turn (1/16384 rad)
        self.close = array("i", [_WORST, 0, 0, 0, 0] * _PLACES)  # ... after a close look, and the percent that fits
        self.place = self.k = 0
        self.best = _WORST
        if near:
            self.places[0] = 0
            self.slice = self._begin_round
        else:
            n[_X] = n[_Y] = _MIDDLE << 8
            pose.again(n)
            self.slice = self._scan

    def step(self):
        """One slice. 0: it takes another; 1 found, -1 not found."""
        return self.slice() or 0

    def _cost(self, dx, dy, t, part):
        n = self.numbers
        return pose.score(self.goal, dx, dy, t, 0, part) + 250 * ((n[_COUNT] + part - 1) // part - n[_USED])

    def _scan(self):
        """The middle of each free cell, in all headings."""
        cells = self.goal.cells
        n = self.numbers
        cell = n[_CELL]
        cols = n[_COLS]
        tries = _TRIES
        k = self.k
        while tries:
            at = k // _HEADINGS
            if at >= len(cells):
                self.slice = self._begin_round
                return
            if cells[at] == 0xFFFF:
                k += _HEADINGS
                continue
            dx = (at % cols * cell + (cell >> 1) << 3) - (n[_X] >> 5)
            dy = (at // cols * cell + (cell >> 1) << 3) - (n[_Y] >> 5)
            t = k % _HEADINGS * _HEADING
            cost = self._cost(dx, dy, t, _PART)
            if cost < self.places[4 * _PLACES - 4]:
                self._keep(cost, dx, dy, t)
            k += 1
            tries -= 1
        self.k = k

    def _keep(self, cost, dx, dy, t):
        """Put a place among the best, in place of a worse one near by or else of the worst."""
        places = self.places
        gone = 4 * _PLACES - 4
        for k in range(0, 4 * _PLACES, 4):
            if places[k] < _WORST and _same(places, k, dx, dy, t):
                if places[k] <= cost:
                    return
                gone = k
                break
        while gone and places[gone - 4] > cost:
            for i in range(4):
                places[gone + i] = places[gone - 4 + i]
            gone -= 4
        places[gone] = cost
        places[gone + 1] = dx
        places[gone + 2] = dy
        places[gone + 3] = t

    def _begin_round(self):
        self.k = 0
        self.best = _WORST
        self.slice = self._round if self.places[4 * self.place] < _WORST else self._decide

    def _round(self):
        """All shifts and turns round one place."""
        places = self.places
        at = 4 * self.place
        n = self.numbers
        for _ in range(_TRIES):
            k = self.k
            dx = places[at + 1] + (k % _SIDE - _SIDE // 2) * _STEP
            dy = places[at + 2] + (k // _SIDE % _SIDE - _SIDE // 2) * _STEP
            t = places[at + 3] + (k // (_SIDE * _SIDE) - _SIDE // 2) * _ANGLE
            cost = self._cost(dx, dy, t, 2)
            if cost < self.best:
                self.best = cost
                n[_CX] = dx
                n[_CY] = dy
                n[_CT] = t
            self.k = k + 1
            if self.k == _SIDE**3:
                self.k = 0
                self.slice = self._refine
                return

    def _refine(self):
        n = self.numbers
        cost = self._cost(n[_CX], n[_CY], n[_CT], 1)
        self.k += 1
        if self.k < 8 and pose.improve(n):
            return
        close = self.close
        at = 5 * self.place
        close[at] = cost
        close[at + 1] = n[_CX]
        close[at + 2] = n[_CY]
        close[at + 3] = n[_CT]
        close[at + 4] = n[_FITTED] * 100 // max(n[_USED], 1)
        self.place += 1
        self.slice = self._decide if self.near or self.place == _PLACES else self._begin_round

    def _decide(self):
        """Believe the best, or none."""
        close = self.close
        at = 0
        for k in range(0, 5 * _PLACES, 5):
            if close[k] < close[at]:
                at = k
        second = _WORST
        for k in range(0, 5 * _PLACES, 5):
            if close[k] < second and not _same(close, k, close[at + 1], close[at + 2], close[at + 3]):
                second = close[k]
        n = self.numbers
        good = close[at + 4] >= (_FITS if self.near else _FITS_ANYWHERE)
        if not self.near and second < (close[at] + 3 * n[_COUNT]) * _CLEAR // 10:
            good = False
        if not good:
            return -1
        n[_CX], n[_CY], n[_CT] = close[at + 1], close[at + 2], close[at + 3]
        self._cost(n[_CX], n[_CY], n[_CT], 1)
        pose.correct(n, self.goal.told)
        return 1


def _same(places, k, dx, dy, t):
    """Whether place k is the one given, or next to it."""
    turned = abs(places[k + 3] - t) % _ROUND
    return abs(places[k + 1] - dx) < _APART and abs(places[k + 2] - dy) < _APART and min(turned, _ROUND - turned) < _TURNED
