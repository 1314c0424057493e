"""Makes the tables of candidates.py. Loaded where there is no file of them, then let go.

Where a ring enters the outline: papers A section 4.2 and B section 3.2-3.3, the point rule (24) replaced by the whole swept body.
"""

from array import array
from math import atan2, cos, pi, sin, sqrt, tan

from micropython import const

_BIAS = const(8192)
_BINS = const(16)
_LENGTHS = const(5)
_SECONDS = const(8)  # for each arc: enough for the usual body with any margin; for others it grows
_STRIP_STRIDE = const(8)

# Fields of an arc's constants, 16-bit words
_STRIDE = const(8)
_XC = const(0)  # the turning centre, mm + 8192
_YC = const(1)
_TURN_MM = const(2)  # travel of a whole turn, mm: low word, high word
_REF = const(4)  # distance of the fastest wheel from the centre, mm
_FRONT = const(5)  # least of all entries, and a little: no ring enters the outline farther on
_SECOND = const(6)  # of its bins with a second entry: place in `seconds`,
_SECOND_BINS = const(7)  # shift of the table's slopes << 10 | first bin << 5 | how many


def make(config):
    """The arrays of a Candidates, in the order of tables.load()."""
    draft = Draft(config)
    for k in range(draft.count):
        for i in range(_LENGTHS):
            x, y, _ = end(draft, k, draft.lengths[i])
            t = (k * _LENGTHS + i) * 2
            draft.ends[t] = round(x) + _BIAS
            draft.ends[t + 1] = round(y) + _BIAS
        if k < draft.arcs:
            _arc(draft, k)
            _ring_table(draft, k)
        else:
            _strip(draft, k - draft.arcs)
    return draft.af, draft.ar, draft.lengths, draft.consts, draft.table, draft.seconds[: draft.used], draft.strips, draft.ends, draft.turns


