"""Writes down what the firmware decides and what it writes to its chips, each with its time, for `host.bench.decisions`.

An entry, little-endian: i64 time us | u8 kind | u8 I2C address | u16 number of bytes | the bytes. A decision is eleven i32.
"""

import struct
import sys

import lockstep

DECISION = 0
WRITE = 1


class Recorder:
    """Listens to the board; the entries go into a file at once."""

    def __init__(self, path):
        self._file = open(path, "wb")
        self._seen = -1

    def step(self, time):
        """A decision is read out of the firmware whenever time passes, as a debugger would."""
        avoid = getattr(getattr(sys.modules.get("main"), "robot", None), "avoid", None)
        if avoid is None or avoid.decisions == self._seen:
            return
        self._seen = avoid.decisions
        a = avoid
        data = struct.pack("<11i", a.decisions, a.af, a.ar, a.v, a.mode, a.window, a.zone, a.free, a.block_x, a.block_y, a.why)
        self._put(DECISION, 0, data)

    def write(self, address, data):
        """An I2C write has ended."""
        self._put(WRITE, address, data)

    def close(self):
        """All that was heard is in the file."""
        self._file.close()

    def _put(self, kind, address, data):
        self._file.write(struct.pack("<qBBH", lockstep.now, kind, address, len(data)) + data)
