"""avoid.py: what is decided for points one puts there."""

from rooms import Still

from avoid import Avoid
from params.config import Config
from planner import reasons
from planner.candidates import LENGTHS
from planner.decision import CHOOSE
from planner.move_cost import NOTHING, best

_config = Config()


def _walls(*walls):
    found = []
    for x0, y0, x1, y1 in walls:
        count = max(abs(x1 - x0), abs(y1 - y0)) // 25
        for k in range(count + 1):
            found.append((x0 + (x1 - x0) * k // count, y0 + (y1 - y0) * k // count))
    return found


def _until(points, over, why=reasons.WAITING, config=_config, slice_us=1000):
    """The Avoid of a robot that stands, worked on until over(avoid, whether it has decided).

    why: what it decided before; slice_us: time from slice to slice.
    """
    avoid = Avoid(config)
    memory = avoid.map
    for k, (x, y) in enumerate(points):
        memory.x[k] = 8 * x & 0xFFFF
        memory.y[k] = 8 * y & 0xFFFF
    memory.state[0] = len(points)
    avoid.ways.frames = 100
    avoid.plan.why = why
    odometry = Still()
    slices = 0
    while not over(avoid, avoid.step(odometry)):
        odometry.now_us += slice_us
        slices += 1
        assert slices < 200
    return avoid


def _decision(points):
    """The Avoid after its first decision."""
    return _until(points, lambda avoid, decided: decided)


def test_a_free_corridor_is_driven_straight():
    avoid = _decision(_walls((-350, -800, -350, 1000), (350, -800, 350, 1000)))
    assert (avoid.af, avoid.ar) == (0, 0) and avoid.v > 100 and avoid.why == reasons.ON
    assert avoid.free == _config.windows_look_ahead


def test_a_slow_chip_decides_as_well():
    avoid = _until(_walls((-350, -800, -350, 1000), (350, -800, 350, 1000)), lambda avoid, decided: decided, slice_us=100_000)
    assert avoid.why == reasons.ON


_OPEN_ON_THE_RIGHT = ((-250, -800, -250, 460), (-250, 460, 900, 460), (250, -800, 250, -80), (250, -80, 900, -80))


def test_wall_ahead_and_open_on_the_right():
    avoid = _decision(_walls(*_OPEN_ON_THE_RIGHT))
    # Clockwise into the opening, or backing anticlockwise to line up for it.
    turn = avoid.af - avoid.ar
    assert (avoid.v > 90 and turn > 0) or (avoid.v < 90 and turn < 0), (avoid.af, avoid.ar, avoid.v)


def test_mirrored_points_give_the_mirrored_decision():
    # A single move, a pair of moves, a way back; no wall on the edge of a cell of the grid, which belongs to one of its sides only.
    for width, ahead, corner in ((222, 498, -187), (302, 468, -203), (302, 367, -187)):
        points = _walls((-width, -803, -width, ahead), (-width, ahead, 903, ahead), (width, -803, width, corner), (width, corner, 903, corner))
        right = _decision(points)
        left = _decision([(-x, y) for x, y in points])
        assert (left.af, left.ar, left.v, left.why) == (-right.af, -right.ar, right.v, right.why), (width, ahead, corner)


def test_the_best_of_those_checked_is_the_best_of_all():
    spared = 0
    for width, ahead, corner in ((350, 1000, 900), (222, 498, -187), (302, 468, -203), (302, 700, 100), (400, 560, -100)):
        avoid = _until(
            _walls((-width, -803, -width, ahead), (-width, ahead, 903, ahead), (width, -803, width, corner), (width, corner, 903, corner)),
            lambda avoid, decided: avoid.decision.stage == CHOOSE,
            reasons.ON,
        )
        decision = avoid.decision
        found = [_least(scores) for scores in decision.scores[:2]]
        spared += decision.move_cost.checked.count(b"\0")
        for side in (0, 1):
            while not decision.check_some(side):  # all of them
                pass
        assert min(found) == min([_least(scores) for scores in decision.scores[:2]]), (width, ahead, corner, found)
    assert spared > 2 * avoid.candidates.count  # of five sides of candidates


def test_what_is_for_driving_backward_never_seems_free_ahead():
    config = Config({"mode": "NAWS"})
    closed = _walls((-187, -433, -187, 433), (187, -433, 187, 433), (-187, 433, 187, 433), (-187, -433, 187, -433))
    for points in (_walls(*_OPEN_ON_THE_RIGHT), closed):
        avoid = _until(points, lambda avoid, decided: decided, reasons.ON, config)
        env = avoid.candidates
        assert env.ahead_end < env.arcs and not avoid.decision.longest((0, 1), 65534)
        for side in (0, 1):
            assert not any(avoid.free_of[side][k] for k in range(env.ahead_end, env.arcs))
        assert avoid.ar == 0


def _least(scores):
    number = best(scores, 0, len(scores) // LENGTHS, 1)
    return (scores[number] if number != NOTHING else NOTHING), number


def test_closed_all_round_it_stands():
    avoid = _decision(_walls((-127, -302, -127, 302), (127, -302, 127, 302), (-127, 302, 127, 302), (-127, -302, 127, -302)))
    assert avoid.v == 90, (avoid.af, avoid.ar, avoid.v)


def test_checking_two_candidates_parts_points_and_windows():
    """The check puts what stopped one candidate before the others: from then on windows.window does not go with the points."""
    avoid = _decision(_walls((-350, -800, -350, 1000), (350, -800, 350, 1000)))
    ways = avoid.ways
    ways.see(Still())
    assert ways.ordered
    ways.check(0, 4, 5, 0)
    assert ways.ordered
    ways.check(0, 4, 6, 0)
    assert not ways.ordered
