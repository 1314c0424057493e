"""Sines and cosines in integers, from tables.

Angles are tenths of a degree. Nothing here allocates after the import, and every intermediate value fits a signed 32-bit word.
"""

import micropython
from micropython import const

from core import sines
from core.unload import forget

_RIGHT = const(900)
_HALF_TURN = const(1800)
_TURN = const(3600)


# SIN: 0.0 .. 90.0 deg in steps of 0.1 deg, * 2**16, rounded down (65535 at 90 deg): shifted right by n it is the sine * 2**(16 - n), rounded
# down, and with half a unit added first the same rounded to the nearest.
# COARSE_SIN: in steps of 2 deg, * 2**30 - 1, rounded; steering.py finds what lies between.
SIN, COARSE_SIN = sines.tables()
del sines
forget("core.sines")


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
