"""Spreading the costs of field.py for a robot whose last axle stays straight: along the body, and round turning circles like a car's.

Such a robot gets to the side or round only by driving on or back, so what a pose costs hangs on which way the nose points: that of an
orientation is taken to be the one nearer to where it points now, and the orientation square to it is closed.
"""

import micropython
from micropython import const

from planner.queue import raise_limit

_QUEUE = const(1536)  # as in field_queue.py


@micropython.viper
def spread(costs, rows: ptr32, tight: ptr32, weight: ptr8, queued, ways: ptr16, state: ptr32, budget: int) -> int:
    """As spread() of field_spread.py. ways: of field_ways.py; state[3]: a bit for each orientation of which the nose points the other way."""
    cost = ptr16(costs)
    queue = ptr16(queued)
    head = state[0]
    tail = state[1]
    limit = state[2]
    done = 0
    sense = state[3]
    while budget > 0:
        if head == tail:
            done = 1
            budget = 0
        else:
            at = queue[head]
            here = cost[at] & 0x7FFF
            if here > limit:
                # All within the limit are done.
                limit = int(raise_limit(costs, queued, head, tail))
                i = tail - head
                if i < 0:
                    i += _QUEUE
                budget -= i >> 3
                at = queue[head]
                here = cost[at] & 0x7FFF
            head += 1
            if head == _QUEUE:
                head = 0
            cost[at] = here
            row = at // 30
            t = row // 30
            x = at - row * 30 - 8
            y = row - t * 30 - 8
            w = weight[at - t * 900]
            e = t + 12 * (sense >> t & 1)
            e *= 36
            # To other places in the same orientation, to the next one, to the one before.
            last = e + 24
            turn = 0
            while turn < 3:
                base = t
                if turn == 1:
                    base += 1
                    if base == 12:
                        base = 0
                elif turn == 2:
                    base -= 1
                    if base < 0:
                        base = 11
                base *= 30
                while e < last:
                    i = x + ways[e]
                    j = y + ways[e + 1]
                    # on the grid: the outermost ring is closed
                    if (i | j | 29 - i | 29 - j) >= 0:
                        row = base + j
                        to = row * 30 + i
                        old = cost[to]
                        # Most are cheaper already, and need no looking up.
                        if (old & 0x7FFF) > here:
                            if (rows[row] >> i) & 1 == 0:
                                c = ways[e + 2] * w >> 1
                                if (tight[row] >> i) & 1:
                                    c = c * 6
                                c += here
                                if c < (old & 0x7FFF):
                                    if old & 0x8000:
                                        cost[to] = c | 0x8000
                                    else:
                                        following = tail + 1
                                        if following == _QUEUE:
                                            following = 0
                                        if following != head:
                                            cost[to] = c | 0x8000
                                            if c <= limit:
                                                head -= 1
                                                if head < 0:
                                                    head = _QUEUE - 1
                                                queue[head] = to
                                            else:
                                                queue[tail] = to
                                                tail = following
                    e += 3
                last += 6
                turn += 1
            budget -= 1
    state[0] = head
    state[1] = tail
    state[2] = limit
    return done
