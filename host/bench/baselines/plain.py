"""The firmware's own test of the swept body, without its tables and without its pruning, in plain MicroPython with floats.

Every candidate steering, to either side, against every point: where the circle of the point about the turning centre enters the body's
outline, and how long the fastest wheel travels until then.
"""

from math import atan2, cos, pi, sin, sqrt, tan


def hypot(x, y):
    return sqrt(x * x + y * y)


class Planner:
    """config: Config. candidates: the firmware's, for its candidates (`af`, `ar`, 0.1 deg, those to the right). decide(): free lengths, mm."""

    def __init__(self, config, candidates):
        self.half_width = config.robot_width / 2 + config.avoid_margin
        self.half_length = config.robot_length / 2 + config.avoid_margin
        self.look_ahead = config.windows_look_ahead
        self.half_track = config.axles_track / 2
        self.first = config.axles_first
        self.span = sum(config.axles_spacings)
        self.candidates = [(candidates.af[k] * pi / 1800, candidates.ar[k] * pi / 1800) for k in range(len(candidates.af))]

    def decide(self, xs, ys):
        """Free length of each candidate to the right, then of each to the left, mm. xs, ys: points, body frame, mm."""
        free = []
        for side in (1, -1):
            for af, ar in self.candidates:
                length = self.look_ahead
                straight = abs(tan(af) - tan(ar)) < 1e-9
                for i in range(len(xs)):
                    if straight:
                        way = self.along(side * xs[i], ys[i], af)
                    else:
                        way = self.round(side * xs[i], ys[i], af, ar)
                    if way < length:
                        length = way
                free.append(length)
        return free

    def along(self, x, y, angle):
        """Travel in a straight line at the angle until the outline meets the point."""
        s, c = sin(angle), cos(angle)
        best = self.look_ahead
        if c > 1e-9:
            way = (y - self.half_length) / c
            if way >= 0 and abs(x - way * s) <= self.half_width and way < best:
                best = way
        if s > 1e-9:
            way = (x - self.half_width) / s
            if way >= 0 and abs(y - way * c) <= self.half_length and way < best:
                best = way
        return best

    def round(self, x, y, af, ar):
        """Travel about the turning centre until the outline meets the point."""
        r = self.span / (tan(af) - tan(ar))
        yc = self.first - r * tan(af)
        far = max(abs(self.first - yc), abs(self.first - self.span - yc))
        reference = hypot(r + self.half_track, far)
        d2 = (x - r) ** 2 + (y - yc) ** 2
        at = atan2(y - yc, x - r)
        best = self.look_ahead
        for edge in (self.half_width, -self.half_width):
            q = d2 - (edge - r) ** 2
            if q >= 0:
                v = sqrt(q) if edge > 0 else -sqrt(q)
                if abs(v + yc) <= self.half_length:
                    best = min(best, (atan2(v, edge - r) - at) % (2 * pi) * reference)
        for edge in (self.half_length, -self.half_length):
            q = d2 - (edge - yc) ** 2
            if q >= 0:
                u = -sqrt(q) if edge > 0 else sqrt(q)
                if abs(u + r) <= self.half_width:
                    best = min(best, (atan2(edge - yc, u) - at) % (2 * pi) * reference)
        return best
