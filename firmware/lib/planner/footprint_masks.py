"""The outline on the grid of cost_to_go.py. Loaded to make the masks, then let go."""

from math import cos, pi, sin

from micropython import const

_TURNS = const(12)
_SHAPES = const(7)
_EMPTY = const(0xF0)


def masks(width, length, margin, cell):
    """bytearray: which poses a point closes, for cost_grid.py to lay on its rows.

    width, length, margin: mm; cell: 1/8 mm. A point stands in the middle of one of the four half cells of a place; for each of them, each
    orientation from 0 to 90 degrees (the others mirror them) and each row of the grid from `reach` below the point to `reach` above it, two bytes: first column << 4 | last column, 8 being the
    point's own; 0xF0 for none. The first is of poses whose full outline, with the margin, covers the point, the second of those whose outline made smaller
    does. Poses in which a point comes into the outline proper are expensive; closed are only those in which it comes well into it, or narrow passages
    would close on the grid.
    """
    full = width * 4 + margin * 8, length * 4 + margin * 8
    small = width * 4 - cell * 3 // 10, length * 4 - cell * 6 // 10
    reach = int((full[0] * full[0] + full[1] * full[1]) ** 0.5 / cell + 0.25)
    table = bytearray(2 * 4 * _SHAPES * (2 * reach + 1))
    at = 0
    for phase in range(4):
        across = (phase & 1) * 0.5 - 0.25
        for t in range(_SHAPES):
            s = sin(t * pi / _TURNS)
            c = cos(t * pi / _TURNS)
            for row in range(-reach, reach + 1):
                up = (phase >> 1) * 0.5 - 0.25 - row  # of the point as seen from the pose, cells
                for half_width, half_length in (full, small):
                    table[at] = _columns(half_width / cell, half_length / cell, s, c, across, up)
                    at += 1
    return table


def _columns(half_width, half_length, s, c, across, up):
    """First and last of the columns in which the outline at sine s, cosine c covers a point `across` and `up` of the pose's place; all in cells."""
    low, high = -8.0, 7.0
    for offset, slope, half in ((-up * s, c, half_width), (up * c, s, half_length)):
        # |offset + slope * d| < half, d being the point's distance to the right of the pose
        if abs(slope) < 1e-6:
            if abs(offset) >= half:
                return _EMPTY
            continue
        ends = across - (-half - offset) / slope, across - (half - offset) / slope
        low = max(low, min(ends))
        high = min(high, max(ends))
    first = -int(-low) if low < 0 else int(low + 0.999999)
    last = int(high) if high >= 0 else -int(-high + 0.999999)
    if first > last:
        return _EMPTY
    return first + 8 << 4 | last + 8
