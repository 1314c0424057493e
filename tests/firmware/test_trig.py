"""trig.py against the floating point functions."""

from math import cos, radians, sin

from core.trig import COARSE_SIN, SIN, cos14, sin14


def test_tables_are_exact_to_their_last_bit():
    assert len(SIN) == 227 and SIN[0] == 0 and SIN[225] == SIN[226] == 2**16 - 1
    for k in range(225):
        assert abs(min(sin(radians(4 * k / 10)) * 2**16, 2**16 - 1) - SIN[k]) <= 0.501, k
    assert len(COARSE_SIN) == 46 and COARSE_SIN[0] == 0 and COARSE_SIN[45] == 2**30 - 1
    for k in range(46):
        assert abs(COARSE_SIN[k] - sin(radians(2 * k)) * (2**30 - 1)) < 0.5001, k


def test_sine_and_cosine_of_any_angle():
    for a in range(-4000, 7600, 7):
        assert abs(sin14(a) - 16384 * sin(radians(a / 10))) <= 0.75, a
        assert abs(cos14(a) - 16384 * cos(radians(a / 10))) <= 0.75, a


def test_sine_and_cosine_at_the_quadrants():
    assert [sin14(a) for a in (0, 900, 1800, 2700, 3600)] == [0, 16384, 0, -16384, 0]
    assert [cos14(a) for a in (0, 900, 1800, 2700, 3600)] == [16384, 0, -16384, 0, 16384]
    assert sin14(-900) == -16384 and cos14(-1800) == -16384
    assert sin14(3600 * 100000 + 300) == 8192 and cos14(-3600 * 100000 + 600) == 8192
