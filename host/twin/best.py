"""The best time possible on a course: an omniscient planner, which knows the whole map, and whose servos take no time.

A graph over x, y and heading: from each pose that the body with 2 mm round it can be in, moves to the places in 16 directions, with a turn of one step to the left,
none or one to the right, and turns on the spot. A move takes as long as its fastest wheel at cruise. The outline is the same from both ends, and so is what the wheels
can do: half a turn of headings is enough. Dijkstra's algorithm (scipy) from everything that lies beyond the goal gives the time from every start.

What comes of a course is kept in out/best, a file each.
"""

import hashlib
import os
from dataclasses import dataclass
from math import hypot, pi
from pathlib import Path

import numpy as np

from .image import ROOT

MARGIN_MM = 2.0
FINE = 25.0, 24  # mm, headings over half a turn: 7.5 degrees
COARSE = 50.0, 18  # of what is larger than LARGE: 10 degrees
LARGE_MM2 = 12e6
FOLDER = ROOT / "out" / "best"
_VERSION = 1
_AROUND = 200.0  # mm round the floor
_WAYS = [(x, y) for x in range(-2, 3) for y in range(-2, 3) if (x or y) and max(abs(x), abs(y)) < 2 + (abs(x) + abs(y) == 3)]
_BATCH = 4_000_000  # pairs of place and wall looked at in one go


@dataclass(frozen=True)
class Best:
    """What a course allows.

    corner: x, y of the first place, mm. step: mm. travel: (headings, rows, columns), mm that the fastest wheel rolls from there to the goal; inf where no way
    leads there, or no body fits.
    """

    corner: tuple
    step: float
    travel: np.ndarray

    def from_pose(self, x, y, heading, wheels):
        """Travel from a pose, mm, inf where there is none. heading: radians; wheels: of `outer_wheels`."""
        turns = len(self.travel)
        u, v = (x - self.corner[0]) / self.step, (y - self.corner[1]) / self.step
        t = heading / pi * turns
        found = np.inf
        for k in (int(np.floor(t)), int(np.floor(t)) + 1):
            for j in (int(np.floor(v)), int(np.floor(v)) + 1):
                for i in (int(np.floor(u)), int(np.floor(u)) + 1):
                    if 0 <= j < self.travel.shape[1] and 0 <= i < self.travel.shape[2]:
                        way = _rolls((i - u) * self.step, (j - v) * self.step, (k - t) * pi / turns, heading, wheels)
                        found = min(found, self.travel[k % turns, j, i] + way)
        return float(found)


def seconds(course, vehicle, pose, speed):
    """The best time from a pose (x, y mm, heading radians) to the goal, s, to a hundredth; None where there is no way. speed: of the fastest wheel, mm/s."""
    travel = best(course, vehicle).from_pose(*pose, outer_wheels(vehicle))
    return round(travel / speed, 2) if np.isfinite(travel) else None


def best(course, vehicle, folder=FOLDER):
    """The Best of a course, out of the folder if it is there. Walls that move do not count."""
    half = vehicle.width / 2, vehicle.length / 2
    wheels = outer_wheels(vehicle)
    digest = hashlib.sha256(repr((_VERSION, half, wheels.tolist(), course.goal, course.reached)).encode())
    digest.update(np.ascontiguousarray(course.segments, float).tobytes() + np.ascontiguousarray(course.floor, float).tobytes())
    path = Path(folder) / f"{digest.hexdigest()[:24]}.npz"
    try:
        with np.load(path) as kept:
            return Best(tuple(kept["corner"]), float(kept["step"]), kept["travel"])
    except (OSError, ValueError, KeyError):
        pass
    made = _make(course, half, wheels)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(f".{os.getpid()}.npz")
        np.savez_compressed(part, corner=made.corner, step=made.step, travel=made.travel)
        os.replace(part, path)
    except OSError:
        pass  # then it is made again next time
    return made


def outer_wheels(vehicle):
    """(4, 2) mm: where the wheels stand of which one is always the fastest."""
    across = vehicle.track / 2
    return np.array([(side * across, along) for along in (vehicle.axles[0], vehicle.axles[-1]) for side in (-1, 1)])


def _make(course, half, wheels):
    points = np.vstack([course.floor.reshape(-1, 2), [course.start[:2]]])
    low, high = points.min(axis=0) - _AROUND, points.max(axis=0) + _AROUND
    step, turns = FINE if np.prod(high - low) <= LARGE_MM2 else COARSE
    low = points[-1] - step * np.ceil((points[-1] - low) / step)  # the start is a place
    columns, rows = (int(n) + 1 for n in np.ceil((high - low) / step))
    x, y = low[0] + step * np.arange(columns), low[1] + step * np.arange(rows)
    free = np.array([_free(x, y, pi * t / turns, course.segments, half) for t in range(turns)])
    return Best((float(low[0]), float(low[1])), step, _spread(free, _left(course, x, y, step), step, wheels))


