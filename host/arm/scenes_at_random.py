"""Random scenes, and which of them can be solved at all, by a planner of another kind (`tree`)."""

import math

import numpy as np

from . import kinematics, refuse, scenes, tree
from .errors import ArmError
from .model import Arm
from .problem import CLEARANCE


def make(arm: Arm, seed: int) -> tuple[tuple, list]:
    """(obstacles: 1 to 5 discs; [(start, end)]): random poses at which the arm can rest."""
    random = np.random.default_rng([seed, arm.joints, round(1000 * arm.lengths.sum())])
    reach = float(arm.lengths.sum())
    while True:
        discs = []
        for _ in range(int(random.integers(1, 6))):
            far, angle = reach * random.uniform(0.45, 1.0), random.uniform(-0.3, math.pi + 0.3)
            discs.append(scenes.Disc(far * math.cos(angle), far * math.sin(angle), reach * random.uniform(0.04, 0.14)))
        poses = [kinematics.pose(arm, random.uniform(arm.low, arm.high)) for _ in range(2)]
        try:
            starts, ends = (refuse.place(arm, where, pose, discs, CLEARANCE) for where, pose in zip(("start", "end"), poses))
        except ArmError:
            continue
        if np.abs(starts[0] - ends[0]).max() > 0.5:
            return tuple(discs), refuse.pairs(arm, starts, ends)


def solvable(arm: Arm, obstacles, pairs, seed: int) -> bool:
    """Whether the tree finds a way for any pair of branches."""
    return any(tree.way(arm, obstacles, start, end, 7919 * seed + k) is not None for k, (start, end) in enumerate(pairs))
