"""The tables of envelope.py for straight and crab candidates. Loaded to fill them, then let go."""

from math import cos, pi, sin

from micropython import const

_BIAS = const(8192)
_LENGTHS = const(5)
_STRIDE = const(8)


def fill(env, margin, soft, look_ahead):
    """strips: what of each strip sweep.py reads; ends, turns for the lengths of `env`. margin, soft: mm."""
    for k in range(env.count - env.arcs):
        _fill_strip(env, k, margin, soft)
        for i in range(_LENGTHS):
            x, y, _ = end(env, env.arcs + k, env.lengths[i])
            t = ((env.arcs + k) * _LENGTHS + i) * 2
            env.ends[t] = round(x) + _BIAS
            env.ends[t + 1] = round(y) + _BIAS
            env.turns[t >> 1] = 0


def _fill_strip(env, k, margin, soft):
    a = env.af[env.arcs + k] * pi / 1800
    s = sin(a)
    c = cos(a)
    hw = env.half_width + margin
    hl = env.half_length + margin
    b = k * _STRIDE
    t = env.strips
    t[b] = round(s * 16384)
    t[b + 1] = round(c * 16384)
    t[b + 2] = int((hw * c + hl * s) * 16)
    t[b + 3] = int(((env.half_width + soft) * c + (env.half_length + soft) * s) * 16)
    t[b + 4] = int((hw * c - hl * s) * 16) + 131072
    t[b + 5] = int((hw * s + hl * c) * 16)
    t[b + 6] = min(int(s / c * 1024), 60000) if c > 0.01 else 60000
    t[b + 7] = min(int(c / s * 1024), 60000) if s > 0.01 else 60000


def end(env, k, length):
    """Pose (x, y mm, clockwise turn in rad) of the body centre after `length` mm of travel on candidate k, a strip."""
    a = env.af[k] * pi / 1800
    return length * sin(a), length * cos(a), 0.0
