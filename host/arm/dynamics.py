"""Torques of a planar arm in the vertical plane: point masses at the links' ends, gravity along -y (paper D, (7) to (13); no friction, no gears).

Two forms of the same: `torques` adds forces up from the end to the base, which is fast; `matrices` is Lagrange's, for tests and for the independent check.
"""

import numpy as np

from .model import GRAVITY, Arm


def torques(arm: Arm, a, speed, acceleration) -> np.ndarray:
    """Torques, N m, first axis the joint, from directions, their speeds and accelerations (absolute, first axis the link; rad, rad/s, rad/s2)."""
    return torques_from(arm, np.cos(a), np.sin(a), speed, acceleration)


def torques_from(arm: Arm, cos, sin, speed, acceleration) -> np.ndarray:
    """As torques(), where cosines and sines of the directions are known already."""
    n = arm.joints
    x, y = np.zeros_like(cos[0]), np.full_like(cos[0], GRAVITY)
    forces_x, forces_y = np.empty_like(cos), np.empty_like(cos)
    for i in range(n):  # what the masses weigh, their acceleration included
        square = speed[i] * speed[i]
        x = x - arm.lengths[i] * (sin[i] * acceleration[i] + cos[i] * square)
        y = y + arm.lengths[i] * (cos[i] * acceleration[i] - sin[i] * square)
        np.multiply(x, arm.masses[i], out=forces_x[i])
        np.multiply(y, arm.masses[i], out=forces_y[i])
    found = np.empty_like(cos)
    force_x, force_y, torque = 0.0, 0.0, 0.0
    for i in reversed(range(n)):
        force_x, force_y = force_x + forces_x[i], force_y + forces_y[i]
        torque = torque + arm.lengths[i] * (cos[i] * force_y - sin[i] * force_x)
        found[i] = torque
    return found


def at_rest(arm: Arm, q) -> np.ndarray:
    """Torques that hold the arm still, (n,) N m."""
    a = np.cumsum(q)[:, None]
    return torques(arm, a, np.zeros_like(a), np.zeros_like(a))[:, 0]


def matrices(arm: Arm, q, qd) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(M, C, G) of tau = M q'' + C q' + G, for one state (n,). C is the one that makes M' - 2C skew.

    Source: with a_i = q_1 + .. + q_i and mu_ij = the mass from max(i, j) on, kinetic energy is half the sum of mu_ij L_i L_j cos(a_i - a_j) a'_i a'_j.
    """
    n = arm.joints
    a, ad = np.cumsum(q), np.cumsum(qd)
    beyond = np.cumsum(arm.masses[::-1])[::-1]
    weight = beyond[np.maximum.outer(np.arange(n), np.arange(n))] * np.outer(arm.lengths, arm.lengths)
    difference = a[:, None] - a[None, :]
    to_absolute = np.tril(np.ones((n, n)))  # a = S q
    inertia = to_absolute.T @ (weight * np.cos(difference)) @ to_absolute
    coriolis = to_absolute.T @ (weight * np.sin(difference) * ad[None, :]) @ to_absolute
    gravity = to_absolute.T @ (beyond * GRAVITY * arm.lengths * np.cos(a))
    return inertia, coriolis, gravity


def energy(arm: Arm, q, qd) -> tuple[float, float]:
    """(kinetic, potential) energy, J, computed from positions and speeds of the masses and nothing else."""
    a, ad = np.cumsum(q), np.cumsum(qd)
    vx, vy = np.cumsum(-arm.lengths * np.sin(a) * ad), np.cumsum(arm.lengths * np.cos(a) * ad)
    height = np.cumsum(arm.lengths * np.sin(a))
    return float(0.5 * arm.masses @ (vx * vx + vy * vy)), float(GRAVITY * arm.masses @ height)
