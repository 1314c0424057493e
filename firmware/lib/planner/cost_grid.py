"""Making the grid of costs: what is closed, what has been visited, where the exits are. The stages of cost_to_go.py before propagate.py.

A grid of poses: 26 x 26 places, each a cell of 1/12 body length, 12 orientations of 15 degrees. Masks hold a 32-bit word a row, a bit a column.
Lengths on the floor are 1/8 mm modulo 2**16.
"""

import micropython
from micropython import const

_N = const(26)
_TURNS = const(12)
_ROWS = const(312)
_ALL = const(0x03FFFFFF)  # columns of a row
_KNEE = const(216)  # of costs: see propagate.py
_TRAIL = const(120)  # points of the trail
_VISITS = const(40)  # a revisit cost rises no further
_EMPTY = const(0xF0)  # footprint mask without a column
_SHAPES = const(7)  # orientations that have masks: the others are their mirror images
_MIRROR = const(0x110)  # less both columns, exchanged: the mask the other way round
_MARGIN = const(8)  # cells round the grid from which points reach into it

# Fields of the job.
_X = const(0)  # of the grid's corner
_Y = const(1)
_CELL = const(2)
_RADIUS = const(3)  # round the trail, of what counts as visited
_REACH = const(4)  # rows of a footprint mask to each side
_SIZE = const(5)  # log2 of the floor cells of known_exits.py, 1/8 mm
FIELDS = const(6)


@micropython.viper
def fill(words: ptr16, n: int, value: int):
    """Put the value into the first n of 16-bit words."""
    while n > 0:
        n -= 1
        words[n] = value


@micropython.viper
def cover(job: ptr32, first: int, revisit: ptr8, trail: ptr16, last: int):
    """Make the places within the radius of each point first..last-1 of the trail more expensive, each time it is called."""
    cell = job[_CELL]
    radius = job[_RADIUS]
    half = cell >> 1
    room = radius * radius
    k = first % _TRAIL
    while first < last:
        x = (((trail[2 * k] - job[_X]) & 0xFFFF) ^ 0x8000) - 0x8000
        y = (((trail[2 * k + 1] - job[_Y]) & 0xFFFF) ^ 0x8000) - 0x8000
        first += 1
        k += 1
        if k == _TRAIL:
            k = 0
        i0 = (x - radius) // cell
        i1 = (x + radius) // cell
        j = (y - radius) // cell
        j1 = (y + radius) // cell
        if i0 < 0:
            i0 = 0
        if j < 0:
            j = 0
        if i1 > _N - 1:
            i1 = _N - 1
        if j1 > _N - 1:
            j1 = _N - 1
        while j <= j1:
            dy = j * cell + half - y
            dy = room - dy * dy
            i = j * _N + i0
            last_i = j * _N + i1
            dx = i0 * cell + half - x
            while i <= last_i:
                if dx * dx <= dy and revisit[i] < _VISITS:
                    revisit[i] = revisit[i] + 1
                dx += cell
                i += 1
            j += 1


