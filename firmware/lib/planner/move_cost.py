"""What a move is worth: its length, what it costs to leave the neighbourhood from where it ends, and what steering, changing the steering, a way
that closes soon and narrow passing are to cost.

A move is a candidate of envelope.py in one of four variants (bit 0 left, bit 1 backward), driven as far as one of its LENGTHS: number 5 k + i.

Points only ever make a move worse. So what each promises, as if none were there, bounds what it is worth: swept in this order (promise(),
keep_promises()), the best is known for sure when it comes first with all points counted, and most candidates are never swept.
"""

from array import array

import micropython
from micropython import const

from core.trig import cos14, sin14
from planner.candidates import LENGTHS
from planner.cost_to_go import sample

NOTHING = const(65535)
_SLICE = const(1800)  # candidate tests in one slice
_OVERHEAD = const(76)  # what is done once for a candidate, its five ends valued above all, in tests
_PICKING = const(190)  # ... to find and to test the one that promises most


def in_a_slice(n):
    """How many candidates are tested against n points in one slice, but for one."""
    return _SLICE // (n + _OVERHEAD)


@micropython.viper
def _ends(cost, ends: ptr16, turns: ptr16, free: ptr16, lengths: ptr16, score: ptr16, job: ptr32, poses):
    """What each travel of each candidate is worth: score[5 k + i] = travel + cost of the pose where it ends, mm.

    65535 where the travel is longer than the candidate's free length. job: x, y of the body in the grid (1/8 mm, + 2**15), sine,
    cosine (2**14, + 2**14), flip x, flip y (0/1), cell, first, last, stride, heading (0.1 deg, 3600 to 7199); poses: room for 5, as for sample()
    """
    pose = ptr32(poses)
    x0 = job[0] + 32768
    y0 = job[1] + 32768
    s = job[2] - 16384
    c = job[3] - 16384
    flip_x = job[4]
    flip_y = job[5]
    cell = job[6]
    k = job[7]
    last = job[8]
    stride = job[9]
    heading = job[10]
    while k < last:
        n = 0
        p = 0
        at = k * 5
        while n < 5 and lengths[n] <= free[k]:
            px = ends[2 * at] - 8192
            py = ends[2 * at + 1] - 8192
            turn = (turns[at] ^ 0x8000) - 0x8000
            if flip_x:
                px = 0 - px
                turn = 0 - turn
            if flip_y:
                py = 0 - py
                turn = 0 - turn
            pose[p] = x0 + ((px * c + py * s + 1024) >> 11)
            pose[p + 1] = y0 + ((py * c - px * s + 1024) >> 11)
            pose[p + 2] = heading + turn
            n += 1
            p += 3
            at += 1
        sample(cost, poses, n, cell)
        at = k * 5
        i = 0
        while i < 5:
            value = 65535
            if i < n:
                value = lengths[i] + pose[i * 3]
            score[at + i] = value
            i += 1
        k += stride


@micropython.viper
def _weigh(score: ptr16, af: ptr16, ar: ptr16, job: ptr32):
    """Add what steering and change of steering cost.

    job: first, last, stride, variant, AF now + 1800, AR now + 1800, (of _narrow), steering weight, change weight (1/1024 mm per 0.1 deg), extra (mm)
    """
    k = job[0]
    last = job[1]
    stride = job[2]
    variant = job[3]
    af0 = job[4] - 1800
    ar0 = job[5] - 1800
    w_steer = job[7]
    w_change = job[8]
    extra = job[9]
    while k < last:
        a = (af[k] ^ 0x8000) - 0x8000
        r = (ar[k] ^ 0x8000) - 0x8000
        cost = a
        if a < 0:
            cost = 0 - a
        if r < 0:
            cost -= r
        else:
            cost += r
        cost = cost * w_steer
        if variant == 1:
            a = 0 - a
            r = 0 - r
        elif variant == 2:
            t = a
            a = 0 - r
            r = 0 - t
        elif variant == 3:
            t = a
            a = r
            r = t
        d = a - af0
        if d < 0:
            d = 0 - d
        e = r - ar0
        if e < 0:
            e = 0 - e
        cost = ((cost + (d + e) * w_change) >> 10) + extra
        i = 0
        while i < 5:
            v = score[k * 5 + i]
            if v < 65000:
                score[k * 5 + i] = v + cost
            i += 1
        k += stride


@micropython.viper
def _narrow(score: ptr16, free: ptr16, soft: ptr16, lengths: ptr16, job: ptr32):
    """Take out the travels longer than what is free; add what a closed way and narrow passing cost.

    job: first, last, stride, ..., 6: the way that is to be free (mm)
    """
    k = job[0]
    last = job[1]
    stride = job[2]
    room = job[6]
    while k < last:
        cost = 0
        # A way that closes soon, or narrowly passed, is dear whatever part of it is driven: the rest comes next.
        f = free[k]
        if f < room:
            cost = (room - f) >> 1
        v = soft[k]
        if v < room:
            cost += (room - v) >> 2
        i = 0
        while i < 5:
            v = score[k * 5 + i]
            if lengths[i] > f:
                score[k * 5 + i] = 65535
            elif v < 65000:
                score[k * 5 + i] = v + cost
            i += 1
        k += stride


@micropython.viper
def _begin(free: ptr16, swept: ptr8, first: int, last: int):
    while first < last:
        free[first] = 65535
        swept[first] = 0
        first += 1


@micropython.viper
def best(score: ptr16, first: int, last: int, stride: int) -> int:
    """Number of the move with the lowest score, of candidates first, first + stride, ... before last; NOTHING if none is possible."""
    best = 65534
    pick = 65535
    k = first
    while k < last:
        i = 0
        while i < 5:
            v = score[k * 5 + i]
            if v < best:
                best = v
                pick = k * 5 + i
            i += 1
        k += stride
    return pick


