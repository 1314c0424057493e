"""field_nose.py: to which side the half turn of orientations leans, and where it ends."""

from array import array

from planner.heading_branch import lean, tell

_CLOSED = 32767


def _costs(slope_x, slope_y, closed=()):
    """Costs that fall evenly across the grid, the same for every orientation; closed orientations."""
    cost = array("H", bytes(2 * 10800))
    for t in range(12):
        for y in range(30):
            for x in range(30):
                cost[(t * 30 + y) * 30 + x] = _CLOSED if t in closed else 9000 - slope_x * x - slope_y * y
    return cost


def test_it_leans_by_half_the_bearing_of_the_way_out():
    assert lean(_costs(0, 9), 15, 15, 0) == 0
    assert lean(_costs(-9, 0), 15, 15, 0) == -3
    # The way out is at a bearing of 90 degrees, ahead, at -90 and behind.
    costs = _costs(9, 0)
    assert [lean(costs, 15, 15, heading) for heading in (0, 900, 1800, 2700)] == [3, 0, -3, 0]
    assert lean(_costs(0, -9), 15, 15, 0) == 0  # behind


def test_no_way_out_no_lean():
    assert lean(_costs(9, 0, closed=(0,)), 15, 15, 0) == 0
    assert lean(_costs(0, 0), 15, 15, 0) == 0
    assert lean(_costs(9, 0), 1, 15, 0) == 0 and lean(_costs(9, 0), 15, 29, 0) == 0


def test_the_orientation_at_the_end_is_closed():
    state = array("i", [0, 0, 0, 0])
    closed = array("i", [0] * 360)
    tell(0, 0, state, closed)
    assert [row // 30 for row in range(360) if closed[row]] == [6] * 30
    # 105 to 165 degrees are the noses at -75 to -15
    assert state[3] == sum(1 << t for t in range(7, 12))

    closed = array("i", [0] * 360)
    tell(0, 3, state, closed)
    # -30..120 degrees: closed at 135, which is -45; the nose at 120 is ahead, those from 150 on are -30 and -15
    assert [row // 30 for row in range(360) if closed[row]] == [9] * 30
    assert state[3] == (1 << 10) | (1 << 11)
