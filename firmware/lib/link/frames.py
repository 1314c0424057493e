"""Whole telemetry frames as bytes, and back; for the laptop and for tests: it allocates, and the robot does not load it."""

import struct

from core.crc16 import crc16
from link.protocol import CHECK, HEADER, MAX_PAYLOAD, SYNC, VERSION
from link.telemetry import Decoder


def frame(kind, payload, sequence=0):
    """One whole frame as bytes."""
    body = struct.pack("<BBHH", VERSION, kind, sequence & 0xFFFF, len(payload)) + payload
    return SYNC + body + struct.pack("<H", crc16(body, 0, len(body)))


class StreamDecoder(Decoder):
    """A Decoder for those who want to know more than the robot does.

    stray: called with each byte (an int) that belongs to no frame, or None. sequence: of the frame found last. errors: frames whose check failed.
    """

    def __init__(self, max_payload, stray=None):
        self.sequence = self.errors = 0
        self._stray = stray
        super().__init__(max_payload)

    def take(self):
        found = super().take()
        if found:
            self.sequence = self.data[4] | self.data[5] << 8
        return found

    def _cut(self, count):
        if not self.end:  # no frame is let go here, but what is none
            data = self.data
            if self._tail >= HEADER and data[:2] == SYNC and data[2] == VERSION and HEADER + (data[6] | data[7] << 8) + CHECK <= self._tail:
                self.errors += 1  # a whole one, so it was its check
            if self._stray is not None:
                for i in range(count):
                    self._stray(data[i])
        super()._cut(count)


class FrameReader:
    """Takes a stream apart: give `read` its bytes in any pieces. stray: as for StreamDecoder; errors: frames whose check failed."""

    def __init__(self, stray=None):
        self._decoder = StreamDecoder(MAX_PAYLOAD, stray)

    @property
    def errors(self):
        return self._decoder.errors

    def read(self, data):
        """(type, sequence, payload) of each frame that is whole with these bytes."""
        decoder = self._decoder
        for byte in data:
            more = decoder.add(byte)
            while more:
                yield decoder.kind, decoder.sequence, bytes(decoder.data[HEADER : decoder.end])
                more = decoder.take()


def decode(data):
    """[(type, sequence, payload)] of all whole frames in data."""
    return list(FrameReader().read(data))
