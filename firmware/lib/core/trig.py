"""Sines and cosines in integers, from tables.

Angles are tenths of a degree. Nothing here allocates after the import, and every intermediate value fits a signed 32-bit word.
"""

from array import array

import micropython
from micropython import const

_RIGHT = const(900)
_HALF_TURN = const(1800)
_TURN = const(3600)
_COARSE = const(20)  # 2 deg


def _tables():
    """SIN and COARSE_SIN, from a recurrence: the ESP32's floats have 24 bits only.

    s[k+1] - s[k] = s[k] - s[k-1] - 4 sin(d/2)**2 s[k] with d = 0.1 deg; s is sin * (2**30 - 1) in 2**-30.
    """
    curvature = 3511998847986  # 4 sin(0.05 deg)**2 * 2**60
    s, step = 0, 2012226603770456  # sin(0.1 deg) * (2**30 - 1) * 2**30
    fine = array("H", bytes(2 * (_RIGHT + 1)))
    coarse = array("i", bytes(4 * (_RIGHT // _COARSE + 1)))
    for k in range(_RIGHT + 1):
        rounded = (s + (1 << 29)) >> 30
        fine[k] = rounded >> 14
        if k % _COARSE == 0:
            coarse[k // _COARSE] = rounded
        s += step
        step -= (s * curvature) >> 60
    return fine, coarse


# SIN: 0.0 .. 90.0 deg in steps of 0.1 deg, * 2**16, rounded down (65535 at 90 deg): shifted right by n it is the sine * 2**(16 - n), rounded
# down, and with half a unit added first the same rounded to the nearest.
# COARSE_SIN: in steps of 2 deg, * 2**30 - 1, rounded; steering.py finds what lies between.
SIN, COARSE_SIN = _tables()
del _tables


@micropython.viper
def sin14(a: int) -> int:
    """sin(a) * 2**14, rounded; `a` in 0.1 deg, any int."""
    table = ptr16(SIN)
    if a < 0 or a >= _TURN:
        a %= _TURN
    negative = 0
    if a >= _HALF_TURN:
        a -= _HALF_TURN
        negative = 1
    if a > _RIGHT:
        a = _HALF_TURN - a
    s = (table[a] + 2) >> 2
    if negative:
        return -s
    return s


def cos14(a):
    """cos(a) * 2**14, rounded; `a` in 0.1 deg, any int."""
    return sin14(a + _RIGHT)
