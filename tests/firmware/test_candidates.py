"""The envelope tables against a body moved in small steps."""

import sys
from array import array
from math import cos, sin

from params.config import Config
from planner import candidate_arcs, candidate_strips
from planner.candidates import BIAS, Candidates
from planner.collision import BAND_MM, CollisionCheck, sort_near

_config = Config()
_env = Candidates(_config)


def _random(seed):
    while True:
        seed = (seed * 1103515245 + 12345) & 0x7FFFFFFF
        yield (seed >> 8) / 8388608.0


def _sweep(points, env=_env):
    """Free length of every candidate; also the blocking point."""
    n = len(points)
    px = array("H", [p[0] + BIAS for p in points])
    py = array("H", [p[1] + BIAS for p in points])
    near = sort_near(px, py, n, env.half_width, env.half_length, env.soft + BAND_MM)
    free = array("H", bytes(2 * env.count))
    soft = array("H", bytes(2 * env.count))
    block = array("H", bytes(2 * env.count))
    CollisionCheck(env).run(px, py, n, near, 0, env.count, 1, 0, free, soft, block)
    return free, soft, block


def _stepped(env, k, point, margin, step=2.0):
    """Travel until the outline with a margin covers the point, by moving the body in small steps."""
    hw = env.half_width + margin
    hl = env.half_length + margin
    length = 0.0
    while length < env.look_ahead:
        x, y, turn = (candidate_arcs if k < env.arcs else candidate_strips).end(env, k, length)
        dx = point[0] - x
        dy = point[1] - y
        u = dx * cos(turn) - dy * sin(turn)
        v = dx * sin(turn) + dy * cos(turn)
        if -hw < u < hw and -hl < v < hl:
            return length
        length += step
    return env.look_ahead


def test_no_point_comes_deeper_than_3_mm_into_the_margin():
    r = _random(7)
    compared = 0
    while compared < 60:
        x = int((next(r) - 0.5) * 1400)
        y = int((next(r) - 0.5) * 1800)
        # clear of the band in which the nearer-point rule takes over
        if abs(x) < _env.half_width + _env.margin + 14 and abs(y) < _env.half_length + _env.margin + 14:
            continue
        free, soft, block = _sweep([(x, y)])
        for k in range(int(next(r) * 5), _env.count, 5):
            want = _stepped(_env, k, (x, y), _env.margin - 3)
            assert free[k] <= want + 14, (k, _env.af[k], _env.ar[k], (x, y), want, free[k])
        compared += 1


def test_early_stops_are_rare():
    r = _random(11)
    early = 0
    total = 0
    for _ in range(60):
        x = int((next(r) - 0.5) * 1400)
        y = int((next(r) - 0.5) * 1800)
        if abs(x) < _env.half_width + _env.margin + 14 and abs(y) < _env.half_length + _env.margin + 14:
            continue
        free, soft, block = _sweep([(x, y)])
        for k in range(int(next(r) * 5), _env.count, 5):
            want = _stepped(_env, k, (x, y), _env.margin + 1)
            total += 1
            if want - free[k] > 20:
                early += 1
    assert early * 50 < total, (early, total)


_OTHERS = ((0, 0, 100), (20, 35, 900), (100, 200, 3000), (9, 30, 900))  # margin, soft margin, look-ahead


def _tuned(config, margin, soft, look_ahead):
    config.set("avoid.margin", 0)
    config.set("avoid.soft_margin", soft)
    config.set("avoid.margin", margin)
    config.set("windows.look_ahead", look_ahead)


def _arrays(env):
    """Every array by its name."""
    return {name: value for name, value in env.__dict__.items() if type(value) in (array, bytearray)}


def _check_same(one, other):
    for name, value in one.__dict__.items():
        if name != "seconds":
            assert value == getattr(other, name), name
    # Of the second entries those that a candidate refers to.
    for k in range(one.arcs):
        second = one.consts[k * 13 + 11]
        first = second >> 10
        last = first + 2 * (second & 31)
        assert one.seconds[first:last] == other.seconds[first:last], k


def test_refilled_tables_are_those_of_a_fresh_start():
    for mode in ("AWS", "NAWS"):
        config = Config({"mode": mode})
        env = Candidates(config)
        before = _arrays(env)
        assert len(before) == 9 and not env.outdated(config)
        for values in _OTHERS:
            _tuned(config, *values)
            assert env.outdated(config)
            env.refill(config)
            assert not env.outdated(config)
            _check_same(env, Candidates(config))
            for name, value in _arrays(env).items():
                assert value is before[name] and len(value) == len(getattr(Candidates(config), name)), name


def test_without_memory_the_old_tables_stay_whole():
    config = Config()
    env = Candidates(config)
    _tuned(config, 20, 35, 900)
    original = candidate_strips.fill
    candidate_strips.fill = _fail_once(original)
    sys.modules["planner.candidate_strips"] = candidate_strips
    try:
        env.refill(config)
        assert False, "refilled"
    except MemoryError:
        pass
    finally:
        candidate_strips.fill = original
    assert (env.margin, env.soft, env.look_ahead) == (9, 30, 900) and env.outdated(config)
    _check_same(env, Candidates(Config()))


def _fail_once(fill):
    """As fill, but the first time there is no memory; what comes after that is another copy of the module."""
    failed = []

    def call(*arguments):
        if not failed:
            failed.append(True)
            raise MemoryError("memory allocation failed")
        return fill(*arguments)

    return call


def test_the_code_that_fills_the_tables_is_let_go():
    Candidates(Config())
    if sys.implementation.name == "micropython":
        assert not [
            name for name in sys.modules if name in ("planner.candidate_set", "planner.candidate_arcs", "planner.candidate_rings", "planner.candidate_strips")
        ]
