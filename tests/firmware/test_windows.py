"""windows.py: every window and every zone."""

from array import array

from params.config import Config
from perception.windows import BLUE, GREEN, NONE, RED, YELLOW, Windows

# red 20 mm, blue 45 mm round a body of 250 x 600 mm; the planning window is 900 mm long and 300 mm wide beside the body
_windows = Windows(Config(), 16)


def _sort(*points):
    """(most urgent window, window of each point)."""
    x = array("H", [p[0] + 8192 for p in points])
    y = array("H", [p[1] + 8192 for p in points])
    urgent = _windows.sort(x, y, len(points))
    found = {(x[i] - 8192, y[i] - 8192): _windows.window[i] for i in range(len(points))}
    return urgent, [found[p] for p in points]


def test_a_point_in_each_window():
    for y, window in ((290, GREEN), (310, RED), (330, BLUE), (1100, YELLOW), (1300, NONE)):
        assert _sort((0, y))[1] == [window], y
        assert _sort((0, -y))[1] == [window], -y
    for x, window in ((0, GREEN), (140, RED), (160, BLUE), (400, YELLOW), (500, NONE)):
        assert _sort((x, 0))[1] == [window] and _sort((-x, 0))[1] == [window], x


def test_the_most_urgent_window_counts():
    assert _sort((0, 900), (160, 0), (0, 1500)) == (BLUE, [YELLOW, BLUE, NONE])
    assert _sort((0, 900), (140, 0), (0, 330)) == (RED, [YELLOW, RED, BLUE])


def test_ten_zones_clockwise():
    around = ((0, 330), (155, 330), (155, 100), (155, -100), (155, -330), (0, -330), (-155, -330), (-155, -100), (-155, 100), (-155, 330))
    for zone, point in enumerate(around):
        assert _sort(point)[0] == BLUE
        assert _windows.zone() == zone, point


def test_points_at_the_outline_come_first():
    # soft margin and 12 mm more, of each side of the body
    band = Config().avoid_soft_margin + 12
    points = ((0, 900), (125 + band - 1, 0), (125 + band, 0), (0, -300 - band + 1), (-126, 301))
    for classify in (True, False):
        x = array("H", [p[0] + 8192 for p in points])
        y = array("H", [p[1] + 8192 for p in points])
        if classify:
            _windows.sort(x, y, len(points))
            near = _windows.near
        else:
            _windows.window[0] = 77
            near = _windows.sort_near(x, y, len(points))
            assert _windows.window[0] == 77
        assert near == 3
        assert sorted((x[i] - 8192, y[i] - 8192) for i in range(3)) == sorted((points[1], points[3], points[4]))
