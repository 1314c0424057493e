"""Frames of the wire format, made and found on the robot; protocol.py describes them. Nothing here allocates after the start."""

import micropython
from micropython import const

from core.crc16 import crc16

_VERSION = const(1)
_SYNC_0 = const(0xF7)
_SYNC_1 = const(0xF6)
_TYPE = const(3)  # places in the header
_SEQUENCE = const(4)
_LENGTH = const(6)
_HEADER = const(8)
_CHECK = const(2)
_ORIGIN = const(8192)  # what the planner adds to coordinates
_BUFFER = const(1408)  # the longest frame, 1400 bytes, rounded up for those who send in steps of 128

# What the person asks of the robot, as DRIVE and DECISION number it
STOPPED = const(0)
AUTO = const(1)
MANUAL = const(2)


@micropython.viper
def copy(source: ptr8, start: int, count: int, target: ptr8, at: int):
    """target[at:at + count] = source[start:start + count], bytes, without the objects that slices would make; downward it may overlap."""
    i = 0
    while i < count:
        target[at + i] = source[start + i]
        i += 1


@micropython.viper
def copy_points(source: ptr16, count: int, target: ptr8, at: int):
    """target from `at` on: `count` coordinates as i16, in mm, of the planner's, which are mm + 8192 so that they are never negative."""
    i = 0
    while i < count:
        value = source[i] - _ORIGIN
        target[at] = value & 255
        target[at + 1] = (value >> 8) & 255
        at += 2
        i += 1


class Encoder:
    """One frame at a time, in a buffer made once: write the type into data[3], the payload from data[8] on, then call `seal`.

    size: bytes of the sealed frame in `data`.
    """

    def __init__(self):
        self.data = data = bytearray(_BUFFER)
        data[0] = _SYNC_0
        data[1] = _SYNC_1
        data[2] = _VERSION
        self.size = 0
        self._sequence = 0

    def seal(self, length):
        """Complete the frame whose type and payload of `length` bytes are in place. 60 instructions a byte, those of the check."""
        data = self.data
        sequence = self._sequence
        self._sequence = (sequence + 1) & 0xFFFF
        data[_SEQUENCE] = sequence & 255
        data[_SEQUENCE + 1] = sequence >> 8
        data[_LENGTH] = length & 255
        data[_LENGTH + 1] = length >> 8
        end = _HEADER + length
        check = crc16(data, 2, end)
        data[end] = check & 255
        data[end + 1] = check >> 8
        self.size = end + _CHECK


class Decoder:
    """Finds the frames in a stream of bytes, whatever lies between them.

    max_payload: longer frames are none.

    kind, end     of the frame for which `add` or `take` returned True; its payload is data[8:end] until the next call
    """

    def __init__(self, max_payload):
        self.data = bytearray(_HEADER + max_payload + _CHECK)
        self.kind = self.end = 0
        self._tail = 0  # bytes in `data`
        self._need = 1  # before there are so many there is nothing to look at

    def add(self, byte):
        """Take in one byte; True when a frame is whole with it."""
        if self.end:
            self._next()
        self.data[self._tail] = byte
        self._tail += 1
        return self._tail >= self._need and self.take()

    def load(self, source, count):
        """Forget what there is and take in the first `count` bytes of a datagram; True when they begin with a frame or hold one."""
        self.end = 0
        self._tail = min(count, len(self.data))
        self._need = 1
        copy(source, 0, self._tail, self.data, 0)
        return self.take()

    def take(self):
        """True when there is another whole frame in what has been taken in: behind a broken one there may be several."""
        if self.end:
            self._next()
        data = self.data
        while self._tail >= self._need:
            tail = self._tail
            if data[0] != _SYNC_0 or tail > 1 and data[1] != _SYNC_1 or tail > 2 and data[2] != _VERSION:
                self._skip()
            elif tail < _HEADER:
                self._need = 2 if tail < 2 else _HEADER
            else:
                end = _HEADER + (data[_LENGTH] | data[_LENGTH + 1] << 8)
                if end + _CHECK > len(data):
                    self._skip()
                elif end + _CHECK > tail:
                    self._need = end + _CHECK
                elif crc16(data, 2, end) != data[end] | data[end + 1] << 8:
                    self._skip()
                else:
                    self.kind = data[_TYPE]
                    self.end = end
                    return True
        return False

    def waiting(self):
        """True while a frame has begun and is not whole; for when `take` has returned False."""
        return self._tail > 0

    def clear(self):
        """Forget an unfinished frame; its bytes are stray."""
        while self._tail:
            self._skip()

    def _next(self):
        self._cut(self.end + _CHECK)
        self.end = 0

    def _skip(self):
        """Let go of the first byte, and of all others up to the next that may begin a frame."""
        count = 1
        while count < self._tail and self.data[count] != _SYNC_0:
            count += 1
        self._cut(count)

    def _cut(self, count):
        self._tail -= count
        self._need = 1
        copy(self.data, count, self._tail, self.data, 0)
