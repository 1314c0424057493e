"""propagate.py against a plain search (Dijkstra's), for both sets of motion primitives."""

from array import array

from params.config import Config
from planner import tables
from planner.propagate import propagate

_N = 26
_TURNS = 12


class _Case:
    """Exits, closed poses, near collisions and visited places by chance, of the same numbers on each interpreter."""

    def __init__(self, mode, seed, shift):
        self.primitives = tables.load(Config({"mode": mode}), 1)[1]
        self.aws = mode == "AWS"
        self.shift = shift
        self._seed = seed
        rows = _N * _TURNS
        self.closed = array("i", [self._chance() & self._chance() for _ in range(rows)])
        self.near = array("i", [self._chance() | self.closed[row] for row in range(rows)])
        self.revisit = bytearray([2 + (self._draw() % 39 if self._draw() % 4 == 0 else 0) for _ in range(_N * _N)])
        self.sense = 0 if self.aws else self._draw() & 0xFFF
        self.exits = {}
        for _ in range(40):
            pose = self._draw() % (rows * _N)
            if not self.closed[pose // _N] >> pose % _N & 1:
                self.exits[pose] = self._draw() % 60

    def _draw(self):
        self._seed = (self._seed * 1103515245 + 12345) & 0x7FFFFFFF
        return self._seed >> 8

    def _chance(self):
        return self._draw() & 0xFFFFFFF & (self._draw() << 5)

    def kernel(self, budget):
        cost = bytearray(b"\xff" * (_N * _N * _TURNS))
        marks = array("i", bytes(4 * _N * _TURNS))
        for pose, c in self.exits.items():
            cost[pose] = c
            marks[pose // _N] |= 1 << pose % _N
        turning = (20, 16, 4, 0) if self.aws else (24, 16, 6, 1)
        job = array("i", (0, 0, 0, 255, self.sense, self.shift) + turning)
        while not propagate(job, marks, budget, cost, self.closed, self.near, self.revisit, self.primitives):
            pass
        assert not any(marks)
        return cost

    def plain(self):
        cost = [255] * (_N * _N * _TURNS)
        levels = [[] for _ in range(256)]
        for pose, c in self.exits.items():
            cost[pose] = c
            levels[c].append(pose)
        for level in range(255):
            for pose in levels[level]:
                if cost[pose] == level:
                    for to, step in self._steps(pose):
                        c = min(self._sum(level, step), 254)
                        if c < cost[to]:
                            cost[to] = c
                            levels[c].append(to)
        return bytearray(cost)

    def _steps(self, pose):
        """(pose, cost) of what leads to a pose."""
        t, y, x = pose // (_N * _N), pose // _N % _N, pose % _N
        heading = t + (12 if self.sense >> t & 1 else 0)
        ways = 10 if self.aws else 12
        for k in range(ways):
            at = 2 * (heading * ways + k)
            turn = 0 if k < 8 else 1 if k < (ways + 8) // 2 else -1
            i = x + (self.primitives[at] >> 4) - 8
            j = y + (self.primitives[at] & 15) - 8
            row = (t + turn) % _TURNS * _N + j
            if 0 <= i < _N and 0 <= j < _N and not self.closed[row] >> i & 1:
                c = self.primitives[at + 1] * (2 if self.aws and turn else self.revisit[y * _N + x]) >> 1
                if self.near[row] >> i & 1:
                    c *= 4 if self.aws else 6
                yield row * _N + i, c

    def _sum(self, here, step):
        """A cost and that of a step, sixteenths of a cell: above 216 units are four times as large."""
        unit = 1 << self.shift
        if here >= 216:
            return here + (step + 2 * unit) // (4 * unit)
        c = here + (step + unit // 2) // unit
        return c if c <= 216 else 216 + (c - 216) // 4


def test_costs_are_those_of_a_plain_search():
    for mode in ("AWS", "NAWS"):
        for shift in (2, 4):
            case = _Case(mode, 7 + shift, shift)
            found = case.kernel(400)
            assert found == case.plain(), (mode, shift)
            # Few poses are out of range, or the comparison would say little.
            assert sum(1 for c in found if 0 < c < 254) > 1500, (mode, shift, found.count(255), found.count(254))


def test_slices_do_not_change_the_costs():
    case = _Case("AWS", 3, 2)
    assert case.kernel(1) == case.kernel(100000)
