"""Whole telemetry frames as bytes, and back; for the laptop and for tests: it allocates, and the robot does not load it."""

import struct

from core.crc16 import crc16
from link.protocol import HEADER, MAX_PAYLOAD, SYNC, VERSION
from link.telemetry import Decoder


def frame(kind, payload, sequence=0):
    """One whole frame as bytes."""
    body = struct.pack("<BBHH", VERSION, kind, sequence & 0xFFFF, len(payload)) + payload
    return SYNC + body + struct.pack("<H", crc16(body, 0, len(body)))


class FrameReader:
    """Takes a stream apart: give `read` its bytes in any pieces. stray: as for Decoder; errors: frames whose check failed."""

    def __init__(self, stray=None):
        self._decoder = Decoder(MAX_PAYLOAD, stray)

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
