"""Steering geometry: from the angles of two virtual wheels to the angle and the speed of every wheel.

The virtual wheels sit at the middle of the first and of the last axle and are turned by AF and AR. They fix one rigid motion of the body,
and every wheel stands across the line from the turning centre to it, so that no wheel skids.

Axle frame: origin midway between the first and the last axle, x right, y forward, mm; angles in 0.1 deg, clockwise positive.
Source: papers A (1)-(12) and B (1)-(23), in one form for every mode. With S = sum of the axle spacings the motion, up to scale, is
    (vx, vy, w S/2) = (sin(AF + AR), cos(AF - AR) + cos(AF + AR), sin(AF - AR)),   w clockwise,
and a wheel at (x, y) moves with (vx + w y, vy - w x). Errors of the papers' own formulas (signs, quadrants) do not arise in it.
"""

from array import array

import micropython
from micropython import const

from core.trig import COARSE_SIN

_RIGHT = const(900)  # 90 deg
_HALF_TURN = const(1800)

_ADVERSE = const(1)  # AF and AR of opposite sign
_FIRST_STRAIGHT = const(2)  # AF = 0
_LAST_STRAIGHT = const(3)  # AR = 0
_SPIN = const(4)  # AF = 90, AR = -90: clockwise; AF = -90, AR = 90: the other way
_LATERAL = const(5)  # AF = AR: a crab at that angle, sideways at 90
_SAME_PHASE = const(6)  # AF and AR of the same sign, not equal
_STRAIGHT = const(7)  # AF = AR = 0

# Lengths over S are held in 2**-23 and stay below 8 (core/axles.py), so that a product with a component below 2**24 splits into halves of 13 bits.
# Layout of Steering._work: the twist plus _ZERO, number of axles, track / S, 2 * (distance behind the first axle) / S of each axle, then
# room for the speed of each wheel.
_VX = const(0)
_VY = const(1)
_W = const(2)
_AXLES = const(3)
_TRACK = const(4)
_FIRST = const(5)
_ZERO = const(0x8000)

# atan(2**-i) in 0.1 deg / 2**16. The last is 0.02 of a tenth of a degree: further steps would not change the result.
_ATAN = array(
    "i",
    (29491200, 17409672, 9198793, 4669451, 2343786, 1173036, 586661, 293348, 146676, 73339, 36669, 18335, 9167, 4584, 2292, 1146),
)
_STEPS = const(16)
# 1 / gain of 16 steps = 0.6072529 in 2**-28, in two halves of 14 bits
_GAIN_HIGH = const(9949)
_GAIN_LOW = const(3803)


def _sine(a):
    """sin(a) * (2**29 - 1) within 1e-7 of the unit; a in 0.1 deg, -900 .. 1800.

    Near the spin, and near driving sideways, the components of the motion are themselves differences of sines: 16 bits would not do.
    sin(b + c) = sin(b) cos(c) + cos(b) sin(c), b from the table of whole 2 degrees and c at most one. No product reaches 2**30.
    """
    negative = a < 0
    if negative:
        a = -a
    if a > _RIGHT:
        a = _HALF_TURN - a
    k = (a + 10) // 20
    c = a - 20 * k
    s = COARSE_SIN[k]
    # 1 - cos(c) in 2**-30, with s in 2**-12
    s -= ((s >> 18) * (c * c * 1635)) >> 12
    # sin(c) in 2**-23, up to 0.0175, with cos(b) in two parts of 12 bits
    k = COARSE_SIN[45 - k]
    c = ((c * 1874033) >> 7) - ((c * c * c * 61) >> 13)
    s = (s + (((k >> 18) * c) >> 5) + ((((k >> 6) & 0xFFF) * c) >> 17)) >> 1
    return -s if negative else s


