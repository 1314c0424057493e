"""envelope.py: a candidate in its four variants. pairs.py: first moves and the lengths tried of them."""

from array import array

from params.config import Config
from planner.candidates import LENGTHS, Candidates
from planner.collision import CollisionCheck
from planner.cost_to_go import CostToGo
from planner.move_cost import NOTHING, MoveCost
from planner.two_step import TwoStep

_config = Config()
_env = Candidates(_config)


def test_travel_agrees_with_the_table_of_ends():
    for k in range(_env.count):
        for i in range(LENGTHS):
            at = LENGTHS * k + i
            _env.travel(0, k, _env.lengths[i])
            assert abs(_env.end_x - (_env.ends[2 * at] - 8192)) <= 1 and abs(_env.end_y - (_env.ends[2 * at + 1] - 8192)) <= 1, (k, i)
            assert abs(_env.end_turn - _env.turns[at]) <= 1, (k, i)


def test_variants_are_mirrors():
    for k in range(0, _env.count, 3):
        _env.travel(0, k, 300)
        x, y, turn = _env.end_x, _env.end_y, _env.end_turn
        for variant, flip_x, flip_y in ((1, -1, 1), (2, 1, -1), (3, -1, -1)):
            _env.travel(variant, k, 300)
            assert (_env.end_x, _env.end_y, _env.end_turn) == (flip_x * x, flip_y * y, flip_x * flip_y * turn), (k, variant)
        af, ar = _env.af_of(0, k), _env.ar_of(0, k)
        assert (_env.af_of(1, k), _env.ar_of(1, k)) == (-af, -ar)
        # Driven backward the other end leads; seen from there a wheel turned left points right.
        assert (_env.af_of(2, k), _env.ar_of(2, k)) == (-ar, -af)
        assert (_env.af_of(3, k), _env.ar_of(3, k)) == (ar, af)


def _pairs():
    worth = MoveCost(_config, CostToGo(_config), _env)
    pairs = TwoStep(_env, worth, CollisionCheck(_env), *(array("H", bytes(2 * _env.count)) for _ in range(2)))
    scores = []
    for _ in range(4):
        scores.append([NOTHING] * (LENGTHS * _env.count))
    return pairs, scores


def test_first_moves_come_best_first_and_end_apart():
    from array import array

    pairs, scores = _pairs()
    straight = _env.arcs
    scores[0][LENGTHS * straight + 3] = 700
    scores[0][LENGTHS * straight + 4] = 650
    scores[0][LENGTHS * (straight + 1) + 4] = 660  # ends beside the one before
    scores[3][LENGTHS * 2 + 1] = 500
    scores = [array("H", one) for one in scores]
    while not pairs.pick(scores):
        pass
    found = [(pairs.variant[n], pairs.candidate[n], pairs.length[n]) for n in range(pairs.count)]
    assert found[0] == (3, 2, _env.lengths[1])
    assert found[1] == (0, straight, _env.lengths[4])
    assert (0, straight, _env.lengths[3]) in found
    assert not pairs.found
