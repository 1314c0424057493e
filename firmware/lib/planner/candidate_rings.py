"""Where each ring enters the outline: the tables of candidates.py for candidates that turn. Loaded to fill them, then let go.

Source: papers A section 4.2 and B section 3.2-3.3; the point rule (24) replaced by the whole swept body.
"""

from math import atan2, pi, sqrt

from micropython import const

_BIAS = const(8192)
_BINS = const(16)

# Fields of an arc's constants: see candidate_arcs.py
_STRIDE = const(8)
_XC = const(0)
_YC = const(1)
_FRONT = const(5)  # least of all entries, and a little: no ring enters the outline farther on
_SECOND = const(6)  # of its bins with a second entry: place in `seconds`,
_SECOND_BINS = const(7)  # shift of the table's slopes << 10 | first bin << 5 | how many


def fill(draft):
    """table, seconds and the rest of consts of each arc of a candidate_set.Draft, for points within its margin."""
    for k in range(draft.arcs):
        draft.used = _fill_arc(draft, k, draft.used)


def _fill_arc(draft, k, used):
    """Returns how many of `seconds` are used afterwards."""
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
    return after


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
