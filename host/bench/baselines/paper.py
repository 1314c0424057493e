"""The papers' gap seeking, literally: gaps between neighbouring points, AF and AR iterated in two levels by one degree, rule (24).

Plain MicroPython with floats, no tables. Source: paper A, section 4.2.2, equations (4) and (14)-(24), figures 17 and 19; the wheel angles in the
corrected form, the trajectory curves (18) left out, as rule (24) does not need them.
"""

from math import atan, atan2, pi, sqrt, tan

COMPENSATION = 35.0  # Delta L, mm: how much farther out the body's outer corner runs than the wheel; the papers leave it open
STRAIGHT = 1e6  # radius that stands for a straight line, mm


def hypot(x, y):
    return sqrt(x * x + y * y)


class Planner:
    """config: Config. decide(): (AF, AR) in degrees, or None."""

    def __init__(self, config):
        self.width = config.robot_width
        self.half_length = config.robot_length / 2
        self.look_ahead = config.windows_look_ahead
        self.side = config.windows_side
        self.half_track = config.axles_track / 2
        self.first = config.axles_first
        self.span = sum(config.axles_spacings)

    def decide(self, xs, ys):
        """Steering through the gap nearest to the body's centre line that rule (24) lets it pass. xs, ys: points, body frame, mm."""
        points = self.ahead(xs, ys)
        for inside, outside, right in self.gaps(points):
            found = self.iterate(inside, outside, right)
            if found:
                return found
        return None

    def ahead(self, xs, ys):
        """Points of the yellow window in the zones that matter when driving forward, clockwise from the left."""
        points = []
        for i in range(len(xs)):
            x, y = xs[i], ys[i]
            if -self.half_length <= y <= self.half_length + self.look_ahead and abs(x) <= self.width / 2 + self.side:
                points.append((atan2(x, y), x, y))
        points.sort()
        return points

    def gaps(self, points):
        """(inside point, outside point or None, to the right) of each gap, those nearest to the centre line first."""
        found = []
        for m in range(len(points) - 1):
            one, other = points[m][1:], points[m + 1][1:]
            if hypot(other[0] - one[0], other[1] - one[1]) >= self.width:
                right = one[0] + other[0] >= 0
                inside, outside = (one, other) if right else (other, one)
                found.append((abs(inside[0] + outside[0]), inside, outside, right))
        if points:
            found.append((2 * STRAIGHT, points[0][1:], None, False))
            found.append((2 * STRAIGHT, points[-1][1:], None, True))
        found.sort(key=lambda gap: gap[0])
        return [gap[1:] for gap in found]

    def iterate(self, inside, outside, right):
        """The two-level iteration for one gap; the left is the mirror of the right, (19) and (20)."""
        side = 1 if right else -1
        for af in range(61):
            for ar in range(0, -61, -1):
                if self.passes(af, ar, side * inside[0], inside[1], outside and (side * outside[0], outside[1])):
                    return side * af, side * ar
        return None

    def passes(self, af, ar, x, y, outside):
        """Rule (24) for one steering to the right: D_out < R_ij + Delta L < D_in for the four outer wheels, by (4) and (14)-(17)."""
        difference = tan(af * pi / 180) - tan(ar * pi / 180)
        radius = self.span / difference if difference else STRAIGHT
        ahead = radius * tan(af * pi / 180)  # LL11
        behind = self.span - ahead
        # (4): angles of the outer wheels, and with them (14)-(17): the centre from the right wheels, the radius of each wheel's track
        a12 = atan(ahead / (radius - self.half_track)) if radius != self.half_track else pi / 2
        a52 = -atan(behind / (radius - self.half_track)) if radius != self.half_track else -pi / 2
        if difference and tan(a12) != tan(a52):
            l11 = self.span * tan(a12) / (tan(a12) - tan(a52))
            bb = l11 / tan(a12) if tan(a12) else radius - self.half_track
        else:
            l11, bb = 0.0, STRAIGHT
        xc = self.half_track + bb
        yc = self.first - l11
        d_in = hypot(xc - x, yc - y) - COMPENSATION
        d_out = hypot(xc - outside[0], yc - outside[1]) + COMPENSATION if outside else 0.0
        for wheel_y in (self.first, self.first - self.span):
            for wheel_x in (-self.half_track, self.half_track):
                if not d_out < hypot(xc - wheel_x, yc - wheel_y) + COMPENSATION < d_in:
                    return False
        return True
