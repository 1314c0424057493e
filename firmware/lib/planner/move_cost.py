"""What a move costs: its length, the cost to go from where it ends, and something for steering, for changing the steering, for a way that closes
soon and for passing narrowly.

A move is a candidate in one of four mirrorings (bit 0 left, bit 1 backward), driven as far as one of its LENGTHS: move 5 k + i of the mirroring.

Points only ever make a move worse. So its cost as if there were none is a lower bound; checked best first, the best is known for sure when it comes
first with all points counted, and most candidates are never checked.
"""

import micropython
from micropython import const

from core.trig import cos14, sin14
from planner.candidates import LENGTHS
from planner.cost_to_go import sample

NOTHING = const(65535)
_FREE = const(65535)  # where there are no points
_SLICE = const(2300)  # candidate tests in one slice
_OVERHEAD = const(76)  # what is done once for a candidate, its five ends above all, in tests
_BOUNDS = const(40)  # lower bounds in one slice
_BEST_FIRST = const(190)  # ... to find and to check the one with the least lower bound
_TO_GOAL = const(8)
NEAR = const(4)  # tests that a point at the outline takes more than another one: it is followed exactly
_UNITS = const(100 * 1200)  # weights are in percent, over 120 degrees

# Fields of CostToGo.grid, see cost_grid.py
_GRID_X = const(0)
_GRID_Y = const(1)
_GRID_CELL = const(2)

# Fields of the job. Nothing in it is negative: words have no sign in viper where pointers are longer than they.
_X = const(0)  # the body in the grid, 1/8 mm, + 2**15
_Y = const(1)
_SINE = const(2)  # of its heading, * 2**14, + 2**14
_COSINE = const(3)
_HEADING = const(4)  # 0.1 deg, 3600 to 7199
_CELL = const(5)
_MIRRORING = const(6)
_FIRST = const(7)  # candidates first, first + stride, ... before last
_LAST = const(8)
_STRIDE = const(9)
_AF = const(10)  # the steering now, 0.1 deg, + 1800
_AR = const(11)
_STEERING = const(12)  # weights, 1/1024 mm per 0.1 deg
_CHANGE = const(13)
_EXTRA = const(14)  # mm on all
_BOUND = const(15)  # 1: as if there were no points
_WAY = const(16)  # mm that are to be free, and not narrow


def in_a_slice(n):
    """How many candidates are checked in one slice, but for one. n: points, those at the outline counted NEAR times more."""
    return _SLICE // (n + _OVERHEAD)


