"""Trajectory candidates: every candidate steering with what the whole body sweeps when it is driven.

Turning about a fixed centre C, the body sweeps a ring sector: a point at distance d from C is met when the ring of
radius d, followed against the turn, leads from the point into the body's outline. Where that happens depends on d
alone, so for every candidate a table over d holds the angle at which its ring enters the outline, and, for the few rings
that enter it twice, the second one. With the centre at infinity (straight and crab) the ring is a strip and the outline two slopes.
collision.py tests points against these tables.

Only forward candidates that turn right are tabulated. Left is the same test on points mirrored in x, backward on
points mirrored in y, so a mirrored course gives mirrored answers by construction.

Coordinates: body frame, mm + 8192 (never negative). Lengths: travel of the fastest wheel, mm.
"""

from micropython import const

from core.trig import cos14, sin14

BIAS = const(8192)
LENGTHS = const(5)
_ARC_STRIDE = const(8)  # words of `consts` for an arc, of `strips` for a strip: candidate_tables.py
_STRIP_STRIDE = const(8)
_TURN_MM = const(2)  # of an arc


class Candidates:
    """The tables; about half a second of computing on the ESP32.

    count                      candidates; 0..arcs-1 turn right, arcs..count-1 go straight or crab to the right
    ahead_end, astern_first    arcs 0..ahead_end-1 are for driving ahead, astern_first..arcs-1 for driving backward; all of them for both,
                               unless the last axle stays straight
    af, ar                     array 'h', 0.1 deg
    ends                       for each candidate and each of LENGTHS travels (`lengths`, mm) where the body's centre comes to lie, x, y, mm + 8192
    turns                      how far each candidate turns, clockwise, 0.1 deg / 2**14 per mm
    consts, table, seconds     of the arcs: see candidate_tables.py; strips of the others: likewise
    half_width, half_length, look_ahead, margin, soft    mm
    end_x, end_y, end_turn     what travel() found

    A mirroring is how a candidate is mirrored: bit 0 left, bit 1 backward.
    """

    def __init__(self, config):
        from planner.parts import candidates

        candidates(self, config)

    def af_of(self, mirroring, k):
        """AF of a candidate in a mirroring, 0.1 deg: backward, front and rear change places."""
        if mirroring & 2:
            return self.ar[k] if mirroring & 1 else -self.ar[k]
        return -self.af[k] if mirroring & 1 else self.af[k]

    def ar_of(self, mirroring, k):
        """AR, likewise."""
        if mirroring & 2:
            return self.af[k] if mirroring & 1 else -self.af[k]
        return -self.ar[k] if mirroring & 1 else self.ar[k]

    def travel(self, mirroring, k, length):
        """Where `length` mm on a candidate lead to: end_x, end_y (mm) and end_turn (0.1 deg, clockwise) of the body's centre."""
        if k >= self.arcs:
            b = (k - self.arcs) * _STRIP_STRIDE
            x = self.strips[b] * length >> 14
            y = self.strips[b + 1] * length >> 14
            turn = 0
        else:
            b = k * _ARC_STRIDE
            xc = self.consts[b] - BIAS
            yc = self.consts[b + 1] - BIAS
            # In 0.01 deg, 183 / 2**20 of a radian: the centre may be metres away.
            per_turn = self.consts[b + _TURN_MM] | self.consts[b + _TURN_MM + 1] << 16  # mm of travel
            turn = (length * 36000 + (per_turn >> 1)) // per_turn
            rest = turn % 10
            turn //= 10
            s = sin14(turn)
            c = cos14(turn)
            s, c = s + (c * rest * 183 >> 20), c - (s * rest * 183 >> 20)
            x = xc - ((xc * c + yc * s + 8192) >> 14)
            y = yc + ((xc * s - yc * c + 8192) >> 14)
            turn += rest > 4
        if mirroring & 1:
            x = -x
            turn = -turn
        if mirroring & 2:
            y = -y
            turn = -turn
        self.end_x = x
        self.end_y = y
        self.end_turn = turn