def _left(course, x, y, step):
    """(rows, columns): mm to the goal where it is reached already, or within two steps of it where it is a line; inf elsewhere."""
    left = np.where([[course.through(px, py) for px in x] for py in y], 0.0, np.inf)
    if course.goal is not None and not course.reached:
        gx, gy, heading, half = course.goal
        dx, dy = np.meshgrid(x - gx, y - gy)
        before = -(dx * np.sin(heading) + dy * np.cos(heading))
        beside = np.abs(dx * np.cos(heading) - dy * np.sin(heading))
        near = (before >= 0) & (before < 2 * step) & (beside <= half)
        left[near] = before[near]
    return left


def _free(x, y, heading, segments, half):
    """(rows, columns): where the body's centre may be at a heading, the walls being at least the margin away on the outline's own axes."""
    s, c = np.sin(heading), np.cos(heading)
    across, along = half[0] + MARGIN_MM, half[1] + MARGIN_MM
    px, py = (axis.ravel() for axis in np.meshgrid(x, y))
    out = np.ones(len(px), bool)
    reach = hypot(across, along)
    for x1, y1, x2, y2 in segments:
        near = np.flatnonzero(out & (px > min(x1, x2) - reach) & (px < max(x1, x2) + reach) & (py > min(y1, y2) - reach) & (py < max(y1, y2) + reach))
        ax, ay, bx, by = x1 - px[near], y1 - py[near], x2 - px[near], y2 - py[near]
        u1, v1, u2, v2 = ax * c - ay * s, ax * s + ay * c, bx * c - by * s, bx * s + by * c
        nx, ny = v1 - v2, u2 - u1  # of the wall, not of unit length
        apart = (np.minimum(u1, u2) > across) | (np.maximum(u1, u2) < -across) | (np.minimum(v1, v2) > along) | (np.maximum(v1, v2) < -along)
        apart |= np.abs(u1 * nx + v1 * ny) > across * np.abs(nx) + along * np.abs(ny)
        out[near[~apart]] = False
    return out.reshape(len(y), len(x))


def _rolls(dx, dy, turn, heading, wheels):
    """mm that the fastest wheel rolls while the body moves by dx, dy and turns (radians, clockwise) about a heading."""
    middle = heading + turn / 2
    s, c = np.sin(middle), np.cos(middle)
    along, across = dx * s + dy * c, dx * c - dy * s
    return float(np.hypot(across + turn * wheels[:, 1], along - turn * wheels[:, 0]).max())


def _spread(free, left, step, wheels):
    """Travel from each pose to the goal. left: of _left()."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import dijkstra

    turns, rows, columns = free.shape
    number = np.full(free.shape, -1)
    number[free] = np.arange(free.sum())
    travel = np.full(free.shape, np.inf)
    ends = free & np.isfinite(left)
    if not ends.any():
        return travel.astype(np.float32)
    # One more node, the goal itself, from which all ways begin.
    goal = int(free.sum())
    first, second = [np.full(ends.sum(), goal)], [number[ends]]
    cost = [np.broadcast_to(np.maximum(left, 1e-3), free.shape)[ends].astype(np.float32)]
    moves = [(dx, dy, turn) for dx, dy in _WAYS for turn in (-1, 0, 1)] + [(0, 0, 1)]
    for dx, dy, turn in moves:
        here = slice(max(0, -dy), rows - max(0, dy)), slice(max(0, -dx), columns - max(0, dx))
        there = slice(max(0, dy), rows - max(0, -dy)), slice(max(0, dx), columns - max(0, -dx))
        for t in range(turns):
            a, b = number[t][here], number[(t + turn) % turns][there]
            both = (a >= 0) & (b >= 0) & ((a < b) | (dx == dy == 0))  # each once: the way back costs the same
            first.append(a[both])
            second.append(b[both])
            cost.append(np.full(both.sum(), _rolls(dx * step, dy * step, turn * pi / turns, t * pi / turns, wheels), np.float32))
    pairs = np.concatenate(first), np.concatenate(second)
    graph = coo_matrix((np.concatenate(cost), pairs), shape=(goal + 1, goal + 1)).tocsr()
    travel[free] = dijkstra(graph, directed=False, indices=goal)[:-1]
    return travel.astype(np.float32)
