"""Moments of a real run: the firmware drives a course in the twin, and is then run again on what its lidar said, while the planner's state is written down."""

import json
import math
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from host import micropython
from host.bench import scans
from host.bench.measure import HERE as BENCH
from host.twin import image

COURSES = tuple({"course": "Z", "width": width, "seed": seed, "limit_s": 12, "chip": math.inf} for width, seed in ((450, 1), (450, 2), (500, 4)))
N, TURNS = 26, 12  # places to a side of the grid, orientations
_ROWS = N * TURNS
_BIAS = 8192
_LENGTHS = 5  # moves of a candidate
_NOTHING = 65535
_HEAP = "64m"
_LIMIT_S = 120


class DrawingError(Exception):
    """The run gave nothing to draw; the message says why."""


@dataclass
class Grid:
    """A cost to go. Floor, mm, in the frame of the odometry.

    corner: (x, y). cell: mm. bytes: the costs as the firmware keeps them. closed, near: (12, 26, 26) bool, by orientation, row, column.
    revisit: (26, 26) int, halves of the usual cost of a step.
    """

    corner: tuple
    cell: float
    bytes: bytes
    closed: np.ndarray
    near: np.ndarray
    revisit: np.ndarray


@dataclass
class Moment:
    """What the planner knew when it chose two moves.

    pose: from where the points are seen, x, y (mm, floor), heading (deg). points: (n, 2) mm in the body frame, the `near` ones at the outline first.
    floor_points: (n, 2) mm, all that are remembered. firsts: [(mirroring, candidate, mm)]; first: the chosen one. second: (mirroring, candidate, mm), None where
    there is none. taken: (mirroring, candidate, mm free) of what is driven now.
    """

    time_s: float
    pose: tuple
    points: np.ndarray
    near: int
    floor_points: np.ndarray
    firsts: list
    first: tuple | None
    second: tuple | None
    taken: tuple
    grid: Grid


@dataclass
class BestFirst:
    """A decision for a single move. bounds, costs: (2 * candidates,) mm, the least of each candidate's moves, to the right, then to the left: lower bounds without any points, and
    what they cost with them, inf where no move is left. checked: (2 * candidates,) bool, the candidates that had to be checked; the costs of the others are their bounds.
    """

    time_s: float
    bounds: np.ndarray
    costs: np.ndarray
    checked: np.ndarray


def runs(courses=COURSES, firmware=image.FIRMWARE):
    """[[Moment or BestFirst]] of a run of the firmware on each course, in the order of time. DrawingError, image.ToolMissing."""
    board, compiled = image.compiled(Path(firmware))
    tapes = [tape for tape in scans.tapes(courses, firmware) if not tape.surprise]
    return [_moments(tape, board, compiled, image.tables(tape.robot, firmware)) for tape in tapes]


def _moments(tape, board, compiled, tables):
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "robot.json").write_text(tape.robot)
        if tables:
            shutil.copyfile(tables, Path(folder) / "tables.bin")
        log = Path(folder) / "log"
        script = Path(__file__).resolve().parent / "board" / "watch.py"
        words = [*micropython.find().command, "-X", f"heapsize={_HEAP}", script, tape.path, log, BENCH / "board", board, compiled]
        done = subprocess.run([str(word) for word in words], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=_LIMIT_S)
        if done.returncode or not log.exists():
            said = (done.stdout + done.stderr).decode(errors="replace").strip()
            raise DrawingError(f"the firmware did not get through {tape.name}:\n{said[-2000:]}")
        return [_read(json.loads(line)) for line in log.read_text().splitlines()]


def _read(line):
    return _best_first(line) if "bounds" in line else _moment(line)


def _best_first(line):
    bounds, costs = (np.array(line[name], float).reshape(-1, _LENGTHS) for name in ("bounds", "scores"))
    least = [np.where(moves == _NOTHING, np.inf, moves).min(axis=1) for moves in (bounds, costs)]
    return BestFirst(line["time_us"] / 1e6, least[0], least[1], np.array(line["free"]).ravel() != _NOTHING)


def _moment(line):
    first = line["first"]
    x, y, heading = line["pose"]
    firsts = list(zip(first["mirroring"], first["candidate"], first["length"], strict=True))
    return Moment(
        time_s=line["time_us"] / 1e6,
        pose=(x / 8, y / 8, heading / 10),
        points=np.column_stack([line["x"], line["y"]]).astype(float) - _BIAS,
        near=line["near"],
        floor_points=np.array([x / 8, y / 8]) + _wrapped(np.column_stack([line["map_x"], line["map_y"]]) - np.array([x, y])) / 8,
        firsts=firsts,
        first=firsts[line["chosen"]] if firsts else None,
        second=tuple(line["second"]) if line["found"] else None,
        taken=tuple(line["taken"]),
        grid=_grid(line["grid"], x, y),
    )


def _grid(grid, x, y):
    """A Grid; x, y: of the body, 1/8 mm: the grid's coordinates wrap."""
    scratch = bytes.fromhex(grid["scratch"])
    bits = np.frombuffer(scratch[: 8 * _ROWS], "<u4").reshape(2, TURNS, N, 1) >> np.arange(N) & 1
    corner = np.array([x, y]) + _wrapped(np.array(grid["corner"]) - np.array([x, y]))
    return Grid(
        corner=tuple(corner / 8),
        cell=grid["cell"] / 8,
        bytes=bytes.fromhex(grid["cost"]),
        closed=bits[0].astype(bool),
        near=bits[1].astype(bool),
        revisit=np.frombuffer(scratch[12 * _ROWS :][: N * N], np.uint8).reshape(N, N).astype(int),
    )


def _wrapped(difference):
    """Of coordinates modulo 2**16."""
    return (difference + 0x8000) % 0x10000 - 0x8000
