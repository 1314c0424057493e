"""Messages that are told only while somebody asks for them by WATCH: raw scans, and the candidates of a decision. Loaded then, let go after."""

from struct import pack_into

from micropython import const

from link.telemetry import copy

CANDIDATES = const(2)

_TYPE = const(3)
_AT = const(8)
_MAX = const(1390)
_TIME = const(0x3FFFFFFF)
_SCAN = const(0x05)
_CANDIDATES = const(0x0A)
_SCAN_SIZE = const(9)  # of one frame of the lidar, before its distances
_CANDIDATES_SIZE = const(7)
_MOST_CANDIDATES = const(230)  # of 6 bytes each, in a frame


class ScanGatherer:
    """Gathers lidar frames into one SCAN message: a whole turn, or as much of it as fits a frame. MemoryError: there is no room for it now.

    ready: True when it is complete.
    """

    def __init__(self, frames_a_turn):
        self._turn = frames_a_turn
        self._data = bytearray(_MAX)
        self._used = self._frames = 0
        self.ready = False

    def add(self, lidar):
        """Take in the frame the lidar has just delivered; what was ready and not taken gives way."""
        count = lidar.n
        size = _SCAN_SIZE + 2 * count
        if self.ready:
            self._used = self._frames = 0
            self.ready = False
        at = self._used
        if not count or at + size > _MAX:
            return
        pack_into("<IHHB", self._data, at, lidar.frame_us & _TIME, lidar.bearings[0], lidar.bearings[count - 1], count)
        copy(lidar.distances, 0, 2 * count, self._data, at + _SCAN_SIZE)
        self._used = at + size
        self._frames += 1
        # The next frame will be about as long as this one.
        self.ready = self._frames == self._turn or self._used + size > _MAX

    def take(self, data):
        """Put what is ready into an encoder's data, as a SCAN; returns the payload's length."""
        size = self._used
        data[_TYPE] = _SCAN
        copy(self._data, 0, size, data, _AT)
        self._used = self._frames = 0
        self.ready = False
        return size


def candidates(data, avoid, mirroring, now_us):
    """What the latest decision found of all steerings of one mirroring (bit 0 left, bit 1 backward), as a CANDIDATES; returns its length."""
    found = avoid.candidates
    count = min(found.count, _MOST_CANDIDATES)
    af, ar = avoid.af, avoid.ar
    if mirroring & 1:
        af, ar = -af, -ar
    if mirroring & 2:
        af, ar = -ar, -af
    chosen = 255
    front, rear = found.af, found.ar  # read once: this takes the longest of all that is told
    k = count
    while k:
        k -= 1
        if front[k] == af and rear[k] == ar:
            chosen = k
            break
    data[_TYPE] = _CANDIDATES
    pack_into("<IBBB", data, _AT, now_us & _TIME, mirroring, chosen, count)
    at = _AT + _CANDIDATES_SIZE
    copy(front, 0, 2 * count, data, at)
    copy(rear, 0, 2 * count, data, at + 2 * count)
    copy(avoid.free_of[mirroring], 0, 2 * count, data, at + 4 * count)
    return _CANDIDATES_SIZE + 6 * count