@micropython.viper
def _score(job: ptr32, lengths: ptr16, free: ptr16, soft: ptr16, score: ptr16, checked: ptr8, poses, cost, ends: ptr16, turns: ptr16, af: ptr16, ar: ptr16):
    """What each travel of each candidate costs: score[5 k + i] = travel + cost to go of the pose where it ends + cost of the steering, mm.

    For each candidate: what its points cost; the poses where its travels end, in the grid; what the cost to go is there; then the sums. 65535 where the travel is
    longer than the candidate's free length; with job[_BOUND] that becomes 65535 first, and the candidate one not checked yet. poses: room for 5, as for sample()
    """
    pose = ptr32(poses)
    x0 = job[_X] + 32768
    y0 = job[_Y] + 32768
    s = job[_SINE] - 16384
    c = job[_COSINE] - 16384
    heading = job[_HEADING]
    mirroring = job[_MIRRORING]
    k = job[_FIRST]
    last = job[_LAST]
    while k < last:
        more = job[_EXTRA]
        if job[_BOUND]:
            free[k] = _FREE
            checked[k] = 0
        f = free[k]
        if f < _FREE:
            # A way that closes soon, or is passed narrowly, is expensive whatever part of it is driven: the rest comes next.
            x = job[_WAY]
            y = soft[k]
            if f < x:
                more += (x - f) >> 1
            if y < x:
                more += (x - y) >> 2
        n = 0
        p = 0
        at = k * 5
        while n < 5 and lengths[n] <= f:
            x = ends[2 * at] - 8192
            y = ends[2 * at + 1] - 8192
            turn = lengths[n] * turns[k] + 8192 >> 14
            if mirroring & 1:
                x = 0 - x
                turn = 0 - turn
            if mirroring & 2:
                y = 0 - y
                turn = 0 - turn
            pose[p] = x0 + ((x * c + y * s + 1024) >> 11)
            pose[p + 1] = y0 + ((y * c - x * s + 1024) >> 11)
            pose[p + 2] = heading + turn
            n += 1
            p += 3
            at += 1
        sample(job[_CELL], poses, n, cost)
        # Driven backward the other end leads: front and rear change places, and what was right is left.
        x = (af[k] ^ 0x8000) - 0x8000
        y = (ar[k] ^ 0x8000) - 0x8000
        if mirroring & 2:
            at = x
            x = y
            y = at
        if mirroring == 1 or mirroring == 2:
            x = 0 - x
            y = 0 - y
        at = x
        if x < 0:
            at = 0 - x
        if y < 0:
            at -= y
        else:
            at += y
        x += 1800 - job[_AF]
        if x < 0:
            x = 0 - x
        y += 1800 - job[_AR]
        if y < 0:
            y = 0 - y
        more += (at * job[_STEERING] + (x + y) * job[_CHANGE]) >> 10
        at = k * 5
        p = 0
        while p < 5:
            score[at + p] = 65535
            if p < n:
                score[at + p] = lengths[p] + pose[p * 3] + more
            p += 1
        k += job[_STRIDE]


@micropython.viper
def best(score: ptr16, first: int, last: int, stride: int) -> int:
    """Number of the move with the lowest score, of candidates first, first + stride, ... before last; NOTHING if none is possible."""
    best = 65534
    pick = 65535
    while first < last:
        at = first * 5
        end = at + 5
        while at < end:
            v = score[at]
            if v < best:
                best = v
                pick = at
            at += 1
        first += stride
    return pick


