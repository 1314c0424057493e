"""Which end of the body is the front in each orientation of the grid.

The grid stores 12 orientations over 180 degrees, each of which serves for two headings of the nose. The half turn is laid round the way the nose points now,
and leant over to the side to which the way out leads, by half its bearing: so a bend of more than 90 degrees is driven round nose first within it,
and the other way round, rear first, is not. Where the half turn ends, the orientation square to its middle, is closed: the costs on its two sides
are those of two noses.
"""

from array import array

from micropython import const

from core.trig import cos14, sin14

_N = const(26)
_PLACES = const(676)
_STATES = const(8112)
_ALL = const(0x03FFFFFF)  # columns of a row of the grid
_OUT = const(255)  # cost of what is closed or not reached
_TURNS = const(12)
_STEPS = const(14)  # more would take longer than a slice
_LARGEST = const(4)  # lean: so the closed orientation stays 30 degrees off the body's own
# Numbers of the next poses less that of this one, + _PLACES: of two that cost the same the straight way is taken; the orientations come last.
_NEXT = array("H", (702, 650, 677, 675, 703, 701, 651, 649, 1352, 0))


def _exit(at, cost):
    """The pose to which the costs lead from pose `at`, each time on to the cheapest next one: on the rim, or so many steps on that it tells the way. -1 if they do not."""
    least = cost[at]
    for _ in range(_STEPS):
        x = at % _N
        y = at // _N % _N
        if x == 0 or x == _N - 1 or y == 0 or y == _N - 1:
            return at
        to = at
        for d in range(10):
            i = (at + _NEXT[d] - _PLACES) % _STATES
            if cost[i] < least:
                least = cost[i]
                to = i
        if to == at:
            return -1
        at = to
    return at


def choose(cost, x, y, heading):
    """By how many orientations to lean over, -4..4, right positive: half the bearing at which the costs lead out; 0 if that is behind the body.

    x, y: the corner between places of the grid nearest to the body; heading: 0.1 deg.
    """
    if not (1 < x < _N - 1 and 1 < y < _N - 1):
        return 0
    # from the cheapest of the four places at the corner
    least = _OUT
    last = ((heading + 75) // 150 % _TURNS * _N + y) * _N + x
    for k in range(4):
        place = last - (k & 1) - (k >> 1) * _N
        if cost[place] < least:
            least = cost[place]
            found = place
    if least < _OUT:
        found = _exit(found, cost)
    if least == _OUT or found < 0:
        return 0
    x = 2 * (found % _N - x) + 1
    y = 2 * (found // _N % _N - y) + 1
    most = 0
    bearing = 0  # in 30 degrees
    for k in range(12):
        # From ahead to both sides: of two that fit as well it is the one nearer to ahead, left and right alike.
        k = (k + 1) // 2 * (1 - (k & 1) * 2)
        along = x * sin14(heading + 300 * k) + y * cos14(heading + 300 * k)
        if along > most:
            most = along
            bearing = k
    return bearing if -_LARGEST <= bearing <= _LARGEST else 0


def apply(heading, leant, closed):
    """Close the orientation at which the half turn ends. Returns a bit for each orientation of which the nose points the other way.

    heading: 0.1 deg; leant: of choose(); closed: mask rows of the grid, two 16-bit words each.
    """
    middle = (heading + 75) // 150 + leant
    sense = 0
    for t in range(_TURNS):
        if 6 < (t - middle) % (2 * _TURNS) < 18:
            sense |= 1 << t
    first = (middle + 6) % _TURNS * _N
    for row in range(first, first + _N):
        closed[2 * row] = _ALL & 0xFFFF
        closed[2 * row + 1] = _ALL >> 16
    return sense
