"""Trajectory envelopes: every candidate steering with what the whole body sweeps when it is driven.

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

from once import forget

BIAS = const(8192)
LENGTHS = const(5)


class Envelopes:
    """The tables; about half a second of computing on the ESP32.

    count                      candidates; 0..arcs-1 turn right, arcs..count-1 go straight or crab to the right
    ahead_end, astern_first    arcs 0..ahead_end-1 are for driving ahead, astern_first..arcs-1 for driving backward; all of them for both,
                               unless the last axle stays straight
    af, ar                     array 'h', 0.1 deg
    ends, turns                for each candidate and each of LENGTHS travels (`lengths`, mm) where the body's centre comes to lie,
                               x, y, mm + 8192, and how far it has turned clockwise, 0.1 deg
    consts, table, seconds     of the arcs: see envelope_arcs.py; strips of the others: see envelope_strips.py
    half_width, half_length, look_ahead, margin, soft    mm
    """

    def __init__(self, config):
        from envelope_tables import prepare

        prepare(self, config)
        del prepare
        forget("envelope_tables")
        self._fill(config.avoid_margin, config.avoid_soft_margin, config.windows_look_ahead)

    def outdated(self, config):
        """Whether margin, soft margin or look-ahead of the config are others than the tables were made with."""
        return self.margin != config.avoid_margin or self.soft != config.avoid_soft_margin or self.look_ahead != config.windows_look_ahead

    def refill(self, config):
        """Make the tables anew, in place, with margin, soft margin and look-ahead of the config. Due when `outdated` says so.

        The robot must stand: nothing else happens meanwhile. All arrays stay the same objects. What was derived from the attributes in mm
        has to be derived again (Avoid: look_ahead, _swing; Field: its shape), and a decision begun with the old tables to be given up.
        MemoryError, with the old tables whole, if the heap has no room for the code that makes them, some 3 kB. Settings.tune() lets the
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
        """The code comes in two parts, one after the other: together they would be more than the heap has to spare."""
        try:
            from envelope_arcs import fill

            self.margin = -1  # neither the old tables nor the new ones
            fill(self, margin, soft, look_ahead)
            del fill
            forget("envelope_arcs")
            from envelope_strips import fill

            fill(self, margin, soft)
            del fill
        finally:
            forget("envelope_arcs", "envelope_strips")
        self.margin = margin
        self.soft = soft
        self.look_ahead = look_ahead
