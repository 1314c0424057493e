"""cost_to_go.py: which way leads out."""

from array import array

from rooms import Still

from params.config import Config
from planner.cost_to_go import CostToGo


class _Points:
    def __init__(self, *walls):
        """walls: (x, y, x, y), mm, as points 20 mm apart."""
        found = []
        for x0, y0, x1, y1 in walls:
            count = max(abs(x1 - x0), abs(y1 - y0)) // 20
            for k in range(count + 1):
                found.append((x0 + (x1 - x0) * k // count, y0 + (y1 - y0) * k // count))
        self.count = len(found)
        self.x = array("H", [8 * x & 0xFFFF for x, _ in found])
        self.y = array("H", [8 * y & 0xFFFF for _, y in found])


def _built(points, field=None, odometry=None):
    field = field or CostToGo(Config())
    odometry = odometry or Still()
    while not field.step(odometry, points):
        pass
    return field


def _at(field, x, y, heading=0):
    return field.at(8 * x, 8 * y, heading)


def test_ahead_is_cheaper_than_behind():
    field = _built(_Points())
    assert _at(field, 0, 400) < _at(field, 0, 0) < _at(field, 0, -400)


def test_costs_lead_round_a_corner():
    # A corridor 500 mm wide that turns right: closed ahead and on the left.
    field = _built(_Points((-250, -900, -250, 400), (-250, 400, 900, 400), (250, -900, 250, -100), (250, -100, 900, -100)))
    assert _at(field, 500, 150, 900) < _at(field, 0, 0) < _at(field, 0, -300)
    # the mirrored corridor, mirrored costs
    other = _built(_Points((250, -900, 250, 400), (250, 400, -900, 400), (-250, -900, -250, -100), (-250, -100, -900, -100)))
    assert _at(other, -500, 150, 900) < _at(other, 0, 0) < _at(other, 0, -300)


def test_ground_covered_is_dear():
    odometry = Still()
    field = CostToGo(Config())
    walls = _Points((-300, -1000, -300, 1000), (300, -1000, 300, 1000))
    before = _at(_built(walls), 0, -400)
    for y in range(-900, 1, 10):
        odometry.y = y * 256
        field.follow(odometry)
    _built(walls, field, odometry)
    assert _at(field, 0, -400) > before + 20


def test_leaving_rear_first_is_dear():
    # A corridor in which the body cannot turn round; the way out is the same, the nose points to it or away from it.
    walls = _Points((-190, -1000, -190, 1000), (190, -1000, 190, 1000))
    odometry = Still()
    on = _at(_built(walls), 0, 0)
    odometry.heading = 180000
    back = _at(_built(walls, None, odometry), 0, 0)
    assert 1400 < back - on < 2100
    # In the open it leaves square at worst: half a turn of the nose is never more than the turn on the spot.
    assert _at(_built(_Points(), None, odometry), 0, 0) - _at(_built(_Points()), 0, 0) < 900


def test_mirrored_rooms_cost_the_same():
    for nose in (0, 30, 90, 150):
        _mirrored("AWS", nose)


def _mirrored(mode, nose):
    """The field of a corridor that turns right, for a nose at so many degrees; that of its mirror image costs the same."""
    # No point stands on the edge of a half cell, which has no mirror image.
    odometry = Still()
    odometry.heading = nose * 1000
    walls = _Points((-260, -890, -260, 390), (-260, 390, 890, 390), (260, -890, 260, -90), (260, -90, 890, -90))
    field = _built(walls, CostToGo(Config({"mode": mode})), odometry)
    odometry.heading = (360 - nose) % 360 * 1000
    walls = _Points((260, -890, 260, 390), (260, 390, -890, 390), (-260, -890, -260, -90), (-260, -90, -890, -90))
    other = _built(walls, CostToGo(Config({"mode": mode})), odometry)
    for x, y, heading in ((0, 0, 0), (50, -100, 150), (-50, -200, -80), (400, 150, 700), (120, 60, 330)):
        assert abs(_at(field, x, y, heading) - _at(other, -x, y, -heading)) <= 12
    return field


def _naws():
    return CostToGo(Config({"mode": "NAWS"}))


def test_with_the_last_axle_straight_what_lies_beside_the_body_is_far():
    # A bay open to the right, 100 mm longer than the body.
    walls = _Points((-190, -350, -190, 350), (-190, 350, 190, 350), (-190, -350, 190, -350))
    out = {}
    for name, field in (("AWS", CostToGo(Config())), ("NAWS", _naws())):
        _built(walls, field)
        out[name] = _at(field, 0, 0) - _at(field, 410, 0)
    # All wheels steered, it crabs out, at about the distance. Otherwise it leaves as a car does, by driving to and fro.
    assert 300 < out["AWS"] < 600
    assert 1.5 * out["AWS"] < out["NAWS"] < 5000


def test_with_the_last_axle_straight_mirrored_rooms_cost_the_same():
    field = _mirrored("NAWS", 0)
    # The turn right is driven forward: nearer to its end is cheaper.
    assert _at(field, 500, 150, 750) < _at(field, 150, 60, 400) < _at(field, -50, -250, 0)


def test_backing_is_dear_where_the_last_axle_stays_straight():
    # A corridor closed ahead, open behind: with a nose that points out, driving out costs less than with one that points in.
    walls = _Points((-200, -900, -200, 500), (200, -900, 200, 500), (-200, 500, 200, 500))
    odometry = Still()
    inward = _built(walls, _naws())
    odometry.heading = 180000
    outward = _built(walls, _naws(), odometry)
    assert _at(inward, 0, 0) - _at(inward, 0, -300) > 2 * (_at(outward, 0, 0, 1800) - _at(outward, 0, -300, 1800)) > 300


def test_ways_of_a_straight_last_axle_go_round_its_tightest_circle():
    from planner.primitives_naws import ways

    table = ways(497, 248.5, 400)
    assert len(table) == 24 * 24 and max(table) < 2048
    x = y = 0
    for t in range(24):
        way = _way(table, t * 24 + 18)  # to the next heading, as driven: against what the table says
        x -= way[0]
        y -= way[1]
        if t == 11:
            half = x, y
    assert (x, y) == (0, 0)
    # Half round, the centre comes to lie a diameter of the last axle's circle to the side, and as far behind as the axle was before.
    assert abs(abs(half[0]) - 2 * 497 / 1.732 / 50) <= 1.5 and abs(abs(half[1]) - 2 * 248.5 / 50) <= 1.5
    # A turn and back again, both forward, go to no side: on along the body only.
    for t in range(24):
        out = _way(table, t * 24 + 18)
        back = _way(table, (t + 1) % 24 * 24 + 22)
        x = out[0] + back[0]
        y = out[1] + back[1]
        assert 1 <= x * x + y * y <= 21


def _way(table, at):
    """x, y of a motion primitive, cells."""
    return (table[at] >> 4) - 8, (table[at] & 15) - 8
