"""`time` as the firmware sees it on the simulated board: the twin's clock, with the ESP32's wrap at 2**30."""

import lockstep
from micropython import const

_PERIOD = const(0x40000000)
_MASK = const(0x3FFFFFFF)
_HALF = const(0x20000000)


def ticks_us():
    """Microseconds since the board started, modulo 2**30."""
    return lockstep.now & _MASK


def ticks_ms():
    """Milliseconds since the board started, modulo 2**30."""
    return lockstep.now // 1000 & _MASK


def ticks_cpu():
    """As ticks_us: the processor's own counter is not modelled."""
    return lockstep.now & _MASK


def ticks_add(ticks, delta):
    """A moment `delta` later."""
    return ticks + delta & _MASK


def ticks_diff(end, start):
    """Signed ticks from start to end."""
    return (end - start + _HALF & _MASK) - _HALF


def sleep_us(duration):
    """Let time pass."""
    if duration > 0:
        lockstep.advance_to(lockstep.now + duration)


def sleep_ms(duration):
    """Let time pass."""
    if duration > 0:
        lockstep.advance_to(lockstep.now + duration * 1000)


def sleep(seconds):
    """Let time pass."""
    sleep_us(int(seconds * 1000000))


def time():
    """Whole seconds since the board started."""
    return lockstep.now // 1000000


def time_ns():
    """Nanoseconds since the board started."""
    return lockstep.now * 1000
