"""Trajectory candidates: every candidate steering with what the whole body sweeps when it is driven.

Turning about a fixed centre C, the body sweeps a ring sector: a point at distance d from C is met when the ring of
radius d, followed against the turn, leads from the point into the body's outline. Where that happens depends on d
alone, so for every candidate a table over d holds the angle at which its ring enters the outline, and, for the few rings
that enter it twice, the second one. With the centre at infinity (straight and crab) the ring is a strip and the outline two slopes.
sweep.py tests points against these tables.

Only forward candidates that turn right are tabulated. Left is the same test on points mirrored in x, backward on
points mirrored in y, so a mirrored course gives mirrored answers by construction.

Coordinates: body frame, mm + 8192 (never negative). Lengths: travel of the fastest wheel, mm.
"""

from micropython import const

from core.trig import cos14, sin14
from core.unload import unload

BIAS = const(8192)
LENGTHS = const(5)
ARC_STRIDE = const(13)  # words of `consts` for an arc, of `strips` for a strip: envelope_arcs.py, envelope_strips.py
STRIP_STRIDE = const(8)


class Candidates:
    """The tables; about half a second of computing on the ESP32.

    count                      candidates; 0..arcs-1 turn right, arcs..count-1 go straight or crab to the right
    ahead_end, astern_first    arcs 0..ahead_end-1 are for driving ahead, astern_first..arcs-1 for driving backward; all of them for both,
                               unless the last axle stays straight
    af, ar                     array 'h', 0.1 deg
    ends, turns                for each candidate and each of LENGTHS travels (`lengths`, mm) where the body's centre comes to lie,
                               x, y, mm + 8192, and how far it has turned clockwise, 0.1 deg
    consts, table, seconds     of the arcs: see envelope_arcs.py, envelope_rings.py; strips of the others: see envelope_strips.py
    half_width, half_length, look_ahead, margin, soft    mm
    end_x, end_y, end_turn     what travel() found

    A variant is how a candidate is mirrored: bit 0 left, bit 1 backward.
    """

    def __init__(self, config):
        self.end_x = self.end_y = self.end_turn = 0
        from planner.candidate_set import prepare

        prepare(self, config)
        del prepare
        unload("planner.candidate_set")
        self._fill(config.avoid_margin, config.avoid_soft_margin, config.windows_look_ahead)

    def af_of(self, variant, k):
        """AF of a candidate in a variant, 0.1 deg: backward, front and rear change places."""
        if variant & 2:
            return self.ar[k] if variant & 1 else -self.ar[k]
        return -self.af[k] if variant & 1 else self.af[k]

    def ar_of(self, variant, k):
        """AR, likewise."""
        if variant & 2:
            return self.af[k] if variant & 1 else -self.af[k]
        return -self.ar[k] if variant & 1 else self.ar[k]

    def travel(self, variant, k, length):
        """Where `length` mm on a candidate lead to: end_x, end_y (mm) and end_turn (0.1 deg, clockwise) of the body's centre."""
        if k >= self.arcs:
            b = (k - self.arcs) * STRIP_STRIDE
            x = self.strips[b] * length >> 14
            y = self.strips[b + 1] * length >> 14
            turn = 0
        else:
            b = k * ARC_STRIDE
            xc = self.consts[b] - BIAS
            yc = self.consts[b + 1] - BIAS
            # In 0.01 deg, 183 / 2**20 of a radian: the centre may be metres away.
            turn = (length * 36000 + (self.consts[b + 9] >> 1)) // self.consts[b + 9]
            rest = turn % 10
            turn //= 10
            s = sin14(turn)
            c = cos14(turn)
            s, c = s + (c * rest * 183 >> 20), c - (s * rest * 183 >> 20)
            x = xc - ((xc * c + yc * s + 8192) >> 14)
            y = yc + ((xc * s - yc * c + 8192) >> 14)
            turn += rest > 4
        if variant & 1:
            x = -x
            turn = -turn
        if variant & 2:
            y = -y
            turn = -turn
        self.end_x = x
        self.end_y = y
        self.end_turn = turn

    def outdated(self, config):
        """Whether margin, soft margin or look-ahead of the config are others than the tables were made with."""
        return self.margin != config.avoid_margin or self.soft != config.avoid_soft_margin or self.look_ahead != config.windows_look_ahead

    def refill(self, config):
        """Make the tables anew, in place, with margin, soft margin and look-ahead of the config. Due when `outdated` says so.

        The robot must stand: nothing else happens meanwhile. All arrays stay the same objects. What was derived from the attributes in mm
        has to be derived again (Avoid: look_ahead, _swing; CostToGo: its shape), and a decision begun with the old tables to be given up.
        MemoryError, with the old tables whole, if the heap has no room for the code that makes them, some 2 kB. Settings.tune() lets the
        robot stand, makes room, calls Avoid.configure(), and refuses the change if that raises MemoryError.
        """
        before = self.margin, self.soft, self.look_ahead
        try:
            self._fill(config.avoid_margin, config.avoid_soft_margin, config.windows_look_ahead)
        except MemoryError:
            if self.margin < 0:
                self._restore(before)
            raise

    def _restore(self, before):
        try:
            self._fill(*before)
        except MemoryError:
            raise RuntimeError("no room to make the envelope tables whole again: restart") from None

    def _fill(self, margin, soft, look_ahead):
        """The code comes in parts, one after the other: together they would be more than the heap has to spare."""
        for name in ("planner.candidate_arcs", "planner.candidate_rings", "planner.candidate_strips"):
            try:
                part = __import__(name, None, None, ("fill",))
                self.margin = -1  # neither the old tables nor the new ones
                part.fill(self, margin, soft, look_ahead)
            finally:
                part = None
                unload(name)
        self.margin = margin
        self.soft = soft
        self.look_ahead = look_ahead
