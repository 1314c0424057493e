"""odometry.py against the exact motion about a fixed turning centre."""

from math import cos, pi, sin, sqrt, tan

from core.axles import lay_out
from perception.odometry import Odometry
from steering import Steering

SPACINGS = (115, 150, 117, 115)


class _Config:
    motors_full_speed = 1280


class _Drive:
    def __init__(self, af, ar, v):
        self.steering = Steering(lay_out(SPACINGS, 230, 248.5))
        assert self.steering.solve(af, ar)
        self.v256 = (v - 90) * 256


def _driven(af, ar, v, ms):
    """x, y (mm) and heading (deg) after ms of driving."""
    odometry = Odometry(_Config())
    drive = _Drive(af, ar, v)
    for now in range(0, ms + 1, 10):
        odometry.advance(now * 1000, drive)
    heading = odometry.heading / 1000
    return odometry.x / 256, odometry.y / 256, heading - 360 if heading > 180 else heading


def _near(found, expected, tolerance):
    for one, other in zip(found, expected):
        assert abs(one - other) <= tolerance, (found, expected)


def test_straight_on_and_back():
    _near(_driven(0, 0, 108, 2000), (0, 512, 0), 2)
    _near(_driven(0, 0, 72, 2000), (0, -512, 0), 2)


def test_crab():
    _near(_driven(300, 300, 108, 2000), (512 * sin(pi / 6), 512 * cos(pi / 6), 0), 2)


def test_arc_forward_and_backward():
    r = 248.5 / tan(pi / 6)
    for v, way in ((108, 512), (72, -512)):
        turn = way / sqrt((r + 115) ** 2 + 248.5**2)
        _near(_driven(300, -300, v, 2000), (r * (1 - cos(turn)), r * sin(turn), turn * 180 / pi), 4)


def test_left_is_the_mirror_of_right():
    x, y, heading = _driven(300, -150, 108, 2000)
    _near(_driven(-300, 150, 108, 2000), (-x, y, -heading), 0.2)


def test_spin():
    turn = 256 / sqrt(115**2 + 248.5**2) * 180 / pi
    _near(_driven(900, -900, 108, 1000), (0, 0, turn), 1)
    _near(_driven(-900, 900, 108, 1000), (0, 0, -turn), 1)


_WRAPS = (2**29, 2**30)


def test_it_goes_on_past_the_wraps_of_ticks():
    for wrap in _WRAPS:
        odometry = Odometry(_Config())
        drive = _Drive(0, 0, 108)
        for now in range(0, 2001, 10):
            odometry.advance((wrap - 1_000_000 + now * 1000) % 2**30, drive)
        _near((odometry.x / 256, odometry.y / 256), (0, 512), 2)


def test_a_pause_of_any_length_is_two_tenths_of_a_second():
    for pause in (1_000_000, 2**29 - 1, 2**29 + 1_000_000, 2**30 - 10_000_000):
        odometry = Odometry(_Config())
        drive = _Drive(0, 0, 108)
        odometry.advance(5_000_000, drive)
        odometry.advance((5_000_000 + pause) % 2**30, drive)
        _near((odometry.y / 256,), (51.2,), 1)
        odometry.advance((5_100_000 + pause) % 2**30, drive)
        _near((odometry.y / 256,), (76.8,), 1)


def test_position_starts_again_after_a_kilometre():
    odometry = Odometry(_Config())
    odometry.y = 2**28 - 256
    before = odometry.y >> 5 & 0xFFFF
    drive = _Drive(0, 0, 108)
    for now in range(0, 2001, 10):
        odometry.advance(now * 1000, drive)
    assert -(2**28) <= odometry.y < -(2**28) + 600 * 256
    _near((((odometry.y >> 5) - before & 0xFFFF) / 8,), (512,), 2)  # on the map nothing jumps
