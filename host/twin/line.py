"""A serial line: when each byte that was sent has arrived."""

from collections import deque
from math import ceil

BYTES_PER_SECOND = 23040  # 230400 baud, ten bits a byte


class Line:
    """Bytes on their way, in order.

    One batch follows another no sooner than the line is free.
    """

    def __init__(self):
        self._batches = deque()
        self._free = 0.0

    def send(self, time, data):
        """Put bytes on the line at the time, us, or when it is free."""
        begin = max(time, self._free)
        self._free = begin + len(data) * 1e6 / BYTES_PER_SECOND
        self._batches.append((ceil(begin + 1e6 / BYTES_PER_SECOND), data))

    def first_arrival(self):
        """Time at which the first byte under way arrives, us; None when nothing is under way."""
        return self._batches[0][0] if self._batches else None

    def take(self, time, batches, room):
        """Up to so many batches of which a byte arrives by the time, with at most `room` bytes: [(time of the first byte, bytes)]."""
        out = []
        while self._batches and self._batches[0][0] <= time and len(out) < batches:
            if len(self._batches[0][1]) > room:
                break
            room -= len(self._batches[0][1])
            out.append(self._batches.popleft())
        return out
