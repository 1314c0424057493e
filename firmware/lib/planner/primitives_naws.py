"""The motion primitives, from pose to pose, where the last axle stays straight. Loaded to make their table, then let go.

Where the last axle stays straight, its middle moves along the body only. In terms of the body's centre: a turn by one orientation on the tightest
circle moves the last axle's middle by a chord of that circle, and swings the centre, which is ahead of it, to the side.
"""

from array import array
from math import cos, pi, sin, tan

_TURNS = 12
_STEERING = pi / 3  # AF on the tightest circle
_ASIDE = 20  # times as expensive is a way square to the body: it takes much to and fro
_BACK = 6  # times as expensive is one driven backward: changes of direction come with it
_ROUND = ((-1, 1), (0, 1), (1, 1), (-1, 0), (1, 0), (-1, -1), (0, -1), (1, -1))
_ALONG = ((0, 1), (1, 4), (1, 2), (1, 1), (2, 1), (4, 1), (1, 0), (4, -1), (2, -1), (1, -1), (1, -2), (1, -4))


def ways(wheelbase, first_axle, cell):
    """The table: array('H'), for each of 24 headings of the nose 12 ways of two words: x + 8 << 4 | y + 8 (cells) and cost (1/16 cell).

    The first 8 keep the heading, 2 lead to the next one, 2 to the one before. Costs are propagated backward, from where a way leads to: what leads
    ahead in the table is driven backward.
    wheelbase, first_axle: mm, the latter ahead of the body's centre; cell: 1/8 mm.
    """
    cell /= 8
    radius = wheelbase / tan(_STEERING)
    behind = wheelbase - first_axle
    chord = 2 * radius * sin(pi / _TURNS / 2) / cell
    chords = _chords(chord)
    swung = 32 * (radius * radius + behind * behind) ** 0.5 * sin(pi / _TURNS / 2) / cell
    table = array("H")
    for t in range(2 * _TURNS):
        s = sin(t * pi / _TURNS)
        c = cos(t * pi / _TURNS)
        for x, y in _ROUND:
            r = (x * x + y * y) ** 0.5
            across = (x * c - y * s) / r
            if abs(across) < 0.9:  # but for the two most to the side
                ahead = max(0, (x * s + y * c) / r)
                _add(table, x, y, 16 * r * (1 + _ASIDE * across * across) * (1 + (_BACK - 1) * ahead))
        x, y = _along(t, _ALONG)
        r = 16 * (x * x + y * y) ** 0.5
        _add(table, x, y, r * _BACK)
        _add(table, -x, -y, r)
        for turn in (1, -1):
            x, y = _swing(t, t + turn, behind / cell)
            ax, ay = _along(min(t, t + turn), chords)  # the last axle's way
            _add(table, x + ax, y + ay, swung * _BACK)
            _add(table, x - ax, y - ay, swung)
    return table


def _along(t, table):
    """The entry of a table that goes half round, of any orientation."""
    x, y = table[t % _TURNS]
    return (-x, -y) if t % (2 * _TURNS) >= _TURNS else (x, y)


def _add(table, x, y, cost):
    table.append(x + 8 << 4 | y + 8)
    table.append(round(cost))


def _swing(t, to, behind):
    """Cells by which the centre comes to lie elsewhere as seen from the last axle. Whatever is turned, turning back undoes it."""
    a = t * pi / _TURNS
    b = to * pi / _TURNS
    return round(behind * sin(b)) - round(behind * sin(a)), round(behind * cos(b)) - round(behind * cos(a))


def _chords(length):
    """Chords of a circle in whole cells, one from each orientation to the next, along the body as far as may be; together as long as they should be."""
    quarter = []
    owed = 0
    for k in range(_TURNS // 4):
        s = sin((k + 0.5) * pi / _TURNS)
        c = cos((k + 0.5) * pi / _TURNS)
        least = 1e9
        one = 0, 1
        for x in range(7):
            for y in range(7):
                short = length + owed - (x * s + y * c)
                across = x * c - y * s
                error = 4 * across * across + short * short
                if x + y and error < least - 1e-6:
                    least = error
                    one = x, y
        owed += length - one[0] * s - one[1] * c
        quarter.append(one)
    quarter.extend([(y, x) for x, y in reversed(quarter)])
    return quarter + [(y, -x) for x, y in quarter]
