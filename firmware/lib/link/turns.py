"""What the turns of the loop are spent on, told while somebody asks for it by WATCH. Loaded then, let go after.

It stands in for robot.keep, which robot.py calls whenever another part begins its work; noting the time itself takes some 50 us a call.
"""

from array import array
from struct import pack_into
from time import ticks_diff, ticks_us

from micropython import const

_TYPE = const(3)
_AT = const(8)
_TURNS = const(0x10)
_SIZE = const(54)
_PART = const(2)  # place in robot.note, of the numbers that survive.py names
_PARTS = const(6)
_LIDAR = const(1)  # which begins each turn
_PERIOD_US = const(500_000)


class Turns:
    """Sums and longest times of each part, us, since they were told last."""

    def __init__(self, robot):
        self._sums = array("I", bytes(4 * _PARTS))
        self._most = array("I", bytes(4 * _PARTS))
        self._keep = robot.keep
        self._part = self._turns = 0
        self._since = self._told = ticks_us()
        robot.keep = self.mark

    def mark(self, note):
        """Another part begins."""
        now = ticks_us()
        took = ticks_diff(now, self._since)
        part = self._part
        self._since = now
        self._sums[part] += took
        if took > self._most[part]:
            self._most[part] = took
        self._part = part = note[_PART]
        if part == _LIDAR:
            self._turns += 1
        self._keep(note)

    def due(self, now_us):
        return ticks_diff(now_us, self._told) >= _PERIOD_US

    def take(self, data, now_us):
        """A TURNS; returns its length, and begins anew."""
        data[_TYPE] = _TURNS
        pack_into("<IH", data, _AT, now_us & 0x3FFFFFFF, self._turns)
        k = 0
        while k < _PARTS:
            pack_into("<II", data, _AT + 6 + 8 * k, self._sums[k], self._most[k])
            self._sums[k] = self._most[k] = 0
            k += 1
        self._turns = 0
        self._told = now_us
        return _SIZE

    def end(self, robot):
        robot.keep = self._keep
