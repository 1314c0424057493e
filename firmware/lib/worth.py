"""What a move is worth: its length, what it costs to leave the neighbourhood from where it ends, and what steering, changing the steering, a way
that closes soon and narrow passing are to cost.

A move is a candidate of envelope.py in one of four variants (bit 0 left, bit 1 backward), driven as far as one of its LENGTHS: number 5 k + i.
"""

from array import array

import micropython
from micropython import const

from field import sample
from trig import cos14, sin14

NOTHING = const(65535)


@micropython.viper
def _ends(cost, ends: ptr16, turns: ptr16, free: ptr16, lengths: ptr16, score: ptr16, job: ptr32):
    """What each travel of each candidate is worth: score[5 k + i] = travel + cost of the pose where it ends, mm.

    65535 where the travel is longer than the candidate's free length. job: x, y of the body in the grid (1/8 mm, + 2**15), sine,
    cosine (2**14, + 2**14), flip x, flip y (0/1), cell, first, last, stride, heading (0.1 deg)
    """
    x0 = job[0] - 32768
    y0 = job[1] - 32768
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
        i = 0
        while i < 5:
            value = 65535
            at = k * 5 + i
            if lengths[i] <= free[k]:
                px = ends[2 * at] - 8192
                py = ends[2 * at + 1] - 8192
                turn = (turns[at] ^ 0x8000) - 0x8000
                if flip_x:
                    px = 0 - px
                    turn = 0 - turn
                if flip_y:
                    py = 0 - py
                    turn = 0 - turn
                value = lengths[i] + int(sample(cost, x0 + ((px * c + py * s + 1024) >> 11), y0 + ((py * c - px * s + 1024) >> 11), heading + turn, cell))
                if value > 65534:
                    value = 65534
            score[at] = value
            i += 1
        k += stride


@micropython.viper
def _weigh(score: ptr16, free: ptr16, soft: ptr16, af: ptr16, ar: ptr16, lengths: ptr16, job: ptr32):
    """Add what steering, change of steering, a closed way and narrow passing cost.

    job: first, last, stride, sign (2 forward right, 0 forward left, 3, 1 backward), AF now + 1800, AR now + 1800, look-ahead,
    steering weight, change weight (1/1024 mm per 0.1 deg), extra (mm)
    """
    k = job[0]
    last = job[1]
    stride = job[2]
    variant = job[3]
    af0 = job[4] - 1800
    ar0 = job[5] - 1800
    room = job[6]
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
        # A way that closes soon, or narrowly passed, is dear whatever part of it is driven: the rest comes next.
        f = free[k]
        if f < room:
            cost += (room - f) >> 1
        f = soft[k]
        if f < room:
            cost += (room - f) >> 2
        i = 0
        while i < 5:
            v = score[k * 5 + i]
            if v < 65000:
                score[k * 5 + i] = v + cost
            i += 1
        k += stride


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


class Worth:
    """Scores moves from one pose: the body's when the decision began, or the end of a first move.

    x, y, heading: the body's when the decision began, 1/8 mm and 0.1 deg.
    scores: array('H') of 5 for each candidate, mm, lower is better, NOTHING where the way is not free as far.
    """

    def __init__(self, config, field, envelopes):
        self._field = field
        self._envelopes = envelopes
        self._job = array("i", [0] * 11)
        self._weights = array("i", [0] * 10)
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
        job[10] = a % 3600
        return field.at(x, y, a)

    def score(self, variant, free, soft, scores, first, last, stride, af, ar, extra):
        """Fill the scores of candidates first, first + stride, ... before last in a variant.

        free, soft: their free lengths (sweep.py). af, ar: the steering now, 0.1 deg. extra: mm on all.
        """
        env = self._envelopes
        job = self._job
        job[4] = variant & 1
        job[5] = variant >> 1
        job[7] = first
        job[8] = last
        job[9] = stride
        _ends(self._field.cost, env.ends, env.turns, free, env.lengths, scores, job)
        job = self._weights
        job[0] = first
        job[1] = last
        job[2] = stride
        job[3] = variant
        job[4] = af + 1800
        job[5] = ar + 1800
        job[9] = extra
        _weigh(scores, free, soft, env.af, env.ar, env.lengths, job)
