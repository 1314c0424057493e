"""Constants of the candidates of candidates.py that turn, and where they lead to. Loaded to make them, then let go; candidate_rings.py is next.

Source: papers A section 4.2 and B section 3.2-3.3.
"""

from math import cos, pi, sin, sqrt, tan

from micropython import const

_BIAS = const(8192)
_BINS = const(24)
_LENGTHS = const(5)

# Fields of an arc's constants, 16-bit words; those from _IN_SOFT on are pairs, the low one first. _FRONT, _SECOND, _SECOND_BINS and _SLOPE_SHIFT (6 to 9) are of candidate_rings.py.
_STRIDE = const(20)
_XC = const(0)
_YC = const(1)
_BIN_SHIFT = const(2)
_BIN_SCALE = const(3)
_ANGLE_MAX = const(4)
_REF = const(5)
_IN_SOFT = const(10)
_OUT_SOFT = const(12)
_IN = const(14)
_OUT = const(16)
_TURN_MM = const(18)


def fill(draft):
    """consts but for two, ends and turns of each arc of a candidate_set.Draft."""
    for k in range(draft.arcs):
        _fill_arc(draft, k)
        _fill_ends(draft, k)


def _fill_ends(draft, k):
    for i in range(_LENGTHS):
        x, y, turn = end(draft, k, draft.lengths[i])
        t = (k * _LENGTHS + i) * 2
        draft.ends[t] = round(x) + _BIAS
        draft.ends[t + 1] = round(y) + _BIAS
        draft.turns[t >> 1] = round(turn * 1800 / pi)


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
    # The tests reckon from the centre in whole mm, so the rings do.
    xc = round(xc)
    yc = round(yc)
    r_in, r_out = _ring(draft, xc, yc, draft.margin)
    s_in, s_out = _ring(draft, xc, yc, draft.soft)
    c = draft.consts
    b = k * _STRIDE
    c[b + _XC] = xc + _BIAS
    c[b + _YC] = yc + _BIAS
    _put(c, b + _IN_SOFT, int(s_in * s_in))
    _put(c, b + _OUT_SOFT, int(s_out * s_out) + 1)
    _put(c, b + _IN, int(r_in * r_in))
    _put(c, b + _OUT, int(r_out * r_out) + 1)
    # Bins are even in d * d: (d * d - r_in * r_in >> shift) * scale >> 12 = bin in 1/256, with both factors below 2**15.
    span = int(r_out * r_out) + 1 - int(r_in * r_in)
    shift = 0
    while span >> shift >= 32768:
        shift += 1
    c[b + _BIN_SHIFT] = shift
    scale = _BINS * 1048576 // (span >> shift)
    c[b + _BIN_SCALE] = scale
    _put(c, b + _TURN_MM, int(2 * pi * ref))
    c[b + _ANGLE_MAX] = min(int(draft.look_ahead * 65536 / (2 * pi * ref)), 60000)
    c[b + _REF] = int(ref)


def _put(words, at, value):
    """A number of 32 bits as two words."""
    words[at] = value & 0xFFFF
    words[at + 1] = value >> 16


def _ring(draft, xc, yc, margin):
    """Inner and outer radius of what the outline plus margin sweeps about (xc, yc), xc > 0."""
    hw = draft.half_width + margin
    hl = draft.half_length + margin
    dx = max(xc - hw, 0)
    dy = max(abs(yc) - hl, 0)
    return _hypot(dx, dy), _hypot(xc + hw, abs(yc) + hl)
