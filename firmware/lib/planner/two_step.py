"""Two moves at a time, where no single one gets on: the best first moves, each followed by a second from where it ends.

Whether a long body gets round a corner depends on where its turn begins, to the centimetre: so more lengths are tried of the best pair's first move.
"""

from micropython import const

from core.trig import cos14, sin14
from perception.local_map import view
from planner.candidates import LENGTHS
from planner.collision import drop_behind, mirror
from planner.move_cost import NEAR, NOTHING, best, in_a_slice, suppress

_COARSE = const(6)  # first moves
MOST = const(12)  # with more lengths of the best one
_SLACK = const(60)  # mm by which a second move may end better than the cost to go at its beginning says
_BODY_ZERO = const(8192)  # added to coordinates of the body frame
_TO_A_SIDE = const(60)  # mm that a second move costs for being one


class TwoStep:
    """begin(), then choose_first() until True, then try_second() until True. Laid out by planner/build.py.

    count                     first moves found, best first: mirroring[0], candidate[0], length[0] (mm) is the best single one
    found                     whether a pair was
    mirroring, candidate, length    bytearrays and array 'H'; those of the pair's first move at `chosen`
    alone, alone_at           cost and number of the best of the first moves that gets on without a second one, NOTHING if there is none
    second_mirroring, second_candidate, second_length    its second move, mm

    scores: by mirroring, of the first moves. While second moves are tried the scores of the first ones are not needed any more: those of one mirroring are the second moves', two hold the
    points as seen from the end of a first move, and the last one the free lengths.
    """

    def begin(self, here):
        """here: the cost to go where the robot is. A move that ends where it costs no less is of use as the first of two only."""
        self._here = here
        self.count = 0
        self._coarse = 0  # first moves of choose_first(), before their finer lengths
        self._at = 0  # the first move that is being followed by second ones
        self._left = 0  # 1 while these go left
        self._next = 0  # candidate at which the next slice goes on
        self.least = self.alone = NOTHING
        self.chosen = self.alone_at = 0
        self.found = False

    def choose_first(self):
        """Take the best move of all mirrorings, and out of these all that end like it. True when there are enough, or no more."""
        env = self.candidates
        n = self.count
        least = NOTHING
        mirroring = 0
        number = 0
        for k in (0, 1, 2, 3):
            scores = self.scores[k]
            one = best(scores, 0, env.count, 1)
            if one != NOTHING and scores[one] < least:
                least = scores[one]
                mirroring = k
                number = one
        if least == NOTHING:
            return True
        self.mirroring[n] = mirroring
        self.candidate[n] = number // LENGTHS
        self.length[n] = env.lengths[number % LENGTHS]
        self.costs[n] = least
        if self.alone == NOTHING and least < self._here + self.length[n]:
            self.alone = least
            self.alone_at = n
        suppress(env.count * LENGTHS, number, env.ends, env.turns, env.lengths, self.scores[mirroring], env.look_ahead // 12, env.half_length)
        self.count = self._coarse = n + 1
        return self.count == _COARSE

    def try_second(self):
        """Second moves from where one first move ends, right and left, a slice of candidates at a time. True after the last.

        Every other point and candidate does: the second move is looked at again, with all of them, before it is driven.
        """
        env = self.candidates
        if self._next == 0:
            self._stand_at_end()
        last = self._try_some()
        if last < env.count:
            self._next = last
            return False
        self._next = 0
        at = self._at
        fine = at >= self._coarse
        if not fine and not self._left:
            self._left = 1
            return False
        at += 1
        if not fine and at < self._coarse and self.found and self.costs[at] > self.least + _SLACK:
            self.count = self._coarse = at  # no better pair begins with this one, or with those behind it
        self._at = at
        if at == self._coarse and self.found:
            self._refine()
        # Fine ones to the side of the best pair only.
        self._left = self.second_mirroring if at >= self._coarse else 0
        return at >= self.count

    def _stand_at_end(self):
        """The points as seen from where the first move ends, mirrored for second moves to the left."""
        env = self.candidates
        ways = self.ways
        at = self._at
        x, y = self.scores[1], self.scores[2]
        fine = at >= self._coarse
        if fine or not self._left:
            env.travel(self.mirroring[at], self.candidate[at], self.length[at])
            turn = env.end_turn
            reach = env.lengths[3] + env.half_length
            self.n = view(reach, sin14(turn), cos14(turn), ways.x, ways.y, ways.n, env.end_x + _BODY_ZERO, env.end_y + _BODY_ZERO, x, y, 2, 14)
            self.near = ways.windows.sort_near(x, y, self.n)
            cost = self.move_cost.stand_at(env.end_x, env.end_y, turn)
            if not fine:
                self.costs[at] -= cost  # that of the second move's end takes its place
        if self._left:
            mirror(x, self.n)
        self.ahead = drop_behind(self.n, x, y, self.near, env.half_length + env.soft, ways.swing)

    def _try_some(self):
        """Check and score the next second moves, and keep the best pair. Returns the candidate after them."""
        env = self.candidates
        ways = self.ways
        scores = self.scores[0]
        free = self.scores[3]
        at = self._at
        mirroring = self.mirroring[at]
        candidate = self.candidate[at]
        first = self._next
        if env.ahead_end <= first < env.arcs:
            first = env.arcs
        stride = 2 if first < env.arcs else 1
        last = min(first + stride * (in_a_slice(self.ahead + NEAR * self.near) + 1), env.ahead_end if stride == 2 else env.count)
        ways.collision.prepare(self.ahead, self.near, stride, env.lengths[1])
        ways.collision.check(self.scores[1], self.scores[2], first, last, free, ways.soft, ways.block)
        self.move_cost.score(
            self._left, free, ways.soft, scores, first, last, stride, env.af_of(mirroring, candidate), env.ar_of(mirroring, candidate), _TO_A_SIDE
        )
        number = best(scores, first, last, stride)
        if number != NOTHING and self.costs[at] + scores[number] < self.least:
            self.least = self.costs[at] + scores[number]
            self.found = True
            self.chosen = at
            self.second_mirroring = self._left
            self.second_candidate = number // LENGTHS
            self.second_length = env.lengths[number % LENGTHS]
        return last

    def _refine(self):
        """More lengths of the first move of the best pair."""
        at = self.chosen
        mirroring = self.mirroring[at]
        candidate = self.candidate[at]
        length = self.length[at]
        unit = self.candidates.half_length // 25
        for d in (-3, -2, -1, 1, 2, 3):
            other = length + d * unit
            if 2 * unit < other <= self.ways.free_of[mirroring][candidate]:
                n = self.count
                self.mirroring[n] = mirroring
                self.candidate[n] = candidate
                self.length[n] = other
                self.costs[n] = self.costs[at] + other - length
                self.count = n + 1
