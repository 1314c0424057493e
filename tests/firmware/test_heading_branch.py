"""heading_branch.py: to which side the half turn of orientations leans, and where it ends."""

from array import array

from planner.heading_branch import apply, choose

_CLOSED = 255


def _costs(slope_x, slope_y, closed=()):
    """Costs that fall evenly across the grid, the same for every orientation; closed orientations."""
    cost = bytearray(8112)
    for t in range(12):
        for y in range(26):
            for x in range(26):
                cost[(t * 26 + y) * 26 + x] = _CLOSED if t in closed else 120 - slope_x * (x - 13) - slope_y * (y - 13)
    return cost


def test_it_leans_by_half_the_bearing_of_the_way_out():
    assert choose(_costs(0, 4), 13, 13, 0) == 0
    assert choose(_costs(-4, 0), 13, 13, 0) == -3
    # The way out is at a bearing of 90 degrees, ahead, at -90 and behind.
    costs = _costs(4, 0)
    assert [choose(costs, 13, 13, heading) for heading in (0, 900, 1800, 2700)] == [3, 0, -3, 0]
    assert choose(_costs(0, -4), 13, 13, 0) == 0  # behind


def test_no_way_out_no_choose():
    assert choose(_costs(4, 0, closed=(0,)), 13, 13, 0) == 0
    assert choose(_costs(0, 0), 13, 13, 0) == 0
    assert choose(_costs(4, 0), 1, 13, 0) == 0 and choose(_costs(4, 0), 13, 25, 0) == 0


def test_the_orientation_at_the_end_is_closed():
    closed = array("H", bytes(4 * 312))
    sense = apply(0, 0, closed)
    assert [row // 52 for row in range(624) if closed[row]] == [6] * 52
    # 105 to 165 degrees are the noses at -75 to -15
    assert sense == sum(1 << t for t in range(7, 12))

    closed = array("H", bytes(4 * 312))
    sense = apply(0, 3, closed)
    # -30..120 degrees: closed at 135, which is -45; the nose at 120 is ahead, those from 150 on are -30 and -15
    assert [row // 52 for row in range(624) if closed[row]] == [9] * 52
    assert sense == (1 << 10) | (1 << 11)
