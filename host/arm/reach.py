"""reach.json: where a trajectory goes, as points with time, angles, speeds and accelerations; between two points a polynomial that meets all of them.

    {"format": "arm-reach-1", "arm": {what arm.json holds}, "obstacles": [{"disc": [x, y, r]}, ...], "points": [
        {"time_s": 0, "angles_deg": [...], "speeds_deg_s": [...], "accelerations_deg_s2": [...], "extra_deg": [...]}, ...], "cost": ..., ...}

Start, node and end are enough for what this planner makes, as its polynomials are of 5th degree at most. Files from elsewhere may leave out accelerations (then
polynomials of 3rd degree), and speeds (then slopes between the neighbours, rest at both ends). extra_deg: of the joints beside the plane, at rest in each point.
"""

import copy
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import model, scenes
from .errors import ArmError
from .model import Arm

FORMAT = "arm-reach-1"
MOST_POINTS = 5000
LONGEST_S = 120.0
_FAR = 100000.0


@dataclass(frozen=True)
class Reach:
    """times (T,) s; q, qd (T, n) rad; qdd the same or None; extra (T, e) deg. told: what else stands in the file, such as its cost."""

    arm: Arm
    obstacles: tuple
    times: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray | None
    extra: np.ndarray
    told: dict

    @property
    def total(self) -> float:
        """s"""
        return float(self.times[-1])

    def at(self, when) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(q, q', q''), (K, n), at times (K,) s; at rest in the first and last pose before and after."""
        when = np.clip(np.asarray(when, float), 0, self.total)
        k = np.clip(np.searchsorted(self.times, when, side="right") - 1, 0, len(self.times) - 2)
        span = (self.times[k + 1] - self.times[k])[:, None]
        s = (when[:, None] - self.times[k][:, None]) / span
        q0, q1 = self.q[k], self.q[k + 1]
        v0, v1 = self.qd[k] * span, self.qd[k + 1] * span
        if self.qdd is None:
            d = q1 - q0
            c: tuple = (q0, v0, 3 * d - 2 * v0 - v1, v0 + v1 - 2 * d)
        else:
            a0, a1 = self.qdd[k] * span * span, self.qdd[k + 1] * span * span
            d = q1 - q0 - v0 - a0 / 2
            v, a = v1 - v0 - a0, a1 - a0
            c = (q0, v0, a0 / 2, 10 * d - 4 * v + a / 2, -15 * d + 7 * v - a, 6 * d - 3 * v + a / 2)
        q = sum(ck * s**i for i, ck in enumerate(c))
        qd = sum(i * ck * s ** (i - 1) for i, ck in enumerate(c) if i > 0)
        qdd = sum(i * (i - 1) * ck * s ** (i - 2) for i, ck in enumerate(c) if i > 1)
        return q, qd / span, qdd / span**2

    def extra_at(self, when) -> np.ndarray:
        """Angles of the extra joints, deg, (K, e): from rest to rest between two points."""
        when = np.clip(np.asarray(when, float), 0, self.total)
        k = np.clip(np.searchsorted(self.times, when, side="right") - 1, 0, len(self.times) - 2)
        s = (when - self.times[k]) / (self.times[k + 1] - self.times[k])
        s = (s * s * (3 - 2 * s))[:, None]
        return self.extra[k] + s * (self.extra[k + 1] - self.extra[k])


def from_points(arm: Arm, obstacles, times, q, qd, qdd=None, extra=None, told=None) -> Reach:
    """A Reach; extra: deg, the rest pose where it is None."""
    if extra is None:
        rest = arm.servos.rest[arm.joints :] if arm.servos else [np.clip(0, e["low_deg"], e["high_deg"]) for e in arm.extra]
        extra = np.tile(np.array(rest, float), (len(times), 1))
    return Reach(arm, tuple(obstacles), np.asarray(times, float), np.asarray(q, float), np.asarray(qd, float), qdd, np.asarray(extra, float), told or {})


def as_dict(reach: Reach) -> dict:
    """What stands in the file."""
    points = []
    for k, when in enumerate(reach.times):
        point = {"time_s": round(float(when), 9), "angles_deg": _degrees(reach.q[k]), "speeds_deg_s": _degrees(reach.qd[k])}
        if reach.qdd is not None:
            point["accelerations_deg_s2"] = _degrees(reach.qdd[k])
        if reach.extra.shape[1]:
            point["extra_deg"] = [round(float(v), 3) for v in reach.extra[k]]
        points.append(point)
    return {
        "format": FORMAT,
        **reach.told,
        "arm": copy.deepcopy(reach.arm.source),
        "obstacles": [scenes.as_file(one) for one in reach.obstacles],
        "points": points,
    }


def _degrees(values):
    return [round(math.degrees(v), 9) + 0.0 for v in values]


def write(reach: Reach, path: str | Path) -> None:
    """Write reach.json. ArmError if it cannot be written."""
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        Path(path).write_text(json.dumps(as_dict(reach), indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise ArmError(f"{path}: cannot be written: {error.strerror}") from None


def read(path: str | Path) -> Reach:
    """The Reach in a file, its own or one from elsewhere. ArmError names the point and what is wrong with it."""
    return from_dict(model.read_json(path, "reach"), str(path))


def from_dict(values: dict, where: str = "reach.json") -> Reach:
    """As read(), from what the file holds."""
    if values.get("format") != FORMAT:
        raise ArmError(f'{where}: format = {values.get("format")!r}: "{FORMAT}" is needed')
    if not isinstance(values.get("arm"), dict):
        raise ArmError(f"{where}: arm: what arm.json holds is needed")
    arm = model.read(values["arm"], f"{where}: arm")
    listed = values.get("obstacles", [])
    if not isinstance(listed, list) or len(listed) > 100:
        raise ArmError(f"{where}: obstacles: a list of at most 100 is needed")
    obstacles = tuple(scenes.from_file(one, f"{where}: obstacles[{k}]") for k, one in enumerate(listed))
    points = values.get("points")
    if not isinstance(points, list) or not 2 <= len(points) <= MOST_POINTS:
        raise ArmError(f"{where}: points: a list of 2 .. {MOST_POINTS} is needed")
    return _from_points(arm, obstacles, points, where, {k: v for k, v in values.items() if k not in ("format", "arm", "obstacles", "points")})


def _from_points(arm, obstacles, points, where, told):
    times: list[float] = []
    columns: dict[str, list] = {"angles_deg": [], "speeds_deg_s": [], "accelerations_deg_s2": [], "extra_deg": []}
    for k, point in enumerate(points):
        here = f"{where}: points[{k}]"
        if not isinstance(point, dict):
            raise ArmError(f"{here}: an object, {{ ... }}, is needed")
        for key in point:
            if key != "time_s" and key not in columns:
                raise ArmError(f"{here}: unknown key {key}: there are time_s, {', '.join(columns)}")
        times.append(model.number(point.get("time_s"), f"{here}.time_s", 0, LONGEST_S))
        if k and times[k] - times[k - 1] < 0.001:
            raise ArmError(f"{here}.time_s = {times[k]:g}: the time goes back or stands; the point before is at {times[k - 1]:g} s")
        for key, rows in columns.items():
            count = len(arm.extra) if key == "extra_deg" else arm.joints
            if key in point or key == "angles_deg":
                rows.append(model.numbers(point.get(key), count, f"{here}.{key}", -_FAR, _FAR))
            elif rows:
                raise ArmError(f"{here}: no {key}, which the points before have")
        for key, rows in columns.items():
            if rows and len(rows) != k + 1:
                raise ArmError(f"{here}: {key} here, but not in the points before")
    if times[0] != 0:
        raise ArmError(f"{where}: points[0].time_s = {times[0]:g}: 0 is needed")
    q = np.radians(np.array(columns["angles_deg"]))
    qd = np.radians(np.array(columns["speeds_deg_s"])) if columns["speeds_deg_s"] else slopes(np.array(times), q)
    qdd = np.radians(np.array(columns["accelerations_deg_s2"])) if columns["accelerations_deg_s2"] else None
    extra = np.array(columns["extra_deg"]) if columns["extra_deg"] and arm.extra else None
    return from_points(arm, obstacles, times, q, qd, qdd, extra, told)


def slopes(times, q):
    """Speeds at points that come without: the slope between the neighbours, 0 at both ends."""
    speeds = np.zeros_like(q)
    if len(times) > 2:
        speeds[1:-1] = (q[2:] - q[:-2]) / (times[2:] - times[:-2])[:, None]
    return speeds


def of_plan(problem, genes, found, told) -> Reach:
    """The Reach of genes (G,): start, nodes, end. found: of the dense grid."""
    from . import trajectory

    _, spans = trajectory.coefficients(genes[None], problem.start, problem.end)
    times = np.concatenate(([0.0], np.cumsum(spans[0])))
    q, qd, qdd = trajectory.at(genes, problem.start, problem.end, times)
    return from_points(problem.arm, problem.obstacles, times, q, qd, qdd, None, figures(found) | told)


def figures(found) -> dict:
    """What is told of a plan in JSON, from a Found of one trajectory."""
    clear = float(found.clearance[0])
    return {
        "cost": round(float(found.cost[0]), 4),
        "time_s": round(float(found.time[0]), 4),
        "travel_rad": round(float(found.travel[0]), 4),
        "path_m": round(float(found.path[0]), 4),
        "clearance_m": round(clear, 6) if math.isfinite(clear) else None,
        "torque_over_nm": round(float(found.over[0]), 4),
    }


def write_csv(reach: Reach, path: str | Path, step_s: float = 0.01) -> None:
    """The curves for a person's own plots: time, then angle (deg), speed (deg/s), acceleration (deg/s2), torque (N m) of each joint, then the end's x and y (mm)."""
    from . import dynamics, kinematics

    when = np.append(np.arange(0, reach.total, step_s), reach.total)
    q, qd, qdd = reach.at(when)
    torque = dynamics.torques(reach.arm, *(np.cumsum(v, axis=1).T for v in (q, qd, qdd))).T
    end = kinematics.points(reach.arm, q)[:, -1]
    columns = [when[:, None], *(np.degrees(v) for v in (q, qd, qdd)), torque, 1000 * end]
    names = [
        "time_s",
        *(f"{what}_{k + 1}" for what in ("angle_deg", "speed_deg_s", "acceleration_deg_s2", "torque_nm") for k in range(reach.arm.joints)),
        "x_mm",
        "y_mm",
    ]
    lines = [",".join(names)] + [",".join(f"{v:.6g}" for v in row) for row in np.hstack(columns)]
    try:
        Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")
    except OSError as error:
        raise ArmError(f"{path}: cannot be written: {error.strerror}") from None
