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


# SIN: 0 .. 90 deg in steps of 0.4 deg, * 2**16, rounded (65535 at 90 deg, and once more behind it). What lies between is interpolated and comes out less
# than a unit too small, as a table with all of them would be three times as large as any other array of its use.
# COARSE_SIN: in steps of 2 deg, * 2**30 - 1, rounded; steering.py finds what lies between.
SIN, COARSE_SIN = sines.tables()
del sines
forget("core.sines")


@micropython.viper
def sin14(a: int) -> int:
    """sin(a) * 2**14, right to 0.75; `a` in 0.1 deg, any int."""
    table = ptr16(SIN)
    if a < 0 or a >= _TURN:
        a %= _TURN
    negative = 0
    if a >= _HALF_TURN:
        a -= _HALF_TURN
        negative = 1
    if a > _RIGHT:
        a = _HALF_TURN - a
    k = a >> 2
    s = table[k]
    s = (s + ((table[k + 1] - s) * (a & 3) >> 2) + 2) >> 2
    if negative:
        return -s
    return s


def cos14(a):
    """cos(a) * 2**14, likewise."""
    return sin14(a + _RIGHT)
