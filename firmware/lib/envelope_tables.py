"""The tables of envelope.py, computed once at the start.

Source: papers A section 4.2 and B section 3.2-3.3; the point rule (24) replaced by the whole swept body.
"""

from array import array
from math import atan2, cos, pi, sin, sqrt, tan

from micropython import const

_BIAS = const(8192)
_BINS = const(24)
_LENGTHS = const(5)
_STRIDE = const(13)

# Fields of a candidate's constants.
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
_SECOND = const(11)  # of its bins with a second entry: place in `seconds` << 10 | first << 5 | how many
_FRONT = const(12)  # least of all entries, and a little: no ring enters the outline farther on



def fill(env, config):
    """Every attribute of the Envelopes."""
    env.half_width = config.robot_width // 2
    env.half_length = config.robot_length // 2
    env.look_ahead = config.windows_look_ahead
    env.margin = config.avoid_margin
    env.soft = config.avoid_soft_margin
    env.wheelbase = sum(config.axles_spacings)
    env.first_axle = config.axles_first
    env.half_track = config.axles_track / 2
    pairs = _pairs(env, config.mode == "AWS")
    strips = (0, 6, 12, 20, 32, 50, 70, 90) if config.mode == "AWS" else (0,)
    env.arcs = len(pairs)
    # A last axle that stays straight is the first one of the mirror in which backward moves are tabulated.
    all_wheels = config.mode == "AWS"
    env.ahead_end = env.arcs if all_wheels else env.arcs // 2
    env.astern_first = 0 if all_wheels else env.arcs // 2
    env.count = env.arcs + len(strips)
    env.af = array("h", [p[0] * 10 for p in pairs] + [a * 10 for a in strips])
    env.ar = array("h", [p[1] * 10 for p in pairs] + [a * 10 for a in strips])
    la = env.look_ahead
    env.lengths = array("H", [la // 14, la // 7, la * 2 // 7, la * 4 // 7, la])
    env.consts = array("i", bytes(4 * env.arcs * _STRIDE))
    env.table = bytearray(2 * env.arcs * _BINS * 2)  # 16-bit words for the viper functions
    env.seconds = array("H")
    env.strips = array("i", bytes(4 * 8 * len(strips)))
    env.ends = array("H", bytes(2 * env.count * _LENGTHS * 2))
    env.turns = array("h", bytes(2 * env.count * _LENGTHS))
    for k in range(env.arcs):
        _fill_arc(env, k, env.margin, env.soft)
    for k in range(env.count - env.arcs):
        _fill_strip(env, k, env.margin, env.soft)
    _fill_ends(env)


def _pairs(env, all_wheels):
    """(AF, AR) of the arcs, degrees."""
    if not all_wheels:
        angles = (3, 6, 9, 12, 15, 18, 21, 25, 29, 33, 37, 41, 45, 50, 55, 60)
        return [(front, 0) for front in angles] + [(0, -rear) for rear in angles]
    angles = (0, 6, 12, 20, 28, 37, 47, 60)
    pairs = []
    for i, front in enumerate(angles):
        for j, rear in enumerate(angles):
            if (i or j) and (j == 0 or -4 <= i - j <= 4) and _beside(env, front, -rear):
                pairs.append((front, -rear))
    pairs.extend(((25, 10), (45, 25), (45, 10), (-10, -25), (-25, -45), (-10, -45)))
    return pairs


def _hypot(x, y):
    return sqrt(x * x + y * y)


def _beside(env, front, rear):
    """A centre under the body is left to spinning: its rings enter the outline on every side."""
    r = env.wheelbase / (tan(front * pi / 180) - tan(rear * pi / 180))
    return r > env.half_width + 16


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


def _fill_arc(env, k, margin, soft):
    xc, yc = centre(env, k)
    r_in, r_out = _ring(env, xc, yc, margin)
    s_in, s_out = _ring(env, xc, yc, soft)
    ref = _reference(env, xc, yc)
    c = env.consts
    b = k * _STRIDE
    c[b + _XC] = round(xc) + _BIAS
    c[b + _YC] = round(yc) + _BIAS
    c[b + _IN_SOFT] = int(s_in * s_in)
    c[b + _OUT_SOFT] = int(s_out * s_out) + 1
    c[b + _IN] = int(r_in * r_in)
    c[b + _OUT] = int(r_out * r_out) + 1
    # Bins are even in d * d: (d * d - r_in * r_in >> shift) * scale >> 12 = bin in 1/256, with both factors below 2**15.
    span = c[b + _OUT] - c[b + _IN]
    shift = 0
    while span >> shift >= 32768:
        shift += 1
    c[b + _BIN_SHIFT] = shift
    scale = _BINS * 1048576 // (span >> shift)
    c[b + _BIN_SCALE] = scale
    c[b + _TURN_MM] = int(2 * pi * ref)
    c[b + _ANGLE_MAX] = min(int(env.look_ahead * 65536 / (2 * pi * ref)), 60000)
    c[b + _REF] = int(ref)
    hw = env.half_width + margin
    hl = env.half_length + margin
    width = 1048576 / scale * (1 << shift)  # of a bin, square mm
    table = env.table
    front = 65535
    again = []  # (first, last) from the first bin on that has two entries
    second_bin = 0
    for j in range(_BINS):
        low = _entries(env, xc, yc, hw, hl, sqrt(c[b + _IN] + (j + 0.02) * width))
        high = _entries(env, xc, yc, hw, hl, sqrt(c[b + _IN] + (j + 0.98) * width))
        if not low:
            low = high
        if not high:
            high = low
        first = last = 0, 0
        if low:
            first = low[0], high[0]
            last = low[-1], high[-1]
            middle = _entries(env, xc, yc, hw, hl, sqrt(c[b + _IN] + (j + 0.5) * width))
            if len(middle) == len(low) == len(high):
                # Where the outline bends towards the point a straight line would come late.
                first = _not_late(first, middle[0])
                last = _not_late(last, middle[-1])
            if len(low) != len(high):  # a second arc begins within the bin
                both = low if len(low) > len(high) else high
                first = both[0], both[0]
                last = both[-1], both[-1]
        for value in first + last:
            if 0 < value < front:
                front = value
        t = (k * _BINS + j) * 4
        for value in first:
            table[t] = value & 0xFF
            table[t + 1] = value >> 8
            t += 2
        if last != first and not again:
            second_bin = j
        if last != first or again:
            again.append((first, last))
    c[b + _FRONT] = front - 200
    while again and again[-1][0] == again[-1][1]:
        again.pop()
    c[b + _SECOND] = len(env.seconds) << 10 | second_bin << 5 | len(again)
    for _, last in again:
        env.seconds.append(last[0])
        env.seconds.append(last[1])


def _not_late(ends, middle):
    """Both ends of a bin moved so that the line between them does not pass its middle."""
    late = (ends[0] + ends[1]) // 2 - middle
    return (ends[0] - late, ends[1] - late) if late > 0 else ends


def _ring(env, xc, yc, margin):
    """Inner and outer radius of what the outline plus margin sweeps about (xc, yc), xc > 0."""
    hw = env.half_width + margin
    hl = env.half_length + margin
    dx = max(xc - hw, 0)
    dy = max(abs(yc) - hl, 0)
    return _hypot(dx, dy), _hypot(xc + hw, abs(yc) + hl)


def _entries(env, xc, yc, hw, hl, d):
    """Angles (1/65536 turn, anticlockwise from +x about the centre) where the ring of radius d enters the outline."""
    found = []
    for edge in range(4):
        if edge == 0:  # right side, entered leftwards
            x = hw - xc
            q = d * d - x * x
            if q < 0:
                continue
            y = sqrt(q)
        elif edge == 1:  # front, entered downwards
            y = hl - yc
            q = d * d - y * y
            if q < 0:
                continue
            x = -sqrt(q)
        elif edge == 2:  # left side, entered rightwards
            x = -hw - xc
            q = d * d - x * x
            if q < 0:
                continue
            y = -sqrt(q)
        else:  # rear, entered upwards
            y = -hl - yc
            q = d * d - y * y
            if q < 0:
                continue
            x = sqrt(q)
        if -hw - 0.01 <= x + xc <= hw + 0.01 and -hl - 0.01 <= y + yc <= hl + 0.01:
            found.append(int(atan2(y, x) * 32768 / pi) & 0xFFFF)
    found.sort()
    return found


def _fill_strip(env, k, margin, soft):
    a = env.af[env.arcs + k] * pi / 1800
    s = sin(a)
    c = cos(a)
    hw = env.half_width + margin
    hl = env.half_length + margin
    b = k * 8
    t = env.strips
    t[b] = round(s * 16384)
    t[b + 1] = round(c * 16384)
    t[b + 2] = int((hw * c + hl * s) * 16)
    t[b + 3] = int(((env.half_width + soft) * c + (env.half_length + soft) * s) * 16)
    t[b + 4] = int((hw * c - hl * s) * 16) + 131072
    t[b + 5] = int((hw * s + hl * c) * 16)
    t[b + 6] = min(int(s / c * 1024), 60000) if c > 0.01 else 60000
    t[b + 7] = min(int(c / s * 1024), 60000) if s > 0.01 else 60000


def _fill_ends(env):
    for k in range(env.count):
        for i in range(_LENGTHS):
            x, y, turn = end(env, k, env.lengths[i])
            t = (k * _LENGTHS + i) * 2
            env.ends[t] = round(x) + _BIAS
            env.ends[t + 1] = round(y) + _BIAS
            env.turns[k * _LENGTHS + i] = round(turn * 1800 / pi)


def end(env, k, length):
    """Pose (x, y mm, clockwise turn in rad) of the body centre after `length` mm of travel on candidate k."""
    if k >= env.arcs:
        a = env.af[k] * pi / 1800
        return length * sin(a), length * cos(a), 0.0
    xc, yc = centre(env, k)
    turn = length / _reference(env, xc, yc)
    s = sin(turn)
    c = cos(turn)
    return xc - xc * c - yc * s, yc + xc * s - yc * c, turn
