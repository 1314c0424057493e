"""Counts what each method that the twin charges for executes, and what the charge assumes; see host/twin/board/charge.py.

A row of i32: number of the method, instructions of its own, its two counts of work, number of the charged method that the loop had called, time
that passed in it on the board's clock, us (of which there is only what the I2C bus takes).
"""

from array import array

import charge
import lockstep
from sums import clear_counters, sum_counters

_ROWS = 2048
_DEPTH = 24


class Meter:
    """Takes the place of the charge. costs: file of what each counted block costs, i32 each."""

    def __init__(self, path, costs):
        from counters import COUNTERS

        with open(costs, "rb") as file:
            self._costs = array("i", file.read())
        self._counters = COUNTERS
        self._size = len(self._costs)
        self._file = open(path, "wb")
        self._rows = array("i", bytes(24 * _ROWS))
        self._used = 0
        self._own = [0] * _DEPTH
        self._pending = [[] for _ in range(_DEPTH)]
        self._began = [0] * _DEPTH
        self._depth = 0
        self._left = 0  # the method that ended last
        self._frozen = False
        charge.enter, charge.resume, charge.done, charge.leave = self.enter, self.resume, self.done, self.leave

    def enter(self):
        """What has been counted belongs to the method round this one; outside of all it goes to the next one."""
        counted = self._count()
        self._own[self._depth] += counted
        carried = 0
        if self._depth == 0:
            carried, self._own[0] = self._own[0], 0
        elif self._depth == _DEPTH - 1:
            print("a charged method has raised an exception again and again, which the robot's loop has survived, soon after", charge.names[self._left])
            raise SystemExit(1)
        self._depth += 1
        self._own[self._depth] = carried
        self._began[self._depth] = lockstep.now

    def resume(self):
        """Nobody's."""
        clear_counters(self._counters, self._size)

    def done(self):
        """What comes until leave() is nobody's."""
        self._own[self._depth] += self._count()
        self._frozen = True

    def leave(self, number, a, b):
        """A row for this call; those of the calls inside it that wait to hear in which stage they were get their answer."""
        self._left = number
        if not self._frozen:
            self._own[self._depth] += self._count()
        self._frozen = False
        waiting = self._pending[self._depth]
        waiting.append((number, self._own[self._depth], a, b, lockstep.now - self._began[self._depth]))
        self._depth -= 1
        if self._depth > 1:
            self._pending[self._depth].extend(waiting)
        else:
            for row in waiting:
                self._write(row, number)
        waiting.clear()
        clear_counters(self._counters, self._size)

    def close(self):
        """All rows are in the file."""
        self._file.write(memoryview(self._rows)[: 6 * self._used])
        self._file.close()

    def _count(self):
        counted = sum_counters(self._counters, self._costs, self._size)
        clear_counters(self._counters, self._size)
        return counted

    def _write(self, row, stage):
        at = 6 * self._used
        rows = self._rows
        rows[at], rows[at + 1], rows[at + 2], rows[at + 3], rows[at + 5] = row
        rows[at + 4] = stage
        self._used += 1
        if self._used == _ROWS:
            self._file.write(rows)
            self._used = 0