@micropython.viper
def _solve(u: int, v: int, w: int, work: ptr32, angles: ptr16, shares: ptr16, mirrored: int) -> int:
    """Fill angles, shares and the twist for the motion (u, v, w) = (vx, vy, w), below 2**30, w >= 0; return the bits of the folded wheels.

    All in one function, as a call costs more than the work on a wheel. u and v have other meanings later, because the first arguments alone
    lie in registers.

        motion -> largest component 2**23 .. 2**24 -> each axle, each side: the wheel's motion -> CORDIC -> its angle and speed
               -> all speeds, and the motion itself, in parts of the fastest wheel's
    """
    vx = u
    vy = v
    # Largest component between 2**23 and 2**24. Near the spin the sines themselves are small, hence both directions.
    largest = vx if vx >= 0 else 0 - vx
    if vy > largest:
        largest = vy
    if w > largest:
        largest = w
    while largest >= 0x1000000:
        largest >>= 1
        vx >>= 1
        vy >>= 1
        w >>= 1
    while largest < 0x800000:
        largest <<= 1
        vx <<= 1
        vy <<= 1
        w <<= 1

    atan = ptr32(_ATAN)
    high = w >> 13
    low = w & 0x1FFF
    wheels = 2 * work[_AXLES]
    speeds = _FIRST + work[_AXLES]
    across = 0
    wheel_x = 0
    fastest = 0
    folded = 0
    wheel = 0
    k = _TRACK
    while k < speeds:
        # w * ratio / 2**23 for a ratio below 2**26, without a product of 2**30 or more
        u = work[k] >> 13
        v = work[k] & 0x1FFF
        v = ((high * u) << 3) + ((high * v + low * u + ((low * v) >> 13)) >> 10)
        if k == _TRACK:
            across = v
            k += 1
            continue
        k += 1
        wheel_x = vx + w - v
        side = 0
        while side < 2:
            # The wheel's direction and speed by CORDIC (J. Volder, 1959, vectoring mode), in the quadrant of y forward, x right.
            wheel_y = vy - across if side else vy + across
            u = wheel_y if wheel_y >= 0 else 0 - wheel_y
            v = wheel_x if wheel_x >= 0 else 0 - wheel_x
            angle = 0
            speed = 0
            if u + v:
                # Short vectors are lengthened so that the rounding of each step does not count; 2.33 * 2**28 is the most u can become.
                shift = 0
                while u < 0x1000000 and v < 0x1000000:
                    u <<= 4
                    v <<= 4
                    shift += 4
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
                # Rounded in the first quadrant, so that mirrored vectors have mirrored directions.
                angle = (angle + 0x8000) >> 16
                v = u & 0x3FFF
                u >>= 14
                speed = (u * _GAIN_HIGH + ((u * _GAIN_LOW + v * _GAIN_HIGH) >> 14) + ((1 << shift) >> 1)) >> shift
            if speed > fastest:
                fastest = speed
            i = wheel + (side ^ mirrored)
            work[speeds + i] = speed
            # To the left of straight on, in the mirror, folded: each turns the sign.
            t = mirrored
            if wheel_x < 0:
                t ^= 1
            if wheel_y < 0 and angle < _RIGHT:
                folded |= 1 << i
                t ^= 1
            if t:
                angle = 0 - angle
            angles[i] = angle & 0xFFFF
            side += 1
        wheel += 2

    # The fastest wheel moves at 16384; the body's centre, and a point S/2 from the turning centre, never faster than it.
    shift = 0
    while (fastest >> shift) >= 0x8000:
        shift += 1
    fastest >>= shift
    half = fastest >> 1
    wheel = 0
    while wheel < wheels:
        u = ((work[speeds + wheel] >> shift) * 16384 + half) // fastest
        if (folded >> wheel) & 1:
            u = 0 - u
        shares[wheel] = u & 0xFFFF
        wheel += 1
    vx = ((vx >> shift) * 16384 + half) // fastest
    w = ((w >> shift) * 16384 + half) // fastest
    if mirrored:
        vx = 0 - vx
        w = 0 - w
    work[_VX] = vx + _ZERO
    work[_VY] = ((vy >> shift) * 16384 + half) // fastest + _ZERO
    work[_W] = w + _ZERO
    return folded


class Steering:
    """Wheel angles and speed shares for one set of axles.

    axles: from core.axles.lay_out(); several may be made of the same.

    Wheel (i, j), axle i = 1 .. n from the front, j = 1 left, 2 right, has index 2 (i - 1) + (j - 1).

    span        S, mm
    angles      array('h', 2n): wheel angles, 0.1 deg, -900 .. 900
    shares      array('h', 2n): signed speed * 16384; the fastest wheel has 16384 (or -16384), a folded one is negative
    folded      bit k set: the direction of motion of wheel k lies beyond 90 deg; it is turned by 180 deg and runs in reverse
    vx, vy      velocity of the body's centre * 16384, when the fastest wheel moves at 1
    w           angular rate clockwise * S/2, * 16384, likewise
    af, ar      what was solved last
    """

    def __init__(self, axles):
        self._work, self.span, self._back = axles
        size = 4 * self._work[_AXLES]
        self.angles = array("h", bytes(size))
        self.shares = array("h", bytes(size))
        self.solve(0, 0)

    def solve(self, af, ar):
        """Solve for AF and AR, 0.1 deg each. False, and nothing changed, where one lies outside -900 .. 900.

        Right to 0.1 deg in each angle and 0.5 % in each speed, but for a wheel within a millimetre of the turning centre: its direction hardly
        matters, and where it is the centre the angle is 0.
        """
        work = self._work
        if not (-_RIGHT <= af <= _RIGHT and -_RIGHT <= ar <= _RIGHT):
            return False
        # Left turns are solved as right turns in the mirror: left and right then agree to the last bit, and w is never negative.
        total = af + ar
        w = af - ar
        mirrored = w < 0 or (w == 0 and total < 0)
        if mirrored:
            total = -total
            w = -w
        vx = vy = 0
        if w == _HALF_TURN:  # spin: the general form vanishes here
            w = 1
        elif total == _HALF_TURN:  # sideways: likewise
            vx = 1
        else:
            vx = _sine(-total if total < 0 else total)
            vy = _sine(_RIGHT - w) + _sine(_RIGHT - total if total >= 0 else _RIGHT + total)
            w = _sine(w)
            if total < 0:
                vx = -vx
        self.folded = _solve(vx, vy, w, work, self.angles, self.shares, mirrored)
        self.af = af
        self.ar = ar
        self.vy = work[_VY] - _ZERO
        self.w = w = work[_W] - _ZERO
        self.vx = work[_VX] - _ZERO + (w * self._back >> 14)
        return True


def mode_of(af, ar):
    """The steering mode of AF and AR in 0.1 deg: 1 adverse phase, 2 first axle straight, 3 last, 4 spin, 5 lateral (a crab), 6 same phase, 7 straight."""
    if af == ar:
        return _LATERAL if af else _STRAIGHT
    if af == 0:
        return _FIRST_STRAIGHT
    if ar == 0:
        return _LAST_STRAIGHT
    if af == -ar and (af == _RIGHT or ar == _RIGHT):
        return _SPIN
    if (af > 0) == (ar > 0):
        return _SAME_PHASE
    return _ADVERSE
