"""arm.json: a planar arm of 1 to 6 revolute joints, with the limits of its joints and the servos that move it."""

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .errors import ArmError

ARMS = Path(__file__).parent / "arms"
MOST_JOINTS = 6
GRAVITY = 9.81  # m/s2

_JOINT = {  # key: (low, high, default); None: must be there
    "length_mm": (10, 5000, None),
    "mass_kg": (0, 100, None),
    "low_deg": (-360, 360, None),
    "high_deg": (-360, 360, None),
    "speed_deg_s": (1, 1000, None),
    "torque_nm": (0.001, 10000, None),
    "radius_mm": (0, 500, 0),
}
_EXTRA = {key: _JOINT[key] for key in ("low_deg", "high_deg", "speed_deg_s")}
_TOP = ("name", "joints", "extra", "elbow", "base_mm", "servos", "while_driving")
_SERVOS = ("channels", "zeros_deg", "directions", "pulse_low_us", "pulse_high_us", "range_deg", "rest_deg")


@dataclass(frozen=True)
class Servos:
    """How the joints, then the extra joints, sit on the servos' chip.

    channels: outputs; zeros: joint angle at the middle of the servo's range, deg; directions: 1 or -1; pulses: us at the two ends of `range_deg`; rest: the pose (deg) in
    which the arm lies while its servos have no power, which is also where "home" takes it.
    """

    channels: tuple[int, ...]
    zeros: tuple[float, ...]
    directions: tuple[int, ...]
    pulse_low: int
    pulse_high: int
    range_deg: float
    rest: tuple[float, ...]


@dataclass(frozen=True)
class Arm:
    """Arrays have one value a joint: lengths and radii m, masses kg (at the links' ends), low and high rad, speeds rad/s, torques N m.

    base: (x, y) of the first joint, m. elbow: the sign of the second joint's angle that inverse kinematics tries first. extra: dicts of the joints that move no link of the
    plane, as a base that turns and a gripper. servos: None for an arm that is only planned for.
    """

    name: str
    lengths: np.ndarray
    masses: np.ndarray
    low: np.ndarray
    high: np.ndarray
    speeds: np.ndarray
    torques: np.ndarray
    radii: np.ndarray
    base: tuple[float, float] = (0.0, 0.0)
    elbow: int = -1
    extra: tuple[dict, ...] = ()
    servos: Servos | None = None
    while_driving: bool = False
    source: dict | None = None

    @property
    def joints(self) -> int:
        return len(self.lengths)

    def with_masses(self, masses) -> "Arm":
        """The same arm with other masses, kg."""
        return replace(self, masses=np.asarray(masses, float), source=None)


def load(name: str | Path) -> Arm:
    """An arm from a file, or one of those that come with the project, by its name ("paper-3r", "mt-arm"). ArmError if it cannot be used."""
    path = Path(name)
    if not path.exists() and (ARMS / f"{name}.json").exists():
        path = ARMS / f"{name}.json"
    return read(read_json(path, "arm"), str(path))