@micropython.viper
def close(first: int, job: ptr32, seen: ptr32, closed: ptr32, near: ptr32, masks: ptr8, fx: ptr16, fy: ptr16, last: int, most: int) -> int:
    """Close the poses whose outline covers one of the points first..last-1, and mark in `near` those whose full outline does.

    A point is taken to the half cell it lies in (seen: those that had one already). The footprint mask of the half cell (footprint_masks.py) says for each orientation and
    for 2 * reach + 1 rows which of the columns round the point's own, 8, are closed. As bits, and shifted to that column, they are laid on the row:

        mask     0 0 1 1 1 0 0 0         column 8 is the point's
        row      . . . . . . . . . . . . columns 0.. are the grid's

    Beyond 90 degrees the masks serve mirrored, from the last but one back: those of the half cell on the other side.

    Stops after `most` points that count. Returns the first point not looked at.
    """
    edge = job[_CELL] * _MARGIN
    across = job[_CELL] * (_N + 2 * _MARGIN)
    inverse = 4194304 // job[_CELL]  # 2**22 / cell
    reach = job[_REACH]
    high = reach + reach + 1
    while first < last and most > 0:
        x = (((fx[first] - job[_X] + edge) & 0xFFFF) ^ 0x8000) - 0x8000
        y = (((fy[first] - job[_Y] + edge) & 0xFFFF) ^ 0x8000) - 0x8000
        first += 1
        if x < 0 or y < 0 or x >= across or y >= across:
            continue
        x = x * inverse >> 21  # half cells
        y = y * inverse >> 21
        m = 1 << (x & 31)
        i = y * 3 + (x >> 5)
        if seen[i] & m:
            continue
        seen[i] = seen[i] | m
        phase = ((y & 1) << 1) + (x & 1)
        step = high + high
        s = phase * _SHAPES * step
        x = x >> 1
        left = 0
        right = 16 - x
        if x > 16:
            left = x - 16
            right = 0
        y = (y >> 1) - _MARGIN - reach
        top = y + high
        lost = 0
        if y < 0:
            lost = 0 - y
            y = 0
        if top > _N:
            top = _N
        if y >= top:
            continue
        most -= 1
        t = 0
        while t < _ROWS:
            if t == _SHAPES * _N:
                s = ((phase ^ 1) * _SHAPES + _SHAPES - 2) * step
                step = 0 - step
            i = s + lost + lost
            row = t + y
            end = t + top
            while row < end:
                m = masks[i]
                if m != _EMPTY:
                    if step < 0:
                        m = _MIRROR - ((m & 15) << 4) - (m >> 4)
                    m = (2 << (m & 15)) - (1 << (m >> 4))
                    near[row] = near[row] | (((m << left) >> right) & _ALL)
                    m = masks[i + 1]
                    if m != _EMPTY:
                        if step < 0:
                            m = _MIRROR - ((m & 15) << 4) - (m >> 4)
                        m = (2 << (m & 15)) - (1 << (m >> 4))
                        closed[row] = closed[row] | (((m << left) >> right) & _ALL)
                i += 2
                row += 1
            s += step
            t += _N
    return first


@micropython.viper
def seed(cost: ptr8, closed: ptr32, fallen: ptr32, ux: int, uy: int, sense: int, shift: int, rim: ptr16, exits: ptr8):
    """Open poses on the rim are exits, marked in `fallen`; those in the direction (ux, uy) * 2**10 are the cheapest, but none is cheaper than known_exits.py says.

    sense: of heading_branch.apply(); shift: log2 of sixteenths of a cell in a unit of cost; rim: what each of 24 headings of the nose adds on the far rim (primitives.rim()).
    """
    row = 0
    while row < _ROWS:
        t = row // _N
        y = row - t * _N
        # Heading of the nose as the far rim sees it, whichever side this is.
        h = t + _TURNS * (sense >> t & 1)
        step = 1
        known = (y & 1) * _N
        if y == 0:
            h += 12
        elif y < _N - 1:
            h += 6
            step = _N - 1
            known = 2 * _N + y
        marks = 0
        x = 0
        while x < _N:
            if x == step and x != 1:
                h += 12
            if h >= 2 * _TURNS:
                h -= 2 * _TURNS
            if ((closed[row] >> x) & 1) == 0:
                # 8 cells straight ahead, none at the corner ahead; behind, 3 times the way there more
                c = ((35 << 10) - (x + x - _N + 1) * ux - (y + y - _N + 1) * uy) * 13 >> 10
                if c < 0:
                    c = 0
                c = (c + rim[h]) >> shift
                if c > _KNEE:
                    c = _KNEE + ((c - _KNEE) >> 2)
                if exits[known + x] > c:
                    c = exits[known + x]
                cost[row * _N + x] = c
                marks = marks | (1 << x)
            x += step
        fallen[row] = marks
        row += 1
