"""What steps on the grid of cost_to_go.py cost, for a body whose wheels all steer. Computed to make the tables."""

from array import array
from math import cos, pi, sin

from micropython import const

_TURNS = const(12)
_INWARD = const(480)  # 30 cells: more than twice what turning round on the spot costs
_WAYS = ((-1, 1), (0, 1), (1, 1), (-1, 0), (1, 0), (-1, -1), (0, -1), (1, -1))


def steps(length, cell):
    """array('H'): for each of 12 orientations ten steps of two words, x + 8 << 4 | y + 8 (cells) and cost (sixteenths of a cell).

    The first 8 lead to the places round about, one to the next orientation, one to the one before.
    """
    # a step of turning moves the ends of the body by length / 2 * pi / 12; somewhat more than half of that
    turn = 0x88, round(16 * (length / 2 * pi / _TURNS) * 8 * 0.6 / cell)
    table = array("H")
    for t in range(_TURNS):
        s = sin(t * pi / _TURNS)
        c = cos(t * pi / _TURNS)
        for x, y in _WAYS:
            r = (x * x + y * y) ** 0.5
            across = (x * c - y * s) / r
            # sideways costs half as much again: it is slow to set up
            table.append(x + 8 << 4 | y + 8)
            table.append(round(16 * r * (1 + 0.5 * across * across)))
        table.extend(array("H", turn + turn))
    return table


def rim(all_wheels):
    """array('H') of 24: what leaving past the far rim (y greatest) costs more for the nose's heading, sixteenths of a cell.

    Nothing with the nose on the way out, most with the rear ahead; nothing at all where the last axle stays straight: there the ways cost that.
    """
    return array("H", [max(0, round(-_INWARD * cos(h * pi / _TURNS))) if all_wheels else 0 for h in range(2 * _TURNS)])
