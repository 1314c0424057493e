"""The candidates' tables against a body moved in small steps."""

from array import array
from math import cos, sin

from params.config import Config
from perception.windows import Windows
from planner.candidate_tables import Draft, end
from planner.candidates import BIAS, Candidates
from planner.collision import CollisionCheck

_config = Config()
_env = Candidates(_config)
_windows = Windows(_config, 400)
_draft = Draft(_config)


def _random(seed):
    while True:
        seed = (seed * 1103515245 + 12345) & 0x7FFFFFFF
        yield (seed >> 8) / 8388608.0


def _sweep(points, env=_env):
    """Free length of every candidate; also the blocking point."""
    n = len(points)
    px = array("H", [p[0] + BIAS for p in points])
    py = array("H", [p[1] + BIAS for p in points])
    near = _windows.sort_near(px, py, n)
    free = array("H", bytes(2 * env.count))
    soft = array("H", bytes(2 * env.count))
    block = array("H", bytes(2 * env.count))
    check = CollisionCheck(env)
    check.prepare(n, near, 1, 0)
    check.check(px, py, 0, env.count, free, soft, block)
    return free, soft, block


def _stepped(env, k, point, margin, step=2.0):
    """Travel until the outline with a margin covers the point, by moving the body in small steps."""
    hw = env.half_width + margin
    hl = env.half_length + margin
    length = 0.0
    while length < env.look_ahead:
        x, y, turn = end(_draft, k, length)
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
