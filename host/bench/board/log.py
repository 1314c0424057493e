"""What was measured, as rows of four: kind, value, extra, simulated time (us). Made once, so that noting takes no heap."""

from array import array

import lockstep

POLL, PLACE, GUARD, WORK, UPDATE, COMMAND, POINTS, PAPER, PLAIN, FEED, TURN, STOP, START, PAPER_FULL = range(1, 15)
KINDS = 15
_ROWS = 300000

rows = array("i", bytes(16 * _ROWS))
count = 0


def write(kind, value, extra):
    """Add a row."""
    global count
    at = 4 * count
    rows[at] = kind
    rows[at + 1] = value
    rows[at + 2] = extra
    rows[at + 3] = lockstep.now
    count += 1


def save(path, more=()):
    """Write the rows into a file, and after them the arrays in `more`."""
    with open(path, "wb") as file:
        file.write(memoryview(rows)[: 4 * count])
        for one in more:
            file.write(one)