def read_json(path: str | Path, what: str) -> dict:
    """The object in a JSON file. ArmError, with the line, where it is none. NaN and infinity are no numbers."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is not text in UTF-8"
        hint = f"; the arms that come with the project: {', '.join(sorted(p.stem for p in ARMS.glob('*.json')))}" if what == "arm" else ""
        raise ArmError(f"{path}: cannot be read: {why}{hint}") from None
    try:
        values = json.loads(text, parse_constant=_no_number)
    except json.JSONDecodeError as error:
        raise ArmError(f"{path}: not JSON at line {error.lineno}: {error.msg}. Is the file cut off?") from None
    except ValueError as error:
        raise ArmError(f"{path}: {error}") from None
    except RecursionError:
        raise ArmError(f"{path}: nested too deep for a file of this kind") from None
    if not isinstance(values, dict):
        raise ArmError(f"{path}: one object, {{ ... }}, is needed")
    return values


def _no_number(text):
    raise ValueError(f"{text} is no number: measure or compute it anew")


def read(values: dict, where: str = "arm.json") -> Arm:
    """An Arm from what arm.json holds. ArmError names the key."""
    _known(values, _TOP, where)
    joints = values.get("joints")
    if not isinstance(joints, list) or not 1 <= len(joints) <= MOST_JOINTS:
        raise ArmError(f"{where}: joints: a list of 1 .. {MOST_JOINTS} joints is needed")
    rows = [_row(joint, _JOINT, f"{where}: joints[{k}]") for k, joint in enumerate(joints)]
    extra = values.get("extra", [])
    if not isinstance(extra, list) or len(extra) > MOST_JOINTS:
        raise ArmError(f"{where}: extra: a list of at most {MOST_JOINTS} joints is needed")
    extras = tuple(
        _row({k: v for k, v in one.items() if k != "name"} if isinstance(one, dict) else one, _EXTRA, f"{where}: extra[{k}]")
        | {"name": str(one.get("name", f"extra {k}"))[:16]}
        for k, one in enumerate(extra)
    )
    elbow = values.get("elbow", -1)
    if elbow not in (-1, 1) or isinstance(elbow, bool):
        raise ArmError(f"{where}: elbow = {elbow!r}: -1 or 1 is needed, the sign of the second joint's angle that is tried first")
    driving = values.get("while_driving", False)
    if not isinstance(driving, bool):
        raise ArmError(f"{where}: while_driving = {driving!r}: true or false is needed")
    base = numbers(values.get("base_mm", [0, 0]), 2, f"{where}: base_mm", -10000, 10000)
    column = {key: np.array([row[key] for row in rows], float) for key in _JOINT}
    return Arm(
        name=_name(values.get("name", "arm"), where),
        lengths=column["length_mm"] / 1000,
        masses=column["mass_kg"],
        low=np.radians(column["low_deg"]),
        high=np.radians(column["high_deg"]),
        speeds=np.radians(column["speed_deg_s"]),
        torques=column["torque_nm"],
        radii=column["radius_mm"] / 1000,
        base=(base[0] / 1000, base[1] / 1000),
        elbow=elbow,
        extra=extras,
        servos=_servos(values["servos"], rows, extras, where) if "servos" in values else None,
        while_driving=driving,
        source=values,
    )


def _name(name, where):
    if not isinstance(name, str) or not 1 <= len(name.encode()) <= 24:
        raise ArmError(f"{where}: name: a text of 1 .. 24 characters is needed")
    return name


def _known(values, keys, where):
    if not isinstance(values, dict):
        raise ArmError(f"{where}: an object, {{ ... }}, is needed")
    for key in values:
        if key not in keys:
            raise ArmError(f"{where}: unknown key {key}: there are {', '.join(keys)}")


def _row(values, table, where):
    _known(values, tuple(table), where)
    row = {key: number(values.get(key, default), f"{where}.{key}", low, high) for key, (low, high, default) in table.items()}
    if row["low_deg"] >= row["high_deg"]:
        raise ArmError(f"{where}: low_deg = {row['low_deg']:g} must lie below high_deg = {row['high_deg']:g}")
    return row


def number(value, where: str, low: float, high: float) -> float:
    """The value, if it is a finite number within low .. high; else ArmError."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value) or not low <= value <= high:
        raise ArmError(f"{where} = {'nothing' if value is None else repr(value)}: a number {low:g} .. {high:g} is needed")
    return float(value)


def numbers(values, count: int, where: str, low: float, high: float) -> list[float]:
    """As number(), for a list of `count`."""
    if not isinstance(values, list | tuple) or len(values) != count:
        raise ArmError(f"{where}: a list of {count} numbers is needed")
    return [number(value, f"{where}[{k}]", low, high) for k, value in enumerate(values)]


def _servos(values, rows, extras, where):
    """The Servos, checked against the joints: every angle that a joint may take must be one that its servo can."""
    where = f"{where}: servos"
    _known(values, _SERVOS, where)
    limits = [*rows, *extras]
    count = len(limits)
    channels = numbers(values.get("channels"), count, f"{where}.channels", 0, 15)
    if any(channel != int(channel) for channel in channels) or len(set(channels)) != count:
        raise ArmError(f"{where}.channels: whole numbers, each once, are needed")
    zeros = numbers(values.get("zeros_deg", [0] * count), count, f"{where}.zeros_deg", -360, 360)
    directions = numbers(values.get("directions", [1] * count), count, f"{where}.directions", -1, 1)
    if any(direction not in (-1, 1) for direction in directions):
        raise ArmError(f"{where}.directions: 1 or -1 each is needed")
    low, high = (number(values.get(key, default), f"{where}.{key}", 300, 2700) for key, default in (("pulse_low_us", 500), ("pulse_high_us", 2500)))
    if low != int(low) or high != int(high) or high - low < 100:
        raise ArmError(f"{where}: pulse_low_us and pulse_high_us: whole numbers, at least 100 apart, are needed")
    span = number(values.get("range_deg", 180), f"{where}.range_deg", 20, 720)
    rest = numbers(values.get("rest_deg"), count, f"{where}.rest_deg", -360, 360)
    for k, (row, zero, pose) in enumerate(zip(limits, zeros, rest)):
        if row["low_deg"] < zero - span / 2 - 1e-9 or row["high_deg"] > zero + span / 2 + 1e-9:
            reach = f"{zero - span / 2:g} .. {zero + span / 2:g}"
            raise ArmError(f"{where}: joint {k}: its servo reaches {reach} deg, its limits are {row['low_deg']:g} .. {row['high_deg']:g}")
        if not row["low_deg"] <= pose <= row["high_deg"]:
            raise ArmError(f"{where}.rest_deg[{k}] = {pose:g}: outside the joint's limits {row['low_deg']:g} .. {row['high_deg']:g}")
    return Servos(tuple(int(c) for c in channels), tuple(zeros), tuple(int(d) for d in directions), int(low), int(high), span, tuple(rest))
