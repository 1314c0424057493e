"""What the monitor's page is told of the arm: the trajectories in out/arm/, each with the arm's shape, its obstacles, its curve, and its bytes for the board in pieces."""

import math
from pathlib import Path

import numpy as np

from . import board, kinematics, reach, scenes
from .errors import ArmError
from .play import PIECE
from .reach import Reach

FOLDER = Path("out") / "arm"
_MOST = 50  # files
_SAMPLES = 60


def listing(folder: Path = FOLDER) -> dict:
    """Message `reaches`: list of what can be played, newest first, and `wrong`: files that cannot, with the reason."""
    found, wrong = [], []
    files = sorted(folder.glob("*.json"), key=lambda path: -path.stat().st_mtime)[:_MOST] if folder.is_dir() else []
    for path in files:
        try:
            found.append(_shown(path.stem, reach.read(path)))
        except ArmError as error:
            wrong.append(str(error))
    return {"type": "reaches", "list": found, "wrong": wrong}


def _shown(name: str, one: Reach) -> dict:
    """Lengths mm, angles deg, times s; pieces: hex."""
    arm = one.arm
    data = board.encode(one)
    when = np.linspace(0, one.total, _SAMPLES)
    q = one.at(when)[0]
    ends = kinematics.points(arm, q)[:, -1]
    limits = [[round(low, 2), round(high, 2)] for low, high, _ in board.rows(arm)]
    names = [f"joint {k + 1}" for k in range(arm.joints)] + [extra["name"] for extra in arm.extra]
    return {
        "name": name,
        "arm": {"name": arm.name, "lengths": [round(1000 * v, 2) for v in arm.lengths], "base": [1000 * v for v in arm.base], "limits": limits, "names": names},
        "obstacles": [scenes.as_file(obstacle) for obstacle in one.obstacles],
        "time": round(one.total, 3),
        "angles": [[round(math.degrees(v), 2) for v in row] + extra for row, extra in zip(q, np.round(one.extra_at(when), 2).tolist())],
        "path": [[round(1000 * float(v), 1) for v in end] for end in ends],
        "pieces": [data[at : at + PIECE].hex() for at in range(0, len(data), PIECE)],
        "piece": PIECE,
    }
