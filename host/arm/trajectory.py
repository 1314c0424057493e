"""From genes to motion: a polynomial of 4th degree to each node but the end, and of 5th degree to the end.

Genes of one trajectory through m nodes, n joints: m times (n angles, n speeds), then m + 1 times of the segments. At rest at both ends; position, speed and acceleration
are continuous. With one node these are the paper's eight (q_m, q'_m, t1, t2) for three joints; it names no polynomials, 4th then 5th degree is usual.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np


@dataclass(frozen=True)
class Motion:
    """Sampled trajectories: angles, speeds, accelerations (P, n, T) in rad, rad/s, rad/s2; times (P, T) and total (P,) in s; segments (P, m + 1) s."""

    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    times: np.ndarray
    total: np.ndarray
    segments: np.ndarray


def split(genes, joints: int):
    """(angles, speeds, times): (P, m, n), (P, m, n), (P, m + 1) of genes (P, 2 m n + m + 1)."""
    nodes = (genes.shape[1] - 1) // (2 * joints + 1)
    inner = genes[:, : 2 * nodes * joints].reshape(len(genes), nodes, 2, joints)
    return inner[:, :, 0], inner[:, :, 1], genes[:, 2 * nodes * joints :]


def coefficients(genes, start, end):
    """[(P, n, 6)] a segment: of 1, s .. s**5, where s = t/T goes from 0 to 1; and the times (P, m + 1)."""
    angles, speeds, times = split(genes, len(start))
    position = np.broadcast_to(start, angles[:, 0].shape)
    speed = acceleration = np.zeros_like(position)
    found = []
    for k in range(angles.shape[1] + 1):
        span = times[:, k, None]
        c = np.zeros((*position.shape, 6))
        c[..., 0], c[..., 1], c[..., 2] = position, speed * span, acceleration * span * span / 2
        if k < angles.shape[1]:
            position, speed = angles[:, k], speeds[:, k]
            left = position - c[..., 0] - c[..., 1] - c[..., 2]
            change = speed * span - c[..., 1] - 2 * c[..., 2]
            c[..., 3], c[..., 4] = 4 * left - change, change - 3 * left
            acceleration = (2 * c[..., 2] + 6 * c[..., 3] + 12 * c[..., 4]) / (span * span)
        else:
            left, v, a = end - position, c[..., 1], 2 * c[..., 2]
            c[..., 3] = 10 * left - 6 * v - 1.5 * a
            c[..., 4] = -15 * left + 8 * v + 1.5 * a
            c[..., 5] = 6 * left - 3 * v - 0.5 * a
        found.append(c)
    return found, times


@lru_cache(maxsize=16)
def _bases(intervals: int):
    """Powers of s at 0, 1/N .. 1 and their derivatives, (6, N + 1) each."""
    s = np.linspace(0, 1, intervals + 1)
    k = np.arange(6)[:, None]
    first = k * s ** np.maximum(k - 1, 0)
    second = k * (k - 1) * s ** np.maximum(k - 2, 0)
    return s, s**k, first, second


def sample(genes, start, end, intervals: int) -> Motion:
    """The Motion of genes (P, ..) at `intervals` + 1 places of each segment; a node counts once."""
    parts, spans = coefficients(np.atleast_2d(genes), np.asarray(start, float), np.asarray(end, float))
    s, powers, first, second = _bases(intervals)
    q, qd, qdd, times = [], [], [], []
    began = np.zeros(len(spans))
    for k, c in enumerate(parts):
        skip = 1 if k else 0
        span = spans[:, k, None]
        q.append(c @ powers[:, skip:])
        qd.append(c @ first[:, skip:] / span[..., None])
        qdd.append(c @ second[:, skip:] / (span * span)[..., None])
        times.append(began[:, None] + span * s[skip:])
        began = began + spans[:, k]
    whole = [np.concatenate(part, axis=-1) for part in (q, qd, qdd, times)]
    return Motion(whole[0], whole[1], whole[2], whole[3], began, spans)


def at(genes, start, end, when) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(q, q', q''), (T, n) each, of one trajectory at the times `when` (T,), s."""
    parts, spans = coefficients(np.atleast_2d(genes), np.asarray(start, float), np.asarray(end, float))
    ends = np.cumsum(spans[0])
    segment = np.minimum(np.searchsorted(ends, when, side="right"), len(parts) - 1)
    c = np.stack([part[0] for part in parts])[segment]  # (T, n, 6)
    span = spans[0][segment][:, None]
    s = np.clip((when - (ends - spans[0])[segment]) / span[:, 0], 0, 1)[:, None]
    k = np.arange(6)
    powers = s**k
    first = k * s ** np.maximum(k - 1, 0)
    second = k * (k - 1) * s ** np.maximum(k - 2, 0)
    q, qd, qdd = (np.einsum("tnk,tk->tn", c, basis) for basis in (powers, first, second))
    return q, qd / span, qdd / (span * span)
