"""The watchdog: when the loop hangs, the chip resets itself. What must be known after a reset is kept in the RTC's memory: that wears no flash.

bytes of that memory     0, 1   b"GS": the rest is ours
                         2      the part at work, see PARTS in robot.py: one that hangs cannot say so any more
                         3      1: whoever reset it wants MicroPython's prompt, not the robot
                         4      how often in a row the watchdog has bitten
"""

from micropython import const

_PROMPT = const(3)
_BITES = const(4)
_TIMEOUT_MS = const(1000)


class Watchdog:
    """machine: the module, None where there is no board. bites: how often it has bitten in a row.

    note, keep, feed    the bytes; keep(note) puts them where a reset leaves them, feed() says that all is well. Before begin() both do nothing.
    """

    def __init__(self, machine=None, bites=0):
        self._machine = machine
        self.note = bytearray(b"GS\x00\x00\x00")
        self.note[_BITES] = bites
        self.keep = len  # takes the bytes as well, and does nothing
        self.feed = bool

    def begin(self):
        """From now on it wants to be fed once a second; nothing but a reset ends that."""
        machine = self._machine
        if machine is not None:
            if hasattr(machine, "RTC"):  # a build without it is watched all the same
                self.keep = machine.RTC().memory
                self.keep(self.note)
            self.feed = machine.WDT(timeout=_TIMEOUT_MS).feed

    def prompt(self):
        """Reset the board; main.py ends then before it has begun anything. Does not return there."""
        machine = self._machine
        if machine is not None:
            self.note[_PROMPT] = 1
            machine.RTC().memory(self.note)
            machine.reset()
