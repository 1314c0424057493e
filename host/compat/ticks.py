"""MicroPython's tick functions from CPython's clock, with the ESP32's wrap."""

from time import monotonic_ns, sleep

__all__ = ["ticks_ms", "ticks_us", "ticks_add", "ticks_diff", "sleep_ms", "sleep_us"]

PERIOD = 1 << 30  # of the small integers of a 32-bit MicroPython
_HALF = PERIOD >> 1


def ticks_us():
    """Microseconds since some moment, 0..2**30 - 1."""
    return monotonic_ns() // 1000 % PERIOD


def ticks_ms():
    """Milliseconds since some moment, 0..2**30 - 1."""
    return monotonic_ns() // 1_000_000 % PERIOD


def ticks_add(ticks, delta):
    """A moment `delta` later."""
    return (ticks + delta) % PERIOD


def ticks_diff(end, start):
    """Signed ticks from start to end, -2**29..2**29 - 1."""
    return (end - start + _HALF) % PERIOD - _HALF


def sleep_ms(duration):
    """Wait so many milliseconds."""
    sleep(max(duration, 0) / 1e3)


def sleep_us(duration):
    """Wait so many microseconds."""
    sleep(max(duration, 0) / 1e6)
