"""The candidates of candidates.py and room for their tables. What fills them: candidate_arcs.py, candidate_rings.py, candidate_strips.py."""

from array import array
from math import pi, tan

from micropython import const

_BINS = const(16)
_LENGTHS = const(5)
_STRIDE = const(8)
_SECONDS = const(8)  # for each arc: enough for the usual body with any margin; for others it grows
_STRIP_STRIDE = const(8)


class Draft:
    """Tables in the making: the arrays of a Candidates under the same names, and what is needed of the robot to fill them, in mm."""

    def __init__(self, config):
        self.half_width = config.robot_width // 2
        self.half_length = config.robot_length // 2
        self.wheelbase = sum(config.axles_spacings)
        self.first_axle = config.axles_first
        self.half_track = config.axles_track / 2
        self.margin = config.avoid_margin
        self.soft = config.avoid_soft_margin
        self.look_ahead = config.windows_look_ahead
        # A last axle that stays straight is the first one of the mirror in which backward moves are tabulated.
        all_wheels = config.mode == "AWS"
        pairs = _pairs(self, all_wheels)
        strips = (0, 6, 12, 20, 32, 50, 70, 90) if all_wheels else (0,)
        self.arcs = len(pairs)
        self.count = self.arcs + len(strips)
        self.af = array("h", [p[0] * 10 for p in pairs] + [a * 10 for a in strips])
        self.ar = array("h", [p[1] * 10 for p in pairs] + [a * 10 for a in strips])
        self.lengths = array("H", [self.look_ahead * part // 14 for part in (1, 2, 4, 8, 14)])
        self.consts = array("H", bytes(2 * self.arcs * _STRIDE))
        self.table = bytearray(3 * self.arcs * _BINS)  # see candidate_rings.py
        self.seconds = array("H", bytes(2 * _SECONDS * self.arcs))
        self.strips = array("i", bytes(4 * _STRIP_STRIDE * len(strips)))
        self.ends = array("H", bytes(2 * self.count * _LENGTHS * 2))
        self.turns = array("H", bytes(2 * self.count))
        self.used = 0  # of seconds

    def arrays(self):
        """As tables.load() gives them."""
        return self.af, self.ar, self.lengths, self.consts, self.table, self.seconds[: self.used], self.strips, self.ends, self.turns


def _pairs(draft, all_wheels):
    """(AF, AR) of the arcs, degrees."""
    if not all_wheels:
        angles = (3, 6, 9, 12, 15, 18, 21, 25, 29, 33, 37, 41, 45, 50, 55, 60)
        return [(front, 0) for front in angles] + [(0, -rear) for rear in angles]
    angles = (0, 6, 12, 20, 28, 37, 47, 60)
    pairs = []
    for i, front in enumerate(angles):
        for j, rear in enumerate(angles):
            if (i or j) and (j == 0 or -4 <= i - j <= 4) and _beside(draft, front, -rear):
                pairs.append((front, -rear))
    pairs.extend(((25, 10), (45, 25), (45, 10), (-10, -25), (-25, -45), (-10, -45)))
    return pairs


def _beside(draft, front, rear):
    """A centre under the body is left to spinning: its rings enter the outline on every side."""
    r = draft.wheelbase / (tan(front * pi / 180) - tan(rear * pi / 180))
    return r > draft.half_width + 16
