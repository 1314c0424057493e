"""A serial line: when each byte that was sent has arrived."""

from collections import deque
from math import ceil

BITS = 10  # of a byte on the wire


class Line:
    """Bytes on their way, in order.

    baud: bits a second. One batch follows another no sooner than the line is free.
    """

    def __init__(self, baud):
        self._byte_us = BITS * 1e6 / baud
        self._batches: deque[tuple[int, bytes]] = deque()
        self._free = 0.0

    def send(self, time, data):
        """Put bytes on the line at the time, us, or when it is free."""
        begin = max(time, self._free)
        self._free = begin + len(data) * self._byte_us
        self._batches.append((ceil(begin + self._byte_us), data))

    def first_arrival(self):
        """Time at which the first byte under way arrives, us; None when nothing is under way."""
        return self._batches[0][0] if self._batches else None

    def take(self, time, batches, room):
        """Up to so many batches of which a byte arrives by the time, with at most `room` bytes: [(time of the first byte, bytes)]."""
        out: list[tuple[int, bytes]] = []
        while self._batches and self._batches[0][0] <= time and len(out) < batches:
            if len(self._batches[0][1]) > room:
                break
            room -= len(self._batches[0][1])
            out.append(self._batches.popleft())
        return out
