"""The queue of the search of field.py: a ring of the poses whose cost fell. Those within a limit are spread from first."""

import micropython
from micropython import const

LENGTH = const(1536)  # more than the poses of the rim, of which it holds most at first
_STEP = const(64)  # 4 cells, in sixteenths


@micropython.viper
def raise_limit(cost: ptr16, queue: ptr16, head: int, tail: int) -> int:
    """A limit a little above the least cost in the queue, and those within it brought to its front."""
    i = head
    limit = 32767
    while i != tail:
        c = cost[queue[i]] & 0x7FFF
        if c < limit:
            limit = c
        i += 1
        if i == LENGTH:
            i = 0
    limit += _STEP
    i = head
    j = tail - 1
    if j < 0:
        j = LENGTH - 1
    while i != j:
        at = queue[i]
        if (cost[at] & 0x7FFF) <= limit:
            i += 1
            if i == LENGTH:
                i = 0
        else:
            queue[i] = queue[j]
            queue[j] = at
            j -= 1
            if j < 0:
                j = LENGTH - 1
    return limit
