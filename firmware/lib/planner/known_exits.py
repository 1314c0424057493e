"""What leaving by a place on the rim costs where the ground beyond it is known: so a place found closed is remembered as closed.

The grid of the cost to go ends a body length and a bit from the robot, and what lies beyond its rim is taken for free: a robot that has backed out of a
blind alley would take it for open again as soon as its end has left the grid. So a place that comes onto the rim of a new grid, and lay within the
one before, costs at least what that one said: from there the way out led through all that it had seen. It is also kept by floor cells, 32 x 32 of a
quarter of a metre for a body of 600 mm, for when the robot comes back. A cell is forgotten when the robot is 16 of them away; what lies within a grid is judged
afresh by what is seen there now, so what has opened is open. (Learning real-time A*: R. E. Korf, Real-time heuristic search, Artificial Intelligence 42, 1990.)
"""

from micropython import const

_N = const(26)
_SIDE = const(25)
_PLACES = const(676)
_STATES = const(8112)
_MOST = const(254)
# Fields of CostToGo.grid, see cost_grid.py
_X = const(0)
_Y = const(1)
_CELL = const(2)
_SIZE = const(5)


def recall(side, grid, old_x, old_y, cost, known, exits):
    """What leaving costs at least on one side of the rim (0 low y, 1 high y, 2 low x, 3 high x), into exits[0], [26], [52] or [77] and on; 0 where nothing is known.

    grid: of the new one; cost: of the one before, whose corner was old_x, old_y; known: two floor cells a byte, a sixteenth of the cost each.
    """
    cell = grid[_CELL]
    size = grid[_SIZE]
    last = -1
    for k in range(_N):
        x = (k if side < 2 else _SIDE * (side & 1)) * cell + (cell >> 1)
        y = (_SIDE * (side & 1) if side < 2 else k) * cell + (cell >> 1)
        at = (grid[_Y] + y >> size & 31) << 5 | (grid[_X] + x >> size & 31)
        x = ((grid[_X] + x - old_x & 0xFFFF ^ 0x8000) - 0x8000) // cell
        y = ((grid[_Y] + y - old_y & 0xFFFF ^ 0x8000) - 0x8000) // cell
        both = known[at >> 1]
        shift = (at & 1) << 2
        if 0 < x < _SIDE and 0 < y < _SIDE:
            place = y * _N + x
            x = _MOST
            while place < _STATES:
                if cost[place] < x:
                    x = cost[place]
                place += _PLACES
            # Of several places in a cell the cheapest counts.
            if at != last or x >> 4 < both >> shift & 15:
                last = at
                known[at >> 1] = both & (240 >> shift) | x >> 4 << shift
        else:
            x = (both >> shift & 15) << 4
        exits[_N * side + k - side // 3] = x


def forget_far(known, x, y, size):
    """Forget the cells half a round away from x, y (1/8 mm): what comes there next is another place."""
    row = (y >> size) + 16 & 31
    column = (x >> size) + 16 & 31
    for k in range(16):
        known[row << 4 | k] = 0
    keep = 240 >> ((column & 1) << 2)
    for k in range(column >> 1, 512, 16):
        known[k] &= keep
