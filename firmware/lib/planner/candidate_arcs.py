"""Constants of the candidates of envelope.py that turn, and where they lead to. Loaded to make them, then let go; envelope_rings.py is next.

Source: papers A section 4.2 and B section 3.2-3.3.
"""

from math import cos, pi, sin, sqrt, tan

from micropython import const

_BIAS = const(8192)
_BINS = const(24)
_LENGTHS = const(5)
_STRIDE = const(13)

# Fields of a candidate's constants; the last two are of envelope_rings.py.
_XC = const(0)
_YC = const(1)
_IN_SOFT = const(2)
_OUT_SOFT = const(3)
_IN = const(4)
_OUT = const(5)
_BIN_SHIFT = const(6)
_BIN_SCALE = const(7)
_ANGLE_MAX = const(8)
_TURN_MM = const(9)
_REF = const(10)


def fill(env, margin, soft, look_ahead):
    """lengths; consts but for two, ends and turns of each arc. All lengths in mm."""
    for i, part in enumerate((1, 2, 4, 8, 14)):
        env.lengths[i] = look_ahead * part // 14
    for k in range(env.arcs):
        _fill_arc(env, k, margin, soft, look_ahead)
        _fill_ends(env, k)


def _fill_ends(env, k):
    for i in range(_LENGTHS):
        x, y, turn = end(env, k, env.lengths[i])
        t = (k * _LENGTHS + i) * 2
        env.ends[t] = round(x) + _BIAS
        env.ends[t + 1] = round(y) + _BIAS
        env.turns[t >> 1] = round(turn * 1800 / pi)


def _hypot(x, y):
    return sqrt(x * x + y * y)


def centre(env, k):
    """Turning centre (x, y) of arc k in the body frame, mm. Spec section 3."""
    front = tan(env.af[k] * pi / 1800)
    rear = tan(env.ar[k] * pi / 1800)
    r = env.wheelbase / (front - rear)
    return r, env.first_axle - r * front


def _reference(env, xc, yc):
    """Distance of the fastest wheel from the turning centre."""
    far = max(abs(env.first_axle - yc), abs(env.first_axle - env.wheelbase - yc))
    return _hypot(xc + env.half_track, far)


def end(env, k, length):
    """Pose (x, y mm, clockwise turn in rad) of the body centre after `length` mm of travel on candidate k, an arc."""
    xc, yc = centre(env, k)
    turn = length / _reference(env, xc, yc)
    s = sin(turn)
    c = cos(turn)
    return xc - xc * c - yc * s, yc + xc * s - yc * c, turn


def _fill_arc(env, k, margin, soft, look_ahead):
    xc, yc = centre(env, k)
    ref = _reference(env, xc, yc)
    # The tests reckon from the centre in whole mm, so the rings do.
    xc = round(xc)
    yc = round(yc)
    r_in, r_out = _ring(env, xc, yc, margin)
    s_in, s_out = _ring(env, xc, yc, soft)
    c = env.consts
    b = k * _STRIDE
    c[b + _XC] = xc + _BIAS
    c[b + _YC] = yc + _BIAS
    c[b + _IN_SOFT] = int(s_in * s_in)
    c[b + _OUT_SOFT] = int(s_out * s_out) + 1
    c[b + _IN] = int(r_in * r_in)
    c[b + _OUT] = int(r_out * r_out) + 1
    # Bins are even in d * d: (d * d - r_in * r_in >> shift) * scale >> 12 = bin in 1/256, with both factors below 2**15.
    inner = c[b + _IN]
    span = c[b + _OUT] - inner
    shift = 0
    while span >> shift >= 32768:
        shift += 1
    c[b + _BIN_SHIFT] = shift
    scale = _BINS * 1048576 // (span >> shift)
    c[b + _BIN_SCALE] = scale
    c[b + _TURN_MM] = int(2 * pi * ref)
    c[b + _ANGLE_MAX] = min(int(look_ahead * 65536 / (2 * pi * ref)), 60000)
    c[b + _REF] = int(ref)


def _ring(env, xc, yc, margin):
    """Inner and outer radius of what the outline plus margin sweeps about (xc, yc), xc > 0."""
    hw = env.half_width + margin
    hl = env.half_length + margin
    dx = max(xc - hw, 0)
    dy = max(abs(yc) - hl, 0)
    return _hypot(dx, dy), _hypot(xc + hw, abs(yc) + hl)
