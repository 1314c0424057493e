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
    consts, table, seconds     of the arcs, strips of the others: see envelope_tables.py
    half_width, half_length, look_ahead, margin, soft    mm
    """

    def __init__(self, config):
        from envelope_tables import fill

        fill(self, config)
        forget("envelope_tables")