@micropython.viper
def suppress(score: ptr16, ends: ptr16, turns: ptr16, count: int, at: int, radius: int, reach: int):
    """Take out the travels that end within radius of where travel `at` ends; a turn counts as the way of the body's ends."""
    x0 = ends[at * 2]
    y0 = ends[at * 2 + 1]
    a0 = turns[at] ^ 0x8000
    i = 0
    last = count * 5
    while i < last:
        if score[i] < 65535:
            d = ends[i * 2] - x0
            if d < 0:
                d = 0 - d
            e = ends[i * 2 + 1] - y0
            if e < 0:
                e = 0 - e
            d += e
            e = (turns[i] ^ 0x8000) - a0
            if e < 0:
                e = 0 - e
            if d + (e * reach >> 9) < radius:
                score[i] = 65535
        i += 1


class MoveCost:
    """Scores moves from one pose: the body's when the decision began, or the end of a first move.

    x, y, heading: the body's when the decision began, 1/8 mm and 0.1 deg.
    scores: array('H') of 5 for each candidate, mm, lower is better, NOTHING where the way is not free as far.
    """

    def __init__(self, config, field, candidates):
        self._field = field
        self._envelopes = candidates
        self._job = array("i", [0] * 11)
        self._weights = array("i", [0] * 10)
        self._poses = array("i", [0] * 15)
        self.x = self.y = self.heading = 0
        self.configure(config)

    def configure(self, config):
        """Take over weights that may have been tuned."""
        look_ahead = self._envelopes.look_ahead
        weights = self._weights
        weights[6] = look_ahead * 3 // 7
        weights[7] = config.avoid_steering_weight * look_ahead * 1024 // (100 * 1200)
        weights[8] = config.avoid_change_weight * look_ahead * 1024 // (100 * 1200)

    def stand(self, odometry):
        """Score from where the body is now. Returns its cost of leaving, mm."""
        self.x = odometry.x >> 5
        self.y = odometry.y >> 5
        self.heading = (odometry.heading + 50) // 100
        self.stand_at(0, 0, 0)
        return self._field.at(self.x, self.y, self.heading)

    def stand_at(self, x, y, heading):
        """Score from a pose x, y (mm) and heading (0.1 deg) as seen from where stand() was called. Returns its cost of leaving, mm."""
        field = self._field
        job = self._job
        a = self.heading
        s = sin14(a)
        c = cos14(a)
        x, y = self.x + ((x * c + y * s + 1024) >> 11), self.y + ((y * c - x * s + 1024) >> 11)
        a += heading
        # Nothing negative: words have no sign in viper where pointers are longer than they.
        job[0] = (x - field.corner_x) & 0xFFFF ^ 0x8000
        job[1] = (y - field.corner_y) & 0xFFFF ^ 0x8000
        job[2] = sin14(a) + 16384
        job[3] = cos14(a) + 16384
        job[6] = field.cell
        job[10] = 3600 + a % 3600
        return field.at(x, y, a)

    def score(self, variant, free, soft, scores, first, last, stride, af, ar, extra):
        """Fill the scores of candidates first, first + stride, ... before last in a variant.

        free, soft: their free lengths (sweep.py). af, ar: the steering now, 0.1 deg. extra: mm on all.
        """
        self._value(variant, free, scores, first, last, stride, af, ar, extra)
        self._lessen(free, soft, scores)

    def promise(self, variant, free, swept, scores, first, af, ar):
        """As score(), as if the way were free, from candidate `first` on, 0 to begin with, as many as a slice allows. Returns the next one.

        free: becomes 65535; swept: bytearray, 0. Both for keep_promises().
        """
        env = self._envelopes
        if env.ahead_end <= first < env.arcs:
            first = env.arcs
        last = min(first + in_a_slice(0), env.ahead_end if first < env.ahead_end else env.count)
        # Only of these: candidates for driving backward must not seem free ahead.
        _begin(free, swept, first, last)
        self._value(variant, free, scores, first, last, 1, af, ar, 0)
        return last

    def keep_promises(self, sweep, px, py, n, free, soft, block, swept, scores, most):
        """Sweep those candidates that promise most, as sweep is aimed, until the best of all is known: no score gets better by it.

        n: how many points that are. Returns its number, NOTHING if none is worth `most` or less, -1 if it takes another slice.
        """
        job = self._weights
        job[2] = 1
        count = self._envelopes.count
        for _ in range(_SLICE // (n + _PICKING) + 1):
            number = best(scores, 0, count, 1)
            if number == NOTHING or scores[number] > most:
                return NOTHING
            k = number // LENGTHS
            if swept[k]:
                return number
            sweep.test(px, py, k, k + 1, free, soft, block)
            swept[k] = 1
            job[0] = k
            job[1] = k + 1
            self._lessen(free, soft, scores)
        return -1

    def _lessen(self, free, soft, scores):
        _narrow(scores, free, soft, self._envelopes.lengths, self._weights)

    def _value(self, variant, free, scores, first, last, stride, af, ar, extra):
        env = self._envelopes
        job = self._job
        job[4] = variant & 1
        job[5] = variant >> 1
        job[7] = first
        job[8] = last
        job[9] = stride
        _ends(self._field.cost, env.ends, env.turns, free, env.lengths, scores, job, self._poses)
        job = self._weights
        job[0] = first
        job[1] = last
        job[2] = stride
        job[3] = variant
        job[4] = af + 1800
        job[5] = ar + 1800
        job[9] = extra
        _weigh(scores, env.af, env.ar, job)
