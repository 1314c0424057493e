"""A recording as a table, one row per decision: what was decided, why, and where the robot was.

Columns: time (s), number, af and ar (deg), v (0..180), mode, window, zone (empty: none), free (mm), block_x and block_y (mm, body frame,
empty: none), why (words), and the latest pose before: x, y (mm) and heading (deg clockwise from +y), the true one in recordings of the twin,
else the odometry's.
"""

import csv
from pathlib import Path

from host.recording import Reader

from .timeline import timeline, word

COLUMNS = ("time", "number", "af", "ar", "v", "mode", "window", "zone", "free", "block_x", "block_y", "why", "x", "y", "heading")
_POSE = ("x", "y", "heading")


def export(reader: Reader, target: Path) -> int:
    """Write the table; returns the number of rows."""
    reasons = reader.header.reasons
    poses: dict[str, dict] = {}
    rows = 0
    with open(target, "w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS, extrasaction="ignore")
        table.writeheader()
        for moment, message in timeline(reader):
            if message["type"] in ("truth", "pose"):
                poses[message["type"]] = message
            elif message["type"] == "names":
                reasons = tuple(message["reasons"])
            elif message["type"] == "decision":
                pose = poses.get("truth") or poses.get("pose") or {}
                block_x, block_y = message["block"] or (None, None)
                rest = {"time": f"{moment:.6f}", "block_x": block_x, "block_y": block_y, "why": word(reasons, message["why"])}
                table.writerow({**message, **rest, **{name: pose.get(name) for name in _POSE}})
                rows += 1
    return rows
