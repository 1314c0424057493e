"""field.py: which way leads on."""

from array import array

from config import Config
from field import Field
from rooms import Still


class _Points:
    def __init__(self, *walls):
        """walls: (x, y, x, y), mm, as points 20 mm apart."""
        found = []
        for x0, y0, x1, y1 in walls:
            count = max(abs(x1 - x0), abs(y1 - y0)) // 20
            for k in range(count + 1):
                found.append((x0 + (x1 - x0) * k // count, y0 + (y1 - y0) * k // count))
        self.count = len(found)
        self._fx = array("H", [8 * x & 0xFFFF for x, _ in found])
        self._fy = array("H", [8 * y & 0xFFFF for _, y in found])


def _built(points, field=None, odometry=None):
    field = field or Field(Config())
    odometry = odometry or Still()
    while not field.work(odometry, points):
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
    field = Field(Config())
    walls = _Points((-300, -1000, -300, 1000), (300, -1000, 300, 1000))
    before = _at(_built(walls), 0, -400)
    for y in range(-900, 1, 10):
        odometry.y = y * 256
        field.follow(odometry)
    _built(walls, field, odometry)
    assert _at(field, 0, -400) > before + 20
