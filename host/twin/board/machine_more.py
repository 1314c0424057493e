"""The parts of `machine` that the robot does not use; see machine.py."""

import charge
import lockstep
from machine import I2C
from micropython import const

PWRON_RESET = const(1)
HARD_RESET = const(2)
WDT_RESET = const(3)
DEEPSLEEP_RESET = const(4)
SOFT_RESET = const(5)

_frequency = 160000000


def soft_reset():
    """Start the interpreter again: pins and the clock stay as they are."""
    lockstep.reset(SOFT_RESET)


def freq(hertz=None):
    """Clock of the processor, Hz: computing takes as long as that."""
    global _frequency
    if hertz is None:
        return _frequency
    _frequency = hertz
    charge.clock(hertz)


def idle():
    """Nothing to wait for."""


def disable_irq():
    """No interrupts to disable."""
    return 0


def enable_irq(state):
    """No interrupts to enable."""


SoftI2C = I2C


class WDT:
    """The watchdog: when it is not fed in time the board resets."""

    def __init__(self, id=0, timeout=5000):
        self._timeout_us = timeout * 1000
        self.feed()

    def feed(self):
        """Start the time-out again."""
        lockstep.watchdog_us = self._timeout_us


class Timer:
    """Accepted and never called: the firmware's loop keeps its own time."""

    ONE_SHOT = const(0)
    PERIODIC = const(1)

    def __init__(self, id=-1, **settings):
        pass

    def init(self, **settings):
        """Accepted."""

    def deinit(self):
        """Accepted."""


class RTC:
    """The real-time clock's memory, which every reset leaves as it is: the twin keeps it, see lockstep.py."""

    def memory(self, data=None):
        """The bytes kept, or keep others, up to eight."""
        if data is None:
            return bytes(lockstep.kept[1 : 1 + lockstep.kept[0]])
        lockstep.kept[0] = len(data)
        lockstep.copy(lockstep.kept, 1, data, 0, len(data))
