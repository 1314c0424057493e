"""candidates.py: a candidate in its four mirrorings. two_step.py: first moves and the lengths tried of them."""

from avoid import Avoid
from params.config import Config
from planner.candidates import LENGTHS, Candidates
from planner.cost_grid import fill
from planner.move_cost import NOTHING

_config = Config()
_env = Candidates(_config)


def test_travel_agrees_with_the_table_of_ends():
    for k in range(_env.count):
        for i in range(LENGTHS):
            at = LENGTHS * k + i
            _env.travel(0, k, _env.lengths[i])
            assert abs(_env.end_x - (_env.ends[2 * at] - 8192)) <= 1 and abs(_env.end_y - (_env.ends[2 * at + 1] - 8192)) <= 1, (k, i)
            assert abs(_env.end_turn - (_env.turns[k] * _env.lengths[i] + 8192 >> 14)) <= 1, (k, i)


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
    pairs = Avoid(_config).decision.two_step
    pairs.begin(0)
    for scores in pairs.scores:
        fill(scores, LENGTHS * _env.count, NOTHING)
    return pairs, pairs.scores


def test_first_moves_come_best_first_and_end_apart():
    pairs, scores = _pairs()
    straight = _env.arcs
    scores[0][LENGTHS * straight + 3] = 700
    scores[0][LENGTHS * straight + 4] = 650
    scores[3][LENGTHS * 2 + 1] = 500
    scores[3][LENGTHS * 3 + 1] = 510  # ends beside the one before
    while not pairs.choose_first():
        pass
    found = [(pairs.mirroring[n], pairs.candidate[n], pairs.length[n]) for n in range(pairs.count)]
    assert found == [(3, 2, _env.lengths[1]), (0, straight, _env.lengths[4]), (0, straight, _env.lengths[3])]
    assert not pairs.found
