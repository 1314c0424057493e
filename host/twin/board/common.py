"""What the board is alike in, whether it runs in lockstep with the twin or on a tape of the bench: kinds of events, ticks, bytes, files.

Nothing here allocates, and no number leaves the 31 bits of the board's small integers.
"""

import sys

import micropython
from micropython import const

I2C_WRITE = const(1)
PIN = const(2)
PWM_DUTY = const(3)
PWM_FREQUENCY = const(4)
UART_OUTPUT = const(5)

MASK = const(0x3FFFFFFF)  # of ticks: they count us modulo 2**30
_HALF = const(0x20000000)


@micropython.viper
def copy(target: ptr8, at: int, source: ptr8, start: int, count: int):
    """target[at:at + count] = source[start:start + count], without the objects that slices would make."""
    i = 0
    while i < count:
        target[at + i] = source[start + i]
        i += 1


def later(ticks, duration):
    """Ticks `duration` (signed, less than 2**29) after others, without a number of more than 31 bits on the way."""
    return (ticks - _HALF + duration & MASK) ^ _HALF


def since(ticks, start):
    """Signed ticks from `start` to `ticks`."""
    ticks -= start
    if ticks >= _HALF:
        return ticks - _HALF - _HALF
    if ticks < -_HALF:
        return ticks + _HALF + _HALF
    return ticks


if sys.implementation.name == "micropython":

    def store(file, source, start, count):
        """Write source[start:start + count], bytes, to a file."""
        file.write(source, start, count)

    def load(file, buffer, count):
        """Read `count` bytes of a file into the buffer."""
        file.readinto(buffer, count)

else:

    def store(file, source, start, count):
        """Write source[start:start + count], bytes, to a file."""
        file.write(memoryview(source).cast("B")[start : start + count])

    def load(file, buffer, count):
        """Read `count` bytes of a file into the buffer."""
        file.readinto(memoryview(buffer)[:count])
