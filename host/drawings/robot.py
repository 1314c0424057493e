"""The firmware's own candidates and collision check, asked on the laptop about the points of a moment."""

import json
from array import array
from contextlib import chdir
from dataclasses import dataclass

import numpy as np

from host.twin import image, load_config
from params.config import Config
from perception.windows import Windows
from planner.candidates import Candidates
from planner.collision import CollisionCheck, mirror

from .moments import DrawingError

NO_POINT = 65535
_BIAS = 8192


@dataclass
class Robot:
    """config: the firmware's Config of robot.json, as it comes. candidates: its candidates."""

    config: Config
    candidates: Candidates

    @property
    def size(self):
        """Half the width and half the length, mm."""
        return self.candidates.half_width, self.candidates.half_length

    def free(self, moment, mirroring, candidate):
        """(mm that a candidate is free among the points of a moment, the point that ends it as (x, y) mm in the body frame or None)."""
        x, y = (array("H", [int(v) + _BIAS for v in moment.points[:, i]]) for i in (0, 1))
        n = len(x)
        for bit, axis in ((1, x), (2, y)):
            if mirroring & bit:
                mirror(axis, n)
        free, soft, block = (array("H", bytes(2 * self.candidates.count)) for _ in range(3))
        check = CollisionCheck(self.candidates)
        check.prepare(n, moment.near, 1, 0)
        check.check(x, y, candidate, candidate + 1, free, soft, block)
        at = block[candidate]
        if at == NO_POINT:
            return free[candidate], None
        sign = -1 if mirroring & 1 else 1, -1 if mirroring & 2 else 1
        return free[candidate], ((x[at] - _BIAS) * sign[0], (y[at] - _BIAS) * sign[1])

    def windows(self, moment):
        """Window of each point of a moment, (n,), as perception/windows.py numbers them, and the points in the same order, (n, 2) mm."""
        x, y = (array("H", [int(v) + _BIAS for v in moment.points[:, i]]) for i in (0, 1))
        sorter = Windows(self.config, len(x))
        sorter.sort(x, y, len(x))
        return np.array(sorter.window), np.column_stack([x, y]).astype(float) - _BIAS

    def way(self, mirroring, candidate, length, step=15.0):
        """Poses (n, 3) of the body's centre along a candidate: x, y mm and heading in degrees, the beginning and the end included."""
        out = []
        for at in np.linspace(0, length, max(int(length / step), 1) + 1):
            self.candidates.travel(mirroring, candidate, round(at))
            out.append((self.candidates.end_x, self.candidates.end_y, self.candidates.end_turn / 10))
        return np.array(out, float)

    def turn(self, move):
        """Degrees by which a move (mirroring, candidate, mm) turns the body, clockwise."""
        return float(self.way(*move)[-1][2])

    def in_a_bend(self, runs):
        """(the first moment of a run, the one that shows most of all the runs): a pair of moves, the first of them ahead, that turns the body far.

        runs: of moments.runs(). moments.DrawingError.
        """
        pairs = [(one, run[0]) for run in runs for one in run if one.second]
        if not pairs:
            raise DrawingError("no pair of moves was found on these runs")
        bend, first = max(pairs, key=lambda pair: (not pair[0].first[0] & 2, abs(self.turn(pair[0].first) + self.turn(pair[0].second))))
        return first, bend

    def steering(self, mirroring, candidate):
        """(AF, AR) of a candidate, degrees."""
        return self.candidates.af_of(mirroring, candidate) / 10, self.candidates.ar_of(mirroring, candidate) / 10


def robot():
    """The Robot of firmware/robot.json."""
    values = load_config()
    config = Config(values)
    with chdir(image.tables(json.dumps(values)).parent):  # where it finds its tables
        return Robot(config, Candidates(config))
