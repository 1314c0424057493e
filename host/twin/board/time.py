"""`time` as the firmware sees it on the simulated board: the twin's clock, with the ESP32's wrap at 2**30."""

import lockstep
from charge import settle
from lockstep import advance, later, since
from micropython import const

_LONG_MS = const(100000)  # as much as passes at once: more would not fit a small integer in us


def ticks_us():
    """Microseconds since the board started, modulo 2**30."""
    settle()
    return lockstep.now


def ticks_ms():
    """Milliseconds since the board started, modulo 2**30."""
    settle()
    return lockstep.now_ms


ticks_cpu = ticks_us  # the processor's own counter is not modelled
ticks_add = later
ticks_diff = since


def sleep_us(duration):
    """Let time pass."""
    settle()
    while duration > _LONG_MS * 1000:
        advance(_LONG_MS * 1000)
        duration -= _LONG_MS * 1000
    if duration > 0:
        advance(duration)


def sleep_ms(duration):
    """Let time pass."""
    settle()
    while duration > _LONG_MS:
        advance(_LONG_MS * 1000)
        duration -= _LONG_MS
    if duration > 0:
        advance(duration * 1000)


def sleep(seconds):
    """Let time pass."""
    sleep_us(int(seconds * 1000000))


def time():
    """Whole seconds since the board started."""
    return time_ns() // 1000000000


def time_ns():
    """Nanoseconds since the board started. Makes an object, as on the board."""
    settle()
    return ((lockstep.rounds << 30) + lockstep.now) * 1000
