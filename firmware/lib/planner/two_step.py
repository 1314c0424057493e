"""Two moves at a time, where no single one gets on: the best first moves, each followed by a second from where it ends.

Whether a long body gets round a corner depends on where its turn begins, to the centimetre: so more lengths are tried of the best pair's first move.
"""

from array import array

from micropython import const

from core.trig import cos14, sin14
from planner.candidates import LENGTHS
from planner.collision import BAND_MM, drop_behind, mirror, move, sort_near
from planner.move_cost import NOTHING, best, in_a_slice, suppress

_COARSE = const(6)  # first moves
_FINE = const(6)  # more lengths of the best one
_LEFT_SIDE = const(1000)
_SLACK = const(60)  # mm by which a second move may end better than the field promised at its beginning
_TO_A_SIDE = const(60)  # mm that a second move costs for being one


class TwoStep:
    """soft, block: what a sweep finds, shared with others.

    begin(), then pick() and expand() until each is True.

    count                     first moves found, best first: variant[0], candidate[0], length[0] (mm) is the best single one
    found                     whether a pair was
    variant, candidate, length    bytearrays and array 'H'; those of the pair's first move at `chosen`
    second_variant, second_candidate, second_length    its second move, mm
    """

    def __init__(self, candidates, worth, sweep, soft, block):
        self._envelopes = candidates
        self._worth = worth
        self._sweep = sweep
        self.variant = bytearray(_COARSE + _FINE)
        self.candidate = bytearray(_COARSE + _FINE)
        self.length = array("H", bytes(2 * (_COARSE + _FINE)))
        self._score = array("i", bytes(4 * (_COARSE + _FINE)))
        self._free = array("H", bytes(2 * candidates.count))
        self._soft = soft
        self._block = block
        self._n = self._near = self._left = 0  # points as seen from the end of a first move: all, near ones, those not behind
        self._next = 0
        self.second_variant = self.second_candidate = self.second_length = 0
        self.begin()

    def begin(self):
        self.count = 0
        self._coarse = 0
        self._at = 0
        self._least = NOTHING
        self.chosen = 0
        self.found = False

    def pick(self, scores):
        """Take the best move of all four variants' scores, and out of these all that end like it. True when there are enough, or no more."""
        env = self._envelopes
        n = self.count
        least = NOTHING
        variant = 0
        number = 0
        for v in (0, 1, 2, 3):
            one = best(scores[v], 0, env.count, 1)
            if one != NOTHING and scores[v][one] < least:
                least = scores[v][one]
                variant = v
                number = one
        if least == NOTHING:
            return True
        self.variant[n] = variant
        self.candidate[n] = number // LENGTHS
        self.length[n] = env.lengths[number % LENGTHS]
        self._score[n] = least
        suppress(scores[variant], env.ends, env.turns, env.count, number, env.look_ahead // 12, env.half_length)
        self.count = self._coarse = n + 1
        return self.count == _COARSE

    def expand(self, px, py, n, qx, qy, scores, free_of, limit):
        """Second moves from where one first move ends, right and left, a slice of candidates at a time. True after the last.

        px, py: n points as at the beginning; qx, qy: room for as many; scores: room for those of one variant; free_of: free lengths of the
        first moves; limit: see drop_behind(). Every other point and candidate does: the second move is looked at again, with
        all of them, before it is driven.
        """
        env = self._envelopes
        at = self._at
        fine = at >= self._coarse
        variant = self.variant[at]
        candidate = self.candidate[at]
        second = 1 if self._next >= _LEFT_SIDE else 0
        first = self._next - second * _LEFT_SIDE
        if first == 0:
            if fine or not second:
                env.travel(variant, candidate, self.length[at])
                turn = env.end_turn
                self._n = move(px, py, n, env.end_x, env.end_y, sin14(turn), cos14(turn), env.lengths[3] + env.half_length, qx, qy, 2)
                self._near = sort_near(qx, qy, self._n, env.half_width, env.half_length, env.soft + BAND_MM)
                cost = self._worth.stand_at(env.end_x, env.end_y, turn)
                if not fine:
                    self._score[at] -= cost  # that of the second move's end takes its place
            if second:
                mirror(qx, self._n)
            self._left = drop_behind(qx, qy, self._near, self._n, env.half_length + env.soft, limit)
        if env.ahead_end <= first < env.arcs:
            first = env.arcs
        stride = 2 if first < env.arcs else 1
        last = min(first + stride * (in_a_slice(self._left) + 1), env.ahead_end if stride == 2 else env.count)
        self._sweep.run(qx, qy, self._left, self._near, first, last, stride, env.lengths[1], self._free, self._soft, self._block)
        self._worth.score(second, self._free, self._soft, scores, first, last, stride, env.af_of(variant, candidate), env.ar_of(variant, candidate), _TO_A_SIDE)
        number = best(scores, first, last, stride)
        if number != NOTHING:
            value = self._score[at] + scores[number]
            if value < self._least:
                self._least = value
                self.found = True
                self.chosen = at
                self.second_variant = second
                self.second_candidate = number // LENGTHS
                self.second_length = env.lengths[number % LENGTHS]
        if last < env.count:
            self._next = second * _LEFT_SIDE + last
            return False
        if not fine and not second:
            self._next = _LEFT_SIDE
            return False
        at += 1
        if not fine and at < self._coarse and self.found and self._score[at] > self._least + _SLACK:
            self.count = self._coarse = at  # no better pair begins with this one, or with those behind it
        self._at = at
        if at == self._coarse and self.found:
            self._refine(free_of)
        # Fine ones to the side of the best pair only.
        self._next = self.second_variant * _LEFT_SIDE if self._at >= self._coarse else 0
        if self._at < self.count:
            return False
        self._next = 0
        return True

    def _refine(self, free_of):
        """More lengths of the first move of the best pair."""
        at = self.chosen
        variant = self.variant[at]
        candidate = self.candidate[at]
        length = self.length[at]
        unit = self._envelopes.half_length // 25
        for d in (-3, -2, -1, 1, 2, 3):
            other = length + d * unit
            if 2 * unit < other <= free_of[variant][candidate]:
                n = self.count
                self.variant[n] = variant
                self.candidate[n] = candidate
                self.length[n] = other
                self._score[n] = self._score[at] + other - length
                self.count = n + 1
