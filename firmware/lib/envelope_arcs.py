"""The tables of envelope.py for candidates that turn. Loaded to fill them, then let go.

Source: papers A section 4.2 and B section 3.2-3.3; the point rule (24) replaced by the whole swept body.
"""

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


def fill(env, margin, soft, look_ahead):
    """lengths; consts, table, seconds, ends and turns of each arc. All lengths in mm."""
    for i, part in enumerate((1, 2, 4, 8, 14)):
        env.lengths[i] = look_ahead * part // 14
    used = 0
    for k in range(env.arcs):
        used = _fill_arc(env, k, margin, soft, look_ahead, used)
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


def _fill_arc(env, k, margin, soft, look_ahead, used):
    """Returns how many of `seconds` are used afterwards."""
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
    edges = _edges(env, xc, yc, margin)
    width = 1048576 / scale * (1 << shift)  # of a bin, square mm
    table = env.table
    front = 65535
    seconds = env.seconds
    first_used = used
    second_bin = 0
    after = used  # the last bin with two entries ends here
    for j in range(_BINS):
        low = _entries(edges, inner + (j + 0.02) * width)
        high = _entries(edges, inner + (j + 0.98) * width)
        if not low:
            low = high
        if not high:
            high = low
        first = last = 0, 0
        if low:
            first = low[0], high[0]
            last = low[-1], high[-1]
            middle = _entries(edges, inner + (j + 0.5) * width)
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
        if last != first and used == first_used:
            second_bin = j
        if last != first or used > first_used:
            for value in last:
                if used < len(seconds):
                    seconds[used] = value
                else:
                    seconds.append(value)
                used += 1
            if last != first:
                after = used
    c[b + _FRONT] = front - 200
    c[b + _SECOND] = first_used << 10 | second_bin << 5 | (after - first_used) >> 1
    return after


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


def _edges(env, xc, yc, margin):
    """Right, front, left and rear edge of the outline plus margin, seen from the centre: where, squared; then its ends, low and high.

    Made once a candidate: on the board every float is an object.
    """
    hw = env.half_width + margin
    hl = env.half_length + margin
    left, right = -hw - xc, hw - xc
    rear, front = -hl - yc, hl - yc
    return (
        (right, right * right, rear - 0.01, front + 0.01), (front, front * front, left - 0.01, right + 0.01),
        (left, left * left, rear - 0.01, front + 0.01), (rear, rear * rear, left - 0.01, right + 0.01),
    )  # fmt: skip


def _entries(edges, square):
    """Angles (1/65536 turn, anticlockwise from +x about the centre) where the ring enters the outline; square: of its radius."""
    found = []
    for edge in range(4):
        where, squared, low, high = edges[edge]
        q = square - squared
        if q < 0:
            continue
        # right side, entered leftwards; front, downwards; left side, rightwards; rear, upwards
        q = sqrt(q)
        if edge == 1 or edge == 2:
            q = -q
        if low <= q <= high:
            angle = atan2(where, q) if edge & 1 else atan2(q, where)
            found.append(int(angle * 32768 / pi) & 0xFFFF)
    found.sort()
    return found
