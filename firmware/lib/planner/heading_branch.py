"""Which way the nose points in each orientation of the field.

There is room for half a turn of orientations only, each of which serves for two noses. The half turn is laid round the way the nose points now,
and leant over to the side to which the way leads on, by half its bearing: so a bend of more than 90 degrees is driven round nose first within it,
and the other way round, rear first, is not. Where the half turn ends, the orientation square to its middle, is closed: the costs on its two sides
are those of two noses.
"""

import micropython
from micropython import const

from core.trig import cos14, sin14

_N = const(30)
_TURNS = const(12)
_LARGEST = const(4)  # lean: so the closed orientation stays 30 degrees off the body's own
# Numbers of the next places less that of this one, + 31: of two that cost the same the straight way is taken.
_NEXT = bytes((61, 1, 32, 30, 62, 60, 2, 0))


@micropython.viper
def _exit(cost: ptr16, next_places: ptr8, x: int, y: int, t: int) -> int:
    """The pose of the grid at which the costs leave it from orientation t at the corner between four places, of which x, y is the last.

    Each time on to the cheapest next one; -1 if all four are closed.
    """
    least = 32767
    at = 0
    d = 0
    while d < 4:
        i = (t * 30 + y - (d >> 1)) * 30 + x - (d & 1)
        c = cost[i] & 0x7FFF
        if c < least:
            least = c
            at = i
        d += 1
    if least == 32767:
        return -1
    while True:
        row = at // 30
        x = at - row * 30
        y = row % 30
        if x <= 1 or x >= 28 or y <= 1 or y >= 28:
            return at
        to = at
        d = 0
        while d < 10:
            if d < 8:
                i = at + next_places[d] - 31
            elif d == 8:
                i = at + 900
                if i >= 10800:
                    i -= 10800
            else:
                i = at - 900
                if i < 0:
                    i += 10800
            c = cost[i] & 0x7FFF
            if c < least:
                least = c
                to = i
            d += 1
        if to == at:
            return -1
        at = to


def lean(cost, x, y, heading):
    """By how many orientations to lean over, -4..4, right positive: half the bearing at which the costs lead out; 0 if that is behind the body.

    x, y: the corner between places of the grid nearest to the body; heading: 0.1 deg.
    """
    if not (2 < x < _N - 2 and 2 < y < _N - 2):
        return 0
    found = _exit(cost, _NEXT, x, y, (heading + 75) // 150 % _TURNS)
    if found < 0:
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


def tell(heading, leant, state, closed):
    """Set state[3]: a bit for each orientation of which the nose points the other way; and close the orientation at which the half turn ends.

    heading: 0.1 deg; leant: of lean(); closed: rows of the field.
    """
    middle = (heading + 75) // 150 + leant
    sense = 0
    for t in range(_TURNS):
        if 6 < (t - middle) % (2 * _TURNS) < 18:
            sense |= 1 << t
    state[3] = sense
    first = (middle + 6) % _TURNS * _N
    for row in range(first, first + _N):
        closed[row] = 0x3FFFFFFF
