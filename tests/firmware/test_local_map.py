"""local_map.py: what is kept of what was seen."""

from array import array

from rooms import FRAME_US, FRAMES, Sight, Still

from params.config import Config
from perception.local_map import LocalMap

_MOST = 320


class _Memory:
    """A robot that stands where it is put, and what it remembers."""

    def __init__(self, values=None):
        self.points = LocalMap(Config(values))
        self.sight = Sight()
        self.odometry = Still()

    def look(self, of, turns=1):
        for _ in range(turns):
            for frame in range(FRAMES):
                self.sight.look(frame, of)
                self.points.frame(self.sight, self.odometry)

    def roll(self, mm):
        self.odometry.y += mm * 256
        self.odometry.travel256 += mm * 256

    def seen(self):
        """[(x, y)] in the body frame."""
        x = array("H", bytes(2 * _MOST))
        y = array("H", bytes(2 * _MOST))
        n = self.points.view(self.odometry.x >> 5, self.odometry.y >> 5, self.odometry.heading // 100, x, y, 1000)
        return [(x[i] - 8192, y[i] - 8192) for i in range(n)]


def _post(distance, behind=0):
    """A post ahead, 6 degrees to each side."""
    return lambda bearing: distance if bearing < 60 or bearing > 3540 else behind


def test_points_lie_where_they_were_measured():
    memory = _Memory()
    memory.look(_post(500))
    points = memory.seen()
    assert points
    for x, y in points:
        assert abs(x) < 60 and 490 < y < 505, points


def test_a_lidar_that_sits_elsewhere():
    for heading in (0, 90_000, 200_000):
        memory = _Memory({"lidar": {"x": -40, "y": 120}})
        memory.odometry.heading = heading
        memory.look(_post(500))
        assert memory.seen()
        for x, y in memory.seen():
            assert abs(x + 40) < 60 and 610 < y < 625, (heading, x, y)
        memory.look(_post(900, 900), 14)  # and sees past them from there, but for one that may lie between the last beam of a turn and the first
        left = [(x, y) for x, y in memory.seen() if (x + 40) * (x + 40) + (y - 120) * (y - 120) < 800 * 800]
        assert len(left) <= 1, (heading, left)


def test_readings_out_of_the_range_of_the_lidar_are_not_used():
    for values, distance, used in (({}, 190, False), ({}, 210, True), ({"near": 100}, 190, True), ({"far": 1000}, 1010, False), ({"far": 1000}, 990, True)):
        memory = _Memory({"lidar": values})
        memory.look(_post(distance))
        assert bool(memory.seen()) == used, (values, distance)


def test_what_comes_too_near_to_be_seen_is_remembered():
    memory = _Memory()
    memory.look(_post(400), 2)
    count = len(memory.seen())
    memory.roll(300)
    memory.look(_post(0), 3)
    points = memory.seen()
    assert len(points) == count
    for x, y in points:
        assert abs(x) < 60 and 90 < y < 110, points


def test_it_is_given_up_after_a_long_way():
    memory = _Memory()
    memory.look(_post(400))
    memory.odometry.travel256 += (memory.points.keep + 10) * 256
    memory.look(_post(0))
    assert memory.seen() == []


def test_what_is_seen_past_is_dropped():
    memory = _Memory()
    memory.look(_post(500), 2)
    memory.look(_post(900, 900), 14)
    for x, y in memory.seen():
        assert x * x + y * y > 800 * 800


def test_what_is_behind_something_nearer_is_kept():
    memory = _Memory()
    memory.look(_post(900), 2)
    memory.look(_post(500), 3)
    assert [point for point in memory.seen() if point[1] > 850]


def test_the_tip_of_a_corner_does_not_drown_in_the_mean():
    memory = _Memory()
    for k in range(40):
        memory.look(_post(503 if k % 2 else 515))
    nearest = min([y for x, y in memory.seen() if abs(x) < 15])
    assert nearest < 508, memory.seen()


def test_a_cell_has_one_slot():
    memory = _Memory()
    memory.look(lambda bearing: 700 + (bearing * 7 % 50) * 4, 6)
    cells = {}
    for x, y in memory.seen():
        cell = (x % 8192 // 20, y % 8192 // 20)
        cells[cell] = cells.get(cell, 0) + 1
    again = sum(cells.values()) - len(cells)
    assert 20 * again < len(cells), (again, len(cells))


def test_a_mirrored_lidar_sees_past_things_too():
    memory = _Memory()

    def look(of, turns):
        for _ in range(turns):
            for frame in range(FRAMES):
                memory.sight.look(frame, of)
                sight = memory.sight
                for values in (sight.bearings, sight.distances):
                    for i in range(sight.n // 2):
                        values[i], values[sight.n - 1 - i] = values[sight.n - 1 - i], values[i]
                memory.points.frame(sight, memory.odometry)

    look(_post(500), 2)
    assert memory.seen()
    look(lambda bearing: 900 if bearing < 200 or bearing > 3400 else 0, 16)  # those at the edge of a frame need a dozen turns
    for x, y in memory.seen():
        assert x * x + y * y > 800 * 800


def test_ages_go_on_past_the_wraps_of_ticks():
    for wrap in (2**29, 2**30):
        memory = _Memory()
        memory.sight.frame_us = (wrap - 1_000_000) % 2**30
        memory.look(_post(500), 6)
        assert memory.seen()
        memory.look(_post(900, 900), 14)  # two seconds: past the wrap
        for x, y in memory.seen():
            assert x * x + y * y > 800 * 800, wrap


def _wall(distance):
    """Over the width of a frame, at whose edges points are kept longer."""
    return lambda bearing: distance if 5 < bearing < 220 else 0


def _at_500(memory):
    return len([1 for x, y in memory.seen() if 70 < x < 120 and x * x + y * y < 512 * 512])


def test_what_was_kept_for_long_is_not_young_again():
    for turns in range(2, 64):
        memory = _Memory()
        memory.look(_wall(500), 2)
        memory.look(_post(0), turns)  # without an echo; meanwhile the byte of the ages comes round twice
        assert _at_500(memory), turns
        memory.look(_wall(530))  # a surface beside: what is older than one and a half turns is not there any more
        assert _at_500(memory) == 0, turns


def test_frames_that_were_missed_make_points_older_as_well():
    for missed in (0, FRAMES):
        memory = _Memory()
        memory.look(_wall(500), 2)
        memory.sight.frame_us += missed * FRAME_US
        memory.look(_wall(530))
        assert (_at_500(memory) == 0) == (missed > 0), missed


def test_a_full_memory_takes_in_what_is_seen_now():
    memory = _Memory()
    # People all round, farther off each time, so that nothing disproves those before; nothing returns from beyond.
    most = 0
    for turn in range(30):
        memory.look(lambda bearing, turn=turn: 700 - 15 * turn if (bearing // 45 + turn) % 3 else 0)
        most = max(most, memory.points.count)
    assert most > 300, most
    memory.look(_post(450), 2)
    found = [(x, y) for x, y in memory.seen() if abs(x) < 60 and 440 < y < 460]
    assert len(found) >= 3, found


def test_what_nothing_returns_from_any_more_is_gone_where_most_returns():
    for returned, gone in ((1000, True), (0, False)):
        memory = _Memory()
        memory.look(lambda bearing: 500, 2)
        memory.sight.returned = returned
        memory.look(lambda bearing: 0, 20)
        left = len(memory.seen())  # some lie between the last beam of a frame and the first of the next
        assert left <= 3 if gone else left > 40, (returned, left)


def test_what_lies_in_the_blind_disc_is_not_gone_for_want_of_returns():
    memory = _Memory()
    memory.look(lambda bearing: 260 if 850 < bearing < 950 else 0, 2)
    before = len(memory.seen())
    memory.odometry.x += 100 * 256  # now it is 160 mm off
    memory.sight.returned = 1000
    memory.look(lambda bearing: 0, 20)
    assert before and len(memory.seen()) >= before - 1