class Draft:
    """Tables in the making: the arrays of a Candidates under the same names, and what is needed of the robot to fill them, in mm."""

    def __init__(self, config):
        self.half_width = config.robot_width // 2
        self.half_length = config.robot_length // 2
        self.wheelbase = sum(config.axles_spacings)
        self.first_axle = config.axles_first
        self.half_track = config.axles_track / 2
        self.margin = config.avoid_margin
        self.soft = config.avoid_soft_margin
        self.look_ahead = config.windows_look_ahead
        # A last axle that stays straight is the first one of the mirror in which backward moves are tabulated.
        all_wheels = config.mode == "AWS"
        pairs = _pairs(self, all_wheels)
        strips = (0, 6, 12, 20, 32, 50, 70, 90) if all_wheels else (0,)
        self.arcs = len(pairs)
        self.count = self.arcs + len(strips)
        self.af = array("h", [p[0] * 10 for p in pairs] + [a * 10 for a in strips])
        self.ar = array("h", [p[1] * 10 for p in pairs] + [a * 10 for a in strips])
        self.lengths = array("H", [self.look_ahead * part // 14 for part in (1, 2, 4, 8, 14)])
        self.consts = array("H", bytes(2 * self.arcs * _STRIDE))
        self.table = bytearray(3 * self.arcs * _BINS)  # see _lay()
        self.seconds = array("H", bytes(2 * _SECONDS * self.arcs))
        self.strips = array("i", bytes(4 * _STRIP_STRIDE * len(strips)))
        self.ends = array("H", bytes(2 * self.count * _LENGTHS * 2))
        self.turns = array("H", bytes(2 * self.count))
        self.used = 0  # of seconds


def _pairs(draft, all_wheels):
    """(AF, AR) of the arcs, degrees."""
    if not all_wheels:
        angles = (3, 6, 9, 12, 15, 18, 21, 25, 29, 33, 37, 41, 45, 50, 55, 60)
        return [(front, 0) for front in angles] + [(0, -rear) for rear in angles]
    angles = (0, 6, 12, 20, 28, 37, 47, 60)
    pairs = []
    for i, front in enumerate(angles):
        for j, rear in enumerate(angles):
            if (i or j) and (j == 0 or -4 <= i - j <= 4) and _beside(draft, front, -rear):
                pairs.append((front, -rear))
    pairs.extend(((25, 10), (45, 25), (45, 10), (-10, -25), (-25, -45), (-10, -45)))
    return pairs


def _beside(draft, front, rear):
    """A centre under the body is left to spinning: its rings enter the outline on every side."""
    r = draft.wheelbase / (tan(front * pi / 180) - tan(rear * pi / 180))
    return r > draft.half_width + 16


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
    """Pose (x, y mm, clockwise turn in rad) of the body centre after `length` mm of travel on candidate k."""
    if k >= draft.arcs:
        a = draft.af[k] * pi / 1800
        return length * sin(a), length * cos(a), 0.0
    xc, yc = centre(draft, k)
    turn = length / _reference(draft, xc, yc)
    s = sin(turn)
    c = cos(turn)
    return xc - xc * c - yc * s, yc + xc * s - yc * c, turn


def _arc(draft, k):
    xc, yc = centre(draft, k)
    ref = _reference(draft, xc, yc)
    c = draft.consts
    b = k * _STRIDE
    # The checks count from the centre in whole mm, so the rings do.
    c[b + _XC] = round(xc) + _BIAS
    c[b + _YC] = round(yc) + _BIAS
    turn_mm = int(2 * pi * ref)
    c[b + _TURN_MM] = turn_mm & 0xFFFF
    c[b + _TURN_MM + 1] = turn_mm >> 16
    c[b + _REF] = int(ref)
    draft.turns[k] = min(round(16384 * 1800 / (pi * ref)), 65535)


def _ring_table(draft, k):
    """The table of an arc: where each ring enters the outline, for points within the margin; and what of its constants belongs to that."""
    used = draft.used
    c = draft.consts
    b = k * _STRIDE
    xc = c[b + _XC] - _BIAS
    yc = c[b + _YC] - _BIAS
    edges = _edges(draft, xc, yc)
    inner, width = _rings(draft, xc, yc)
    front = 65535
    firsts = []
    seconds = draft.seconds
    first_used = used
    second_bin = 0
    after = used  # the last bin with two entries ends here
    for j in range(_BINS):
        first, last = _bin(edges, inner + j * width, width)
        for value in first + last:
            if 0 < value < front:
                front = value
        firsts.append(first)
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
    c[b + _SECOND] = first_used
    c[b + _SECOND_BINS] = _lay(draft, k, firsts) << 10 | second_bin << 5 | (after - first_used) >> 1
    draft.used = after


def _lay(draft, k, entries):
    """An arc's bins in the table: the entries at their inner ends, 16-bit words, then a byte for each: by how much the entry at the outer end is larger.

    Returns the shift: the bytes are in units of 2**shift, signed.
    """
    shift = 0
    for low, high in entries:
        while not -128 <= (high - low) >> shift < 128:
            shift += 1
    t = k * _BINS * 3
    for j, (low, high) in enumerate(entries):
        draft.table[t + 2 * j] = low & 0xFF
        draft.table[t + 2 * j + 1] = low >> 8
        draft.table[t + 2 * _BINS + j] = (high - low) >> shift & 0xFF  # rounded down: never late
    return shift


def _rings(draft, xc, yc):
    """The square of the least radius that the outline passes about (xc, yc), xc > 0, and the width of a bin, square mm, as collision.py takes them."""
    hw = draft.half_width + draft.margin
    hl = draft.half_length + draft.margin
    inner = max(xc - hw, 0) ** 2 + max(abs(yc) - hl, 0) ** 2
    span = (xc + hw) ** 2 + (abs(yc) + hl) ** 2 + 1 - inner
    shift = 0
    while span >> shift >= 32768:
        shift += 1
    return inner, 1048576 / (_BINS * 1048576 // (span >> shift)) * (1 << shift)


def _bin(edges, square, width):
    """Where the rings of a bin enter first and last, each at the bin's two ends; 0 where they do not. square: of its least radius."""
    low = _entries(edges, square + 0.02 * width)
    high = _entries(edges, square + 0.98 * width)
    if not low:
        low = high
    if not high:
        high = low
    if not low:
        return (0, 0), (0, 0)
    if len(low) != len(high):  # a second arc begins within the bin
        both = low if len(low) > len(high) else high
        return (both[0], both[0]), (both[-1], both[-1])
    first = low[0], high[0]
    last = low[-1], high[-1]
    middle = _entries(edges, square + 0.5 * width)
    if len(middle) == len(low):
        # Where the outline bends towards the point a straight line would come late.
        first = _not_late(first, middle[0])
        last = _not_late(last, middle[-1])
    return first, last


def _not_late(ends, middle):
    """Both ends of a bin moved so that the line between them does not pass its middle."""
    late = (ends[0] + ends[1]) // 2 - middle
    return (ends[0] - late, ends[1] - late) if late > 0 else ends


def _edges(draft, xc, yc):
    """Right, front, left and rear edge of the outline plus margin, seen from the centre: where, squared; then its ends, low and high.

    Made once a candidate: on the board every float is an object.
    """
    hw = draft.half_width + draft.margin
    hl = draft.half_length + draft.margin
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


def _strip(draft, k):
    """What collision.py reads of a straight or crab candidate."""
    a = draft.af[draft.arcs + k] * pi / 1800
    s = sin(a)
    c = cos(a)
    hw = draft.half_width + draft.margin
    hl = draft.half_length + draft.margin
    b = k * _STRIP_STRIDE
    t = draft.strips
    t[b] = round(s * 16384)
    t[b + 1] = round(c * 16384)
    t[b + 2] = int((hw * c + hl * s) * 16)
    t[b + 3] = int(((draft.half_width + draft.soft) * c + (draft.half_length + draft.soft) * s) * 16)
    t[b + 4] = int((hw * c - hl * s) * 16) + 131072
    t[b + 5] = int((hw * s + hl * c) * 16)
    t[b + 6] = min(int(s / c * 1024), 60000) if c > 0.01 else 60000
    t[b + 7] = min(int(c / s * 1024), 60000) if s > 0.01 else 60000
