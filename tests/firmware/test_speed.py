"""planner/plan.py and planner/decision.py: how fast a steering may be driven; whether a place has been left."""

from array import array

from rooms import Still

from params.config import Config
from perception.windows import BLUE, NONE, RED
from planner.decision import away, mark
from planner.plan import Plan

_config = Config()


class _Candidates:
    lengths = (60, 128, 257)


class _Ways:
    def __init__(self, soft):
        self.soft = (soft,)


def _speed(free, limit=900, mirroring=0, soft=900, urgent=NONE):
    plan = Plan()
    plan.candidates = _Candidates
    plan.ways = _Ways(soft)
    plan.candidate = 0
    plan.free = free
    plan.limit = limit
    plan.mirroring = mirroring
    plan.choose_speed(urgent, _config)
    return plan.v


def test_a_free_way_is_driven_at_cruise_and_backward_the_same():
    assert _speed(900) == _config.drive_cruise
    assert _speed(900, mirroring=3) == 180 - _config.drive_cruise


def test_it_stands_where_nothing_is_free_or_left():
    assert _speed(0) == 90
    assert _speed(900, limit=0) == 90


def test_it_goes_slower_towards_the_end_of_the_way_and_of_the_move():
    assert 90 < _speed(10) < _speed(40) < _config.drive_cruise
    assert _speed(900, limit=10) == _speed(10)


def test_it_goes_slower_where_it_is_narrow():
    assert 90 < _speed(200, urgent=RED) < _speed(900, soft=100) < _config.drive_cruise
    assert _speed(900, urgent=BLUE) == _config.drive_cruise


def test_what_it_only_passes_does_not_slow_it():
    """A point in the emergency window, but none within the next 257 mm of the way."""
    assert _speed(300, urgent=RED) == _config.drive_cruise
    assert _speed(300, urgent=RED, soft=100) == _speed(300, soft=100)


def test_away_is_far_or_turned():
    odometry = Still()
    odometry.x, odometry.heading = (1 << 28) - 256 * 20, 359_000
    place = array("i", (0, 0, 0))
    mark(place, odometry)
    assert not away(place, odometry, 50, 3000)
    odometry.x = -(1 << 28) + 256 * 20  # the coordinates have gone round, 40 mm on
    odometry.heading = 1_000
    assert not away(place, odometry, 50, 3000)
    assert away(place, odometry, 40, 3000)
    assert away(place, odometry, 50, 1999)
