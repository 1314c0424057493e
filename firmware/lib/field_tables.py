"""What field.py looks up: outlines on the grid, made anew when the margin is tuned, and the cost of steps."""

from array import array
from math import cos, pi, sin, tan

from micropython import const

_TURNS = const(12)
_WAYS = ((-1, 1), (0, 1), (1, 1), (-1, 0), (1, 0), (-1, -1), (0, -1), (1, -1))


def shape(width, length, margin, cell, table=None):
    """For each orientation the slopes and offsets of the outline's edges, a row of the grid at a time, as field.py closes poses by them.

    width, length, margin: mm; cell: 1/8 mm; table: one made before, to be filled again in place. Poses in which a point comes into the
    outline proper are dear; closed are only those in which it comes well into it, or narrow passages would close on the grid.
    """
    half_width = width * 4
    half_length = length * 4
    margin *= 8
    if table is None:
        table = array("i", [0] * 85)
    far = 1 << 20
    for t in range(_TURNS):
        s = sin(t * pi / _TURNS)
        c = abs(cos(t * pi / _TURNS))
        b = t * 7
        upright = t == _TURNS // 2
        table[b] = 65536 + (0 if upright else round(1024 * tan(t * pi / _TURNS)))
        table[b + 1] = 65536 + (round(-1024 / tan(t * pi / _TURNS)) if t and not upright else 0)
        for i, (x, y) in enumerate(((half_width - cell * 3 // 10, half_length - cell * 6 // 10), (half_width + margin, half_length + margin))):
            table[b + 2 + 2 * i] = far if upright else int(x / c)
            table[b + 3 + 2 * i] = int(y / s) if t else far
        table[b + 6] = int((half_length + margin) * c + (half_width + margin) * s)
    table[84] = half_length + half_width
    return table


def steps(length, cell):
    """Cost of a step to each of 8 neighbours for each orientation, then of a turn by one orientation; sixteenths of a cell."""
    table = array("H", [0] * (8 * _TURNS + 1))
    for t in range(_TURNS):
        s = sin(t * pi / _TURNS)
        c = cos(t * pi / _TURNS)
        for d, (x, y) in enumerate(_WAYS):
            r = (x * x + y * y) ** 0.5
            across = (x * c - y * s) / r
            # sideways costs half as much again: it is slow to set up
            table[t * 8 + d] = round(16 * r * (1 + 0.5 * across * across))
    # a step of turning moves the ends of the body by length / 2 * pi / 12; somewhat more than half of that
    table[8 * _TURNS] = round(16 * (length / 2 * pi / _TURNS) * 8 * 0.6 / cell)
    return table
