"""Sends a map to the board, over any link, a part after the other."""

import time

from host.floorplan.board_file import crc
from host.floorplan.errors import MapError
from host.link.base import Link

PART = 160  # bytes in a command
PATIENCE_S = 4.0


def send(link: Link, data: bytes) -> str:
    """Send the bytes of a map.bin; returns what the board said. MapError if it refuses, or does not answer."""
    check = crc(data)
    said = ""
    for first in range(0, len(data), PART):
        link.put_map(first, len(data), check, data[first : first + PART])
        said = _reply(link, first, len(data))
    return said


def _reply(link: Link, first: int, size: int) -> str:
    end = time.monotonic() + PATIENCE_S
    while (left := end - time.monotonic()) > 0:
        message = link.get(left)
        if message and message["type"] == "ended":
            raise MapError(f"the link has ended: {message['text']}")
        if message and message["type"] == "reply" and message["command"] == "map":
            if message["status"] != "ok":
                raise MapError(f"the board refuses the map: {message['text']}")
            return message["text"]
    raise MapError(f"the board does not answer (byte {first} of {size}): is it there, and its firmware of today? What it had before is whole")
