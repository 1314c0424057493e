"""The tables of candidates.py for straight and crab candidates. Loaded to fill them, then let go."""

from math import cos, pi, sin

from micropython import const

_BIAS = const(8192)
_LENGTHS = const(5)
_STRIDE = const(8)


def fill(draft):
    """strips (what collision.py reads of each) and ends of the straight and crab candidates of a candidate_set.Draft."""
    for k in range(draft.count - draft.arcs):
        _fill_strip(draft, k)
        for i in range(_LENGTHS):
            x, y, _ = end(draft, draft.arcs + k, draft.lengths[i])
            t = ((draft.arcs + k) * _LENGTHS + i) * 2
            draft.ends[t] = round(x) + _BIAS
            draft.ends[t + 1] = round(y) + _BIAS


def _fill_strip(draft, k):
    a = draft.af[draft.arcs + k] * pi / 1800
    s = sin(a)
    c = cos(a)
    hw = draft.half_width + draft.margin
    hl = draft.half_length + draft.margin
    b = k * _STRIDE
    t = draft.strips
    t[b] = round(s * 16384)
    t[b + 1] = round(c * 16384)
    t[b + 2] = int((hw * c + hl * s) * 16)
    t[b + 3] = int(((draft.half_width + draft.soft) * c + (draft.half_length + draft.soft) * s) * 16)
    t[b + 4] = int((hw * c - hl * s) * 16) + 131072
    t[b + 5] = int((hw * s + hl * c) * 16)
    t[b + 6] = min(int(s / c * 1024), 60000) if c > 0.01 else 60000
    t[b + 7] = min(int(c / s * 1024), 60000) if s > 0.01 else 60000


def end(draft, k, length):
    """Pose (x, y mm, clockwise turn in rad) of the body centre after `length` mm of travel on candidate k, a strip."""
    a = draft.af[k] * pi / 1800
    return length * sin(a), length * cos(a), 0.0
