"""Whole telemetry frames as bytes, and back; for the laptop and for tests: it allocates, and the robot does not load it."""

import struct

from core.crc16 import crc16
from link.telemetry import SYNC, VERSION, Decoder


def frame(kind, payload, sequence=0):
    """One whole frame as bytes."""
    body = struct.pack("<BBHH", VERSION, kind, sequence & 0xFFFF, len(payload)) + payload
    return SYNC + body + struct.pack("<H", crc16(body, 0, len(body)))


def decode(data):
    """[(type, sequence, payload)] of all whole frames in data."""
    decoder = Decoder()
    found = []
    at = 0
    while True:
        while decoder.take():
            found.append((decoder.kind, decoder.sequence, bytes(decoder.data[decoder.start : decoder.end])))
        count = min(decoder.room(), len(data) - at)
        if count <= 0:
            return found
        decoder.feed(data, at, count)
        at += count
