"""Spreading the costs of field.py for a body whose wheels all steer: to the eight places round about, and round on the spot.

A robot whose last axle stays straight has field_spread_naws.py instead.
"""

import micropython
from micropython import const

from planner.queue import raise_limit

_QUEUE = const(1536)  # as in field_queue.py


@micropython.viper
def spread(costs, rows: ptr32, tight: ptr32, weight: ptr8, queued, steps: ptr16, state: ptr32, budget: int) -> int:
    """Go on spreading for at most `budget` poses; returns 1 when the queue is empty. Bit 15 of a cost: the pose is queued."""
    cost = ptr16(costs)
    queue = ptr16(queued)
    head = state[0]
    tail = state[1]
    limit = state[2]
    done = 0
    turn_cost = steps[96]
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
            i = at - row * 30 - 1
            t = row // 30
            w = weight[at - t * 900]
            step = t * 8
            # Neighbours row by row; the costs of opposite ways are the same, so they serve in either order.
            to = at - 31
            row -= 1
            r = 0
            while r < 3:
                m = (rows[row] >> i) & 7
                if r == 1:
                    m = m | 2
                if m != 7:
                    dear = (tight[row] >> i) & 7
                    d = 0
                    while d < 3:
                        if m & 1 == 0:
                            c = steps[step] * w >> 1
                            if dear & 1:
                                c = c << 2
                            c += here
                            old = cost[to]
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
                        if r != 1 or d != 1:
                            step += 1
                        m = m >> 1
                        dear = dear >> 1
                        to += 1
                        d += 1
                    to += 27
                else:
                    to += 30
                    step += 3
                    if r == 1:
                        step -= 1
                row += 1
                r += 1
            # The two next orientations.
            i += 1
            r = 0
            while r < 2:
                to = at + 900
                row = row - 2 + 30
                if r:
                    to = at - 900
                    row = at // 30 - 30
                if to >= 10800:
                    to -= 10800
                    row -= 360
                elif to < 0:
                    to += 10800
                    row += 360
                if (rows[row] >> i) & 1 == 0:
                    c = turn_cost
                    if (tight[row] >> i) & 1:
                        c = c << 2
                    c += here
                    old = cost[to]
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
                r += 1
            budget -= 1
    state[0] = head
    state[1] = tail
    state[2] = limit
    return done
