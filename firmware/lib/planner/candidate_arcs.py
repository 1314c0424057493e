"""Constants of the candidates of candidates.py that turn, and where they lead to. Loaded to make them, then let go; candidate_rings.py is next.

Source: papers A section 4.2 and B section 3.2-3.3.
"""

from math import cos, pi, sin, sqrt, tan

from micropython import const

_BIAS = const(8192)
_LENGTHS = const(5)

# Fields of an arc's constants, 16-bit words. Those behind them (5 to 7) are of candidate_rings.py.
_STRIDE = const(8)
_XC = const(0)  # the turning centre, mm + 8192
_YC = const(1)
_TURN_MM = const(2)  # travel of a whole turn, mm: low word, high word
_REF = const(4)  # distance of the fastest wheel from the centre, mm


def fill(draft):
    """ends, turns and, but for what candidate_rings.py adds, consts of each arc of a candidate_set.Draft."""
    for k in range(draft.arcs):
        _fill_arc(draft, k)
        _fill_ends(draft, k)


def _fill_ends(draft, k):
    for i in range(_LENGTHS):
        x, y, _ = end(draft, k, draft.lengths[i])
        t = (k * _LENGTHS + i) * 2
        draft.ends[t] = round(x) + _BIAS
        draft.ends[t + 1] = round(y) + _BIAS


def _hypot(x, y):
    return sqrt(x * x + y * y)


def centre(draft, k):
    """Turning centre (x, y) of arc k in the body frame, mm. Spec section 3."""
    front = tan(draft.af[k] * pi / 1800)
    rear = tan(draft.ar[k] * pi / 1800)
    r = draft.wheelbase / (front - rear)
    return r, draft.first_axle - r * front


def _reference(draft, xc, yc):
    """Distance of the fastest wheel from the turning centre."""
    far = max(abs(draft.first_axle - yc), abs(draft.first_axle - draft.wheelbase - yc))
    return _hypot(xc + draft.half_track, far)


def end(draft, k, length):
    """Pose (x, y mm, clockwise turn in rad) of the body centre after `length` mm of travel on candidate k, an arc."""
    xc, yc = centre(draft, k)
    turn = length / _reference(draft, xc, yc)
    s = sin(turn)
    c = cos(turn)
    return xc - xc * c - yc * s, yc + xc * s - yc * c, turn


def _fill_arc(draft, k):
    xc, yc = centre(draft, k)
    ref = _reference(draft, xc, yc)
    c = draft.consts
    b = k * _STRIDE
    # The tests reckon from the centre in whole mm, so the rings do.
    c[b + _XC] = round(xc) + _BIAS
    c[b + _YC] = round(yc) + _BIAS
    turn_mm = int(2 * pi * ref)
    c[b + _TURN_MM] = turn_mm & 0xFFFF
    c[b + _TURN_MM + 1] = turn_mm >> 16
    c[b + _REF] = int(ref)
    draft.turns[k] = min(round(16384 * 1800 / (pi * ref)), 65535)
