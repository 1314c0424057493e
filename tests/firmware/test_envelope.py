"""The envelope tables against a body moved in small steps."""

import sys
from array import array
from math import cos, sin

import envelope_arcs
import envelope_strips
from config import Config
from envelope import BIAS, Envelopes
from sweep import BAND_MM, Sweep, sort_near

_config = Config()
_env = Envelopes(_config)


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
    Sweep(env).run(px, py, n, near, 0, env.count, 1, 0, free, soft, block)
    return free, soft, block


def _stepped(env, k, point, margin, step=2.0):
    """Travel until the outline with a margin covers the point, by moving the body in small steps."""
    hw = env.half_width + margin
    hl = env.half_length + margin
    length = 0.0
    while length < env.look_ahead:
        x, y, turn = (envelope_arcs if k < env.arcs else envelope_strips).end(env, k, length)
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


_OTHERS = ((0, 0, 100), (20, 35, 900), (100, 200, 3000), (9, 30, 700))  # margin, soft margin, look-ahead


def _tuned(config, margin, soft, look_ahead):
    config.set("avoid.margin", 0)
    config.set("avoid.soft_margin", soft)
    config.set("avoid.margin", margin)
    config.set("windows.look_ahead", look_ahead)


def _fixed(env):
    """Every array whose size does not change, by its name."""
    return {name: value for name, value in env.__dict__.items() if type(value) in (array, bytearray) and name != "seconds"}


def _same(one, other):
    for name, value in one.__dict__.items():
        assert name in ("seconds",) or value == getattr(other, name), name
    # Beyond what is used, which the shorter of the two has, lies nothing that counts.
    used = min(len(one.seconds), len(other.seconds))
    assert one.seconds[:used] == other.seconds[:used]


def test_refilled_tables_are_those_of_a_fresh_start():
    for mode in ("AWS", "NAWS"):
        config = Config({"mode": mode})
        env = Envelopes(config)
        before = _fixed(env)
        assert len(before) == 8 and not env.outdated(config)
        for values in _OTHERS:
            _tuned(config, *values)
            assert env.outdated(config)
            env.refill(config)
            assert not env.outdated(config)
            _same(env, Envelopes(config))
            for name, value in _fixed(env).items():
                assert value is before[name], name


class _Short:
    """Stands for the list of second entries in a heap that is too small for it."""

    def __len__(self):
        return 0

    def append(self, value):
        raise MemoryError("memory allocation failed")


def test_without_memory_the_old_tables_stay_whole():
    import envelope

    config = Config()
    env = Envelopes(config)
    seconds = env.seconds
    _tuned(config, 20, 35, 900)
    envelope.array = lambda kind: _Short()
    try:
        env.refill(config)
        assert False, "refilled"
    except MemoryError:
        pass
    finally:
        envelope.array = array
    assert (env.margin, env.soft, env.look_ahead) == (9, 30, 700) and env.outdated(config)
    assert env.seconds is seconds
    _same(env, Envelopes(Config()))


def test_the_code_that_fills_the_tables_is_let_go():
    Envelopes(Config())
    if sys.implementation.name == "micropython":
        assert not [name for name in sys.modules if name in ("envelope_tables", "envelope_arcs", "envelope_strips")]
