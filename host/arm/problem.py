"""What trajectories cost and what they break, for a whole population at once.

Cost, after the paper's (14) to (17) with its errors mended:

    2 F_ot + 2 F_q + 2 F_c + t_T

F_ot, N m    what |torque| exceeds the limits by, summed over the joints and averaged over the nodes, times NODES: so its weight does not grow with the number of nodes
F_q, rad     joint travel: what the joints turn, summed
F_c, m       length of the path of the end
t_T, s       time

A trajectory is valid if nothing comes nearer to an obstacle than the wanted clearance, and neither torque, speed nor angle of a joint leaves its limits.
"""

from dataclasses import dataclass

import numpy as np

from . import clearance, dynamics, trajectory
from .model import Arm

NODES = 21  # the number of nodes for which the weight of F_ot is the paper's
WEIGHTS = (2.0, 2.0, 2.0, 1.0)
CLEARANCE = 0.003  # m
SHORTEST, LONGEST = 1.0, 8.0  # s, of a segment, as in the paper

# What a violation costs while a search is led towards what is valid; cost units per m, per rad, per rad/s.
_PER_CLEARANCE, _PER_ANGLE, _PER_SPEED = 60.0, 40.0, 10.0
_PER_LOAD = 20.0
_THROUGH, _DEEP = 20.0, 0.01  # of going through something, this deep (m) or deeper: more than any way round it costs, however small it is


@dataclass(frozen=True)
class Guard:
    """What the search keeps besides the limits, because it looks at the nodes only: clearance (m), and shares of torque and speed, rad of the angles."""

    clearance: float = CLEARANCE
    torque: float = 0.0
    speed: float = 0.0
    angle: float = 0.0


@dataclass(frozen=True)
class Found:
    """Of P trajectories, (P,) each: cost; its parts over, travel, path, time; clearance (m, least), and by how much limits are broken: angle (rad), speed (rad/s), 0 if not."""

    cost: np.ndarray
    over: np.ndarray
    travel: np.ndarray
    path: np.ndarray
    time: np.ndarray
    clearance: np.ndarray
    angle: np.ndarray
    speed: np.ndarray
    near: np.ndarray  # m of missing clearance, averaged over the nodes
    load: np.ndarray  # largest |torque| over its limit

    def valid(self, wanted: float = CLEARANCE) -> np.ndarray:
        """(P,) True where no limit is broken."""
        return (self.clearance >= wanted) & (self.load <= 1) & (self.angle <= 0) & (self.speed <= 0)


@dataclass(frozen=True)
class Problem:
    """From start to end, (n,) rad, past obstacles; nodes: between them; intervals: of each segment at which the search looks."""

    arm: Arm
    start: np.ndarray
    end: np.ndarray
    obstacles: tuple
    nodes: int = 1
    intervals: int = 40
    weights: tuple[float, float, float, float] = WEIGHTS
    guard: Guard = Guard()

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest value of each gene."""
        arm, m = self.arm, self.nodes
        low = [v for _ in range(m) for v in (*arm.low, *-arm.speeds)] + [SHORTEST] * (m + 1)
        high = [v for _ in range(m) for v in (*arm.high, *arm.speeds)] + [LONGEST] * (m + 1)
        return np.array(low), np.array(high)

    def straight(self) -> np.ndarray:
        """Genes that go straight from start to end in the space of the joints, at a middling speed."""
        parts = []
        for k in range(1, self.nodes + 1):
            share = k / (self.nodes + 1)
            parts += [*(self.start + share * (self.end - self.start)), *((self.end - self.start) / (2.0 * (self.nodes + 1)))]
        low, high = self.bounds()
        return np.clip(np.array([*parts, *[2.0] * (self.nodes + 1)]), low, high)

    def look(self, genes, intervals: int | None = None) -> Found:
        """Cost and violations of genes (P, G)."""
        genes = np.atleast_2d(genes)
        motion = trajectory.sample(genes, self.start, self.end, intervals or self.intervals)
        arm, guard = self.arm, self.guard
        q = np.ascontiguousarray(np.moveaxis(motion.q, 1, 0))  # (n, P, T): each joint's in one piece
        qd, qdd = np.moveaxis(motion.qd, 1, 0), np.moveaxis(motion.qdd, 1, 0)
        a = np.cumsum(q, axis=0)
        cos, sin = np.cos(a), np.sin(a)
        torque = np.abs(dynamics.torques_from(arm, cos, sin, np.cumsum(qd, axis=0), np.cumsum(qdd, axis=0)))
        over = sum(np.maximum(t - limit * (1 - guard.torque), 0).mean(axis=-1) for t, limit in zip(torque, arm.torques)) * NODES
        load = np.max([t.max(axis=-1) / limit for t, limit in zip(torque, arm.torques)], axis=0)
        x, y = clearance.corners(arm, cos, sin)
        travel = np.abs(np.diff(q, axis=-1)).sum(axis=(0, 2))
        path = np.hypot(np.diff(x[-1], axis=-1), np.diff(y[-1], axis=-1)).sum(axis=-1)
        column = (slice(None), None, None)
        angle = np.maximum(arm.low[column] + guard.angle - q, q - arm.high[column] + guard.angle).max(axis=(0, 2))
        speed = (np.abs(qd) - arm.speeds[column] * (1 - guard.speed)).max(axis=(0, 2))
        if self.obstacles:
            distance = clearance.least(arm, x, y, cos, sin, self.obstacles)
            least = distance.min(axis=-1)
            near = np.maximum(guard.clearance - distance, 0).mean(axis=-1)
        else:
            least, near = np.full(len(genes), np.inf), np.zeros(len(genes))
        w = self.weights
        cost = w[0] * over + w[1] * travel + w[2] * path + w[3] * motion.total
        return Found(cost, over, travel, path, motion.total, least, np.maximum(angle, 0), np.maximum(speed, 0), near, load)

    def led(self, found: Found) -> np.ndarray:
        """(P,) cost with a price for what is broken, which leads a search towards what is valid."""
        missing = np.maximum(self.guard.clearance - found.clearance, 0)
        broken = missing * _PER_CLEARANCE + found.near * _PER_CLEARANCE + found.angle * _PER_ANGLE + found.speed * _PER_SPEED
        broken += _PER_LOAD * np.maximum(found.load - 1 + self.guard.torque, 0)
        return found.cost + broken + _THROUGH * (missing > _DEEP)

    def strict(self, found: Found) -> np.ndarray:
        """(P,) the paper's 1/F: cost, infinite where an obstacle is met or the arm leaves its limits; torque over its limit only costs."""
        good = (found.clearance >= self.guard.clearance) & (found.angle <= 0) & (found.speed <= 0)
        return np.where(good, found.cost, np.inf)
