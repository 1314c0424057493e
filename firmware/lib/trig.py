"""Trigonometry in integers: a sine table, and polar coordinates by CORDIC.

Angles are tenths of a degree, clockwise positive, measured from +y (forward), so that x = r sin a and y = r cos a.
Nothing here allocates after the import, and every intermediate value fits a signed 32-bit word.

Source of CORDIC: J. Volder, "The CORDIC Trigonometric Computing Technique", 1959 (vectoring mode).
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

# atan(2**-i) in 0.1 deg / 2**16. The last is 0.02 of a tenth of a degree: further steps would not change the result.
_ATAN = array(
    "i",
    (29491200, 17409672, 9198793, 4669451, 2343786, 1173036, 586661, 293348, 146676, 73339, 36669, 18335, 9167, 4584, 2292, 1146),
)
_STEPS = const(16)
# 1 / gain of 16 steps = 0.6072529 in 2**-28, in two halves of 14 bits
_GAIN_HIGH = const(9949)
_GAIN_LOW = const(3803)


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


@micropython.viper
def polar(x: int, y: int, out: ptr32):
    """Polar coordinates of (x, y), |x|, |y| <= 2**28.

    out: array('i') of at least two; out[0] = hypot(x, y), right to 1 + hypot / 2**20;
    out[1] = direction 0 .. 3599 in 0.1 deg clockwise from +y, that is atan2(x, y), rounded. The origin has direction 0.
    """
    atan = ptr32(_ATAN)
    u = y if y >= 0 else 0 - y
    v = x if x >= 0 else 0 - x
    if u + v == 0:
        out[0] = 0
        out[1] = 0
        return
    # Short vectors are lengthened so that the rounding of each step does not count; 2.33 * 2**28 is the most u can become.
    shift = 0
    while u < 0x1000000 and v < 0x1000000:
        u <<= 4
        v <<= 4
        shift += 4
    angle = 0
    i = 0
    while i < _STEPS:
        t = v >> i
        if v >= 0:
            v -= u >> i
            u += t
            angle += atan[i]
        else:
            v += u >> i
            u -= t
            angle -= atan[i]
        i += 1
    high = u >> 14
    low = u & 0x3FFF
    r = high * _GAIN_HIGH + ((high * _GAIN_LOW + low * _GAIN_HIGH) >> 14)
    out[0] = (r + ((1 << shift) >> 1)) >> shift
    # Rounded in the first quadrant, so that mirrored vectors have mirrored directions.
    angle = (angle + 0x8000) >> 16
    if y < 0:
        angle = _HALF_TURN - angle
    if x < 0:
        angle = _TURN - angle
        if angle == _TURN:
            angle = 0
    out[1] = angle


@micropython.viper
def isqrt(n: int) -> int:
    """Largest r with r * r <= n, for 0 <= n < 2**30."""
    r = 0
    bit = 1 << 28
    while bit > n:
        bit >>= 2
    while bit:
        if n >= r + bit:
            n -= r + bit
            r = (r >> 1) + bit
        else:
            r >>= 1
        bit >>= 2
    return r
