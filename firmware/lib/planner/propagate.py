"""Propagating the cost to go from the rim of the grid inwards, along the motion primitives.

    cost     a byte a pose, (orientation * 26 + y) * 26 + x: 0..216 units of the cost to go, from there on 217..253 fours of units, 254 that or more,
             255 closed or not reached
    masks    a 32-bit word a row (orientation * 26 + y), a bit a column: closed, near, and fallen

A pose whose cost fell is marked in `fallen`. The rows are gone through again and again; each marked pose within a limit is unmarked, and offers its cost plus
that of a step to each pose that leads to it, which is marked if that is less than what it has. When no marked pose is within the limit any more, the limit rises a little
above the least of them. So costs near the exits settle first and few poses are gone through twice; which comes first does not change the result. (A label-correcting
search: D. P. Bertsekas, Dynamic Programming and Optimal Control, vol. 1, section 2.3.) A pose that costs 254 or more still has a way out.
"""

import micropython
from micropython import const

_N = const(26)
_TURNS = const(12)
_ROWS = const(312)
_MOST = const(254)
_KNEE = const(216)  # above, units are four times as large: so far out it is known roughly what leaving costs
_BAND = const(64)  # by which the limit rises above the least cost: 4 cells, sixteenths of a cell
_ROW_WORK = const(1)  # what it costs of the budget to look through a row with marks, to propagate from a pose, to go through all rows
_POSE_WORK = const(4)
_PASS_WORK = const(20)

# Fields of the job.
_LIMIT = const(0)
_ROW = const(1)  # to go on with
_AGAIN = const(2)  # whether a pose within the limit was marked in this pass
_LEAST = const(3)  # cost beyond the limit
_SENSE = const(4)  # a bit for each orientation whose primitives are those of the opposite heading
_SHIFT = const(5)  # log2 of sixteenths of a cell in a unit of cost
_STRIDE = const(6)  # words of the primitives for each heading: two each, x + 8 << 4 | y + 8 and the cost in sixteenths of a cell
_KEEP = const(7)  # words of those that keep the heading; half of the others lead to the next one, half to the one before
_NEAR = const(8)  # by how much a near collision multiplies the cost of a step
_TURN_WEIGHED = const(9)  # whether revisiting makes turning expensive as well
FIELDS = const(10)


@micropython.viper
def propagate(job: ptr32, fallen: ptr32, budget: int, cost: ptr8, closed: ptr32, near: ptr32, revisit: ptr8, primitives: ptr16) -> int:
    """Go on for about `budget` units of work; returns 1 when nothing is left to do. Sets of primitives: primitives.py, primitives_naws.py."""
    limit = job[_LIMIT]
    row = job[_ROW]
    again = job[_AGAIN]
    least = job[_LEAST]
    shift = job[_SHIFT]
    half = 1 << shift >> 1
    keep = job[_KEEP]
    turning = (job[_STRIDE] - keep) >> 1
    while budget > 0:
        marks = fallen[row]
        if marks:
            budget -= _ROW_WORK
            t = row // _N
            y = row - t * _N - 8
            first = t
            if (job[_SENSE] >> t) & 1:
                first += _TURNS
            first = first * job[_STRIDE]
            x = 0
            while marks:
                if marks & 15 == 0:
                    marks = marks >> 4
                    x += 4
                    continue
                if marks & 1:
                    here = cost[row * _N + x]
                    if here > limit:
                        if here < least:
                            least = here
                    else:
                        budget -= _POSE_WORK
                        fallen[row] = fallen[row] ^ (1 << x)
                        w = revisit[(y + 8) * _N + x]
                        p = first
                        last = p + keep
                        turn = 0
                        while turn < 3:
                            to_t = t
                            if turn:
                                # the next orientation, then the one before
                                to_t += 3 - turn - turn
                                if to_t == _TURNS:
                                    to_t = 0
                                if to_t < 0:
                                    to_t = _TURNS - 1
                                last += turning
                                if job[_TURN_WEIGHED] == 0:
                                    w = 2
                            to_t = to_t * _N
                            while p < last:
                                c = primitives[p]
                                i = x - 8 + (c >> 4)
                                j = y + (c & 15)
                                if (i | j | (_N - 1 - i) | (_N - 1 - j)) >= 0:
                                    j += to_t
                                    to = j * _N + i
                                    old = cost[to]
                                    # Most are cheaper already, and need no looking up.
                                    if old > here and (closed[j] >> i) & 1 == 0:
                                        c = primitives[p + 1] * w >> 1
                                        if (near[j] >> i) & 1:
                                            c = c * job[_NEAR]
                                        if here < _KNEE:
                                            c = ((c + half) >> shift) + here
                                            if c > _KNEE:
                                                c = _KNEE + ((c - _KNEE) >> 2)
                                        else:
                                            c = ((c + 4 * half) >> (shift + 2)) + here
                                        if c > _MOST:
                                            c = _MOST
                                        if c < old:
                                            cost[to] = c
                                            fallen[j] = fallen[j] | (1 << i)
                                            if c <= limit:
                                                again = 1
                                            elif c < least:
                                                least = c
                                p += 2
                            turn += 1
                        marks = fallen[row] >> x
                marks = marks >> 1
                x += 1
        row += 1
        if row == _ROWS:
            row = 0
            budget -= _PASS_WORK
            if again == 0:
                if least > _MOST:
                    return 1
                limit = least + (_BAND >> shift)
            again = 0
            least = _MOST + 1
    job[_LIMIT] = limit
    job[_ROW] = row
    job[_AGAIN] = again
    job[_LEAST] = least
    return 0