@micropython.viper
def suppress(last: int, at: int, ends: ptr16, turns: ptr16, lengths: ptr16, score: ptr16, radius: int, reach: int):
    """Take out the travels that end within radius of where travel `at` ends, of the first `last`; a turn counts as the way of the body's ends."""
    x0 = ends[at * 2]
    y0 = ends[at * 2 + 1]
    turn = turns[at // 5] * lengths[at % 5]
    while last > 0:
        last -= 1
        d = ends[last * 2] - x0
        if d < 0:
            d = 0 - d
        e = ends[last * 2 + 1] - y0
        if e < 0:
            e = 0 - e
        d += e
        e = turns[last // 5] * lengths[last % 5] - turn
        if e < 0:
            e = 0 - e
        if d + ((e >> 14) * reach >> 9) < radius:
            score[last] = 65535


class MoveCost:
    """Scores moves from one pose: the body's when the decision began, or the end of a first move.

    x, y, heading: the body's when the decision began, 1/8 mm and 0.1 deg.
    checked: bytearray, 0 for the candidates of which only the lower bound is known.
    scores: words of 5 for each candidate, mm, lower is better, NOTHING where the way is not free as far.
    bar: limits.Barred where wheels' limits forbid some candidates, or None
    """

    def __init__(self, cost_to_go, candidates):
        from planner.parts import move_cost

        move_cost(self, cost_to_go, candidates)

    def configure(self, config):
        """Take over weights that may have been tuned."""
        self.bar = None  # limits may be wider now; where they are not, the drive says so
        look_ahead = self._candidates.look_ahead
        job = self._job
        job[_WAY] = look_ahead * 3 // 7
        # With a goal a way that leads there crookedly is the better one: what steering costs then only decides between equals.
        look_ahead = look_ahead * 1024 // (_TO_GOAL if self.cost_to_go.goal is not None else 1)
        job[_STEERING] = config.avoid_steering_weight * look_ahead // _UNITS
        job[_CHANGE] = config.avoid_change_weight * look_ahead // _UNITS

    def stand(self, odometry):
        """Score from where the body is now. Returns its cost to go, mm."""
        self.x = odometry.x >> 5
        self.y = odometry.y >> 5
        self.heading = (odometry.heading + 50) // 100
        return self.stand_at(0, 0, 0)

    def stand_at(self, x, y, heading):
        """Score from a pose x, y (mm) and heading (0.1 deg) as seen from where stand() was called. Returns its cost to go, mm."""
        grid = self.cost_to_go.grid
        job = self._job
        a = self.heading
        s = sin14(a)
        c = cos14(a)
        x, y = self.x + ((x * c + y * s + 1024) >> 11), self.y + ((y * c - x * s + 1024) >> 11)
        a += heading
        job[_X] = (x - grid[_GRID_X]) & 0xFFFF ^ 0x8000
        job[_Y] = (y - grid[_GRID_Y]) & 0xFFFF ^ 0x8000
        job[_SINE] = sin14(a) + 16384
        job[_COSINE] = cos14(a) + 16384
        job[_CELL] = grid[_GRID_CELL]
        job[_HEADING] = 3600 + a % 3600
        return self.cost_to_go.at(x, y, a)

    def _prepare(self, mirroring, first, last, stride, af, ar, extra, bound):
        job = self._job
        job[_MIRRORING] = mirroring
        job[_FIRST] = first
        job[_LAST] = last
        job[_STRIDE] = stride
        job[_AF] = af + 1800
        job[_AR] = ar + 1800
        job[_EXTRA] = extra
        job[_BOUND] = bound

    def _run(self, free, soft, scores):
        env = self._candidates
        _score(self._job, env.lengths, free, soft, scores, self.checked, self._poses, self.cost_to_go.cost, env.ends, env.turns, env.af, env.ar)
        if self.bar is not None:
            self.bar(self._job, free, scores)

    def score(self, mirroring, free, soft, scores, first, last, stride, af, ar, extra):
        """Fill the scores of candidates first, first + stride, ... before last in a mirroring.

        free, soft: their free lengths (collision.py). af, ar: the steering now, 0.1 deg. extra: mm on all.
        """
        self._prepare(mirroring, first, last, stride, af, ar, extra, 0)
        self._run(free, soft, scores)

    def lower_bound(self, mirroring, free, scores, first, af, ar):
        """Lower bounds: as score(), as if there were no points, from candidate `first` on, as many as a slice allows. Returns the next one.

        free becomes 65535, of these only: candidates for driving backward must not seem free ahead.
        """
        env = self._candidates
        end = env.ahead_end
        if mirroring & 2:
            first = max(first, env.astern_first)
            end = env.arcs
        if end <= first < env.arcs:
            first = env.arcs
        last = min(first + _BOUNDS, end if first < end else env.count)
        self._prepare(mirroring, first, last, 1, af, ar, 0, 1)
        self._run(free, free, scores)
        return last

    def best_first(self, ways, free, scores, most):
        """Check the candidates best first, the points of `ways` being mirrored, until the best of all is known: no score gets better by it.

        Returns the number of the best move, NOTHING if none costs `most` or less, -1 if it takes another slice.
        """
        job = self._job
        job[_BOUND] = 0
        checked = self.checked
        env = self._candidates
        n = ways.drop_behind()
        ways.collision.prepare(n, ways.near, 1, env.lengths[0])
        for _ in range(_SLICE // (n + NEAR * ways.near + _BEST_FIRST) + 1):
            number = best(scores, 0, env.count, 1)
            if number == NOTHING or scores[number] > most:
                return NOTHING
            k = number // LENGTHS
            if checked[k]:
                return number
            ways.collision.check(ways.x, ways.y, k, k + 1, free, ways.soft, ways.block)
            checked[k] = 1
            job[_FIRST] = k
            job[_LAST] = k + 1
            self._run(free, ways.soft, scores)
        return -1
