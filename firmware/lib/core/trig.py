"""Sines and cosines in integers, from a table.

Angles are tenths of a degree. Nothing here allocates after the import, and every intermediate value fits a signed 32-bit word.
"""

from array import array

import micropython
from micropython import const

_RIGHT = const(900)
_HALF_TURN = const(1800)
_TURN = const(3600)


def _sine_table():
    """sin of 0.0 .. 90.0 deg in steps of 0.1 deg, scaled by 2**30 - 1, each entry rounded to the nearest.

    s[k+1] - s[k] = s[k] - s[k-1] - 4 sin(d/2)**2 s[k] with d = 0.1 deg, in 2**-60: the ESP32's floats have 24 bits only.
    """
    curvature = 3511998847986  # 4 sin(0.05 deg)**2 * 2**60
    s, step = 0, 2012226603770456  # sin(0.1 deg) * (2**30 - 1) * 2**30
    table = array("i", bytes(4 * (_RIGHT + 1)))
    for k in range(_RIGHT + 1):
        table[k] = (s + (1 << 29)) >> 30
        s += step
        step -= (s * curvature) >> 60
    return table


SIN = _sine_table()
del _sine_table


@micropython.viper
def sin14(a: int) -> int:
    """sin(a) * 2**14, rounded; `a` in 0.1 deg, any int."""
    table = ptr32(SIN)
    if a < 0 or a >= _TURN:
        a %= _TURN
    negative = 0
    if a >= _HALF_TURN:
        a -= _HALF_TURN
        negative = 1
    if a > _RIGHT:
        a = _HALF_TURN - a
    s = (table[a] + 32768) >> 16
    if negative:
        return -s
    return s


@micropython.viper
def cos14(a: int) -> int:
    """cos(a) * 2**14, rounded; `a` in 0.1 deg, any int."""
    table = ptr32(SIN)
    if a < 0 or a >= _TURN:
        a %= _TURN
    if a > _HALF_TURN:
        a = _TURN - a
    if a > _RIGHT:
        return -((table[a - _RIGHT] + 32768) >> 16)
    return (table[_RIGHT - a] + 32768) >> 16
