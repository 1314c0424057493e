"""Points near the outline, densely, against a body that is moved: how far each candidate may be driven, in all mirrorings, with the last axle steered and straight.

What stands between the margin and the outline may come 2 mm nearer, or hardly at all; what stands farther off, up to the margin.
"""

from array import array
from math import cos, pi, sin

from params.config import Config
from perception.windows import Windows
from planner import reasons
from planner.candidate_tables import Draft, centre
from planner.candidates import BIAS, Candidates
from planner.collision import CollisionCheck, mirror

_SLOP = 3.0  # mm of travel: points and results are whole mm
_STRIDE = 53  # mm along the outline, another offset for each gap: together they are dense


class _Body:
    """The candidates of a mode, and how the body moves on them."""

    def __init__(self, mode):
        config = Config({"mode": mode})
        self.env = Candidates(config)
        self.windows = Windows(config, 400)
        self.check = CollisionCheck(self.env)
        self.x, self.y = array("H", [0]), array("H", [0])
        self.free, self.soft, self.block = (array("H", bytes(2 * self.env.count)) for _ in range(3))
        draft = Draft(config)
        self.turns = []  # centre and travel of a radian, or None and the direction
        for k in range(self.env.count):
            if k < self.env.arcs:
                x, y = centre(draft, k)
                self.turns.append((x, y, self.env.consts[8 * k + 2] / (2 * pi) + self.env.consts[8 * k + 3] * 65536 / (2 * pi)))
            else:
                a = self.env.af[k] * pi / 1800
                self.turns.append((None, sin(a), cos(a)))

    def ask(self, x, y, mirroring):
        """Free lengths for one point in a mirroring; they stay in self.free."""
        self.x[0], self.y[0] = x + BIAS, y + BIAS
        if mirroring & 1:
            mirror(self.x, 1)
        if mirroring & 2:
            mirror(self.y, 1)
        near = self.windows.sort_near(self.x, self.y, 1)
        assert near == 1
        self.check.prepare(1, near, 1, 0)
        self.check.check(self.x, self.y, 0, self.env.count, self.free, self.soft, self.block)

    def gap(self, x, y, mirroring, k, length):
        """How far the point is from the outline, mm, negative inside, when the body has gone `length` mm on candidate k in the mirroring."""
        one, a, b = self.turns[k]
        if mirroring & 1:
            x = -x
        if mirroring & 2:
            y = -y
        if one is None:
            u, v = x - a * length, y - b * length
        else:
            s, c = sin(length / b), cos(length / b)
            u = one + (x - one) * c - (y - a) * s
            v = a + (x - one) * s + (y - a) * c
        return max(abs(u) - self.env.half_width, abs(v) - self.env.half_length)


def _round_the_outline(body, gap):
    """Points with that gap on all four sides."""
    hw, hl = body.env.half_width + gap, body.env.half_length + gap
    offset = gap * 17 % _STRIDE
    for along in range(offset - hw, hw + 1, _STRIDE):
        yield along, hl
        yield -along, -hl
    for along in range(offset - hl, hl + 1, _STRIDE):
        yield hw, along
        yield -hw, -along


def _compare(mode, mirroring, gaps):
    body = _Body(mode)
    env = body.env
    early = late = total = 0
    for gap in gaps:
        # what may be left of it when the body stops
        keep = min(env.margin, gap - 2) if 2 * gap >= env.margin else gap - 0.125
        for x, y in _round_the_outline(body, gap):
            body.ask(x, y, mirroring)
            for k in range(env.count):
                free = body.free[k]
                total += 1
                least = gap
                for part in range(1, 13):
                    least = min(least, body.gap(x, y, mirroring, k, free * part / 12))
                assert free == 0 or least > 0, (mode, mirroring, k, x, y, free, least)  # never to a touch
                if least < keep - 1.5:
                    late += 1
                if free < env.look_ahead - 20:
                    after = gap
                    for part in range(7):
                        after = min(after, body.gap(x, y, mirroring, k, free + _SLOP + part * 4))
                    if after > min(keep, gap) + 1.5 and free + 20 < env.look_ahead:
                        early += 1
    assert total > 2000
    assert late * 500 <= total, (mode, mirroring, late, total)
    assert early * 50 <= total, (mode, mirroring, early, total)


def test_right_ahead_all_wheels():
    _compare("AWS", 0, range(1, 23, 2))


def test_left_ahead_all_wheels():
    _compare("AWS", 1, range(1, 23, 4))


def test_right_backward_all_wheels():
    _compare("AWS", 2, range(2, 23, 4))


def test_left_backward_all_wheels():
    _compare("AWS", 3, range(4, 23, 4))


def test_last_axle_straight():
    for mirroring in range(4):
        _compare("NAWS", mirroring, range(1 + mirroring, 23, 4))


def test_straight_at_a_wall_no_nearer_than_2_mm():
    body = _Body("AWS")
    straight = body.env.arcs
    for gap in range(5, 11):
        body.ask(0, body.env.half_length + gap, 0)
        assert body.free[straight] == 2, (gap, body.free[straight])
    body.ask(0, body.env.half_length + 14, 0)
    assert body.free[straight] in (4, 5)


def test_clear_of_the_margin_at_a_corner_is_passed():
    body = _Body("AWS")
    body.ask(136, 315, 0)
    assert body.free[body.env.arcs] == body.env.look_ahead


def test_walls_all_round_within_the_margin_are_no_place_to_drive():
    """2 mm beside, 6 mm ahead, 2 mm behind."""
    from test_avoid import _decision, _walls

    avoid = _decision(_walls((-127, -302, -127, 306), (127, -302, 127, 306), (-127, 306, 127, 306), (-127, -302, 127, -302)))
    assert avoid.v == 90 and avoid.why == reasons.BOXED
