"""The lidar bytes that the bench plays: of runs of the twin over the courses, with the firmware's own driving."""

import hashlib
import json
import math
import struct
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from host.recording import Inputs, Reader, Stream
from host.twin import image, load_config, run
from host.twin.run import starting

from .surprise import with_surprise

CACHE = image.ROOT / "build" / "bench"

_HEADER = struct.Struct("<6q")
_BATCH = struct.Struct("<qq")

LIMIT_S = 30  # of a run: what comes after is more of the same
COURSES = (
    *({"course": "Z", "width": width, "seed": seed} for width, seed in ((620, 1), (550, 3), (500, 4), (450, 2), (430, 5))),
    {"course": "Z", "width": 580, "seed": 1, "mode": "naws"},
    *({"course": "U", "width": width, "seed": 1} for width in (600, 480)),
    {"course": "S", "width": 500, "seed": 2},
    {"course": "S-sharp", "width": 500, "seed": 1},
    *({"course": "random", "gap": gap, "seed": seed} for gap, seed in ((400, 1), (340, 3), (300, 4))),
)
ALL = (
    *({"course": "Z", "width": width, "seed": seed} for width in (620, 600, 580, 550, 500, 450, 430, 415) for seed in (1, 2, 3)),
    *({"course": "Z", "width": 500, "seed": seed, "changes": {"drive.cruise": 135}} for seed in (1, 2, 3)),
    *({"course": "Z", "width": width, "seed": seed, "mode": "naws"} for width in (620, 600, 580, 550) for seed in (1, 2)),
    *(
        {"course": course, "width": width, "seed": 1, **way}
        for course, widths in (("U", (670, 600, 550, 500, 450)), ("S", (650, 600, 550, 500, 450)), ("S-sharp", (650, 600, 550, 500, 450)))
        for width in widths
        for way in ({}, {"mirror": True}, {"reverse": True})
    ),
    *({"course": "bend", "width": width, "angle": angle, "seed": 1} for angle in (70, 80, 100, 110) for width in (550, 450)),
    *({"course": "random", "gap": gap, "seed": seed} for gap in (400, 340, 300) for seed in (1, 2, 3, 4)),
)
QUICK = ({"course": "Z", "width": 550, "seed": 1, "limit_s": 6}, {"course": "random", "gap": 400, "seed": 1, "limit_s": 6})


@dataclass(frozen=True)
class Tape:
    """Lidar bytes as a file for the board, and the robot.json they belong to. name: of the course. surprise: something new was put in.

    mode, changes: what the course changes in robot.json.
    """

    name: str
    path: Path
    robot: str
    surprise: bool = False
    mode: str | None = None
    changes: dict | None = None


def tapes(courses=COURSES, firmware=image.FIRMWARE, workers=2, each=None, twin=True):
    """Tapes of the courses, recorded now unless that has been done with the same sources. each(): called after each course.

    twin: those of the twin count as well; without, a tape that this firmware drove in another twin will do.
    """
    folder = CACHE / (("scans-" if twin else "driven-") + _sources(firmware, twin))
    folder.mkdir(parents=True, exist_ok=True)
    out = []
    with ProcessPoolExecutor(workers) as pool:
        for made in pool.map(_record, courses, [folder] * len(courses), [firmware] * len(courses)):
            out.extend(made)
            if each:
                each()
    return out


def _record(course, folder, firmware):
    """The tapes of one course: the run as it was, and with surprises."""
    name = " ".join(_word(*item) for item in course.items())
    target = folder / hashlib.sha256(json.dumps(course, sort_keys=True).encode()).hexdigest()[:12]
    robot = json.dumps(load_config(mode=course.get("mode"), changes={**starting(image.FIRMWARE), **(course.get("changes") or {})}))
    if not target.with_suffix(".done").exists():
        with tempfile.TemporaryDirectory() as scratch:
            # Computing takes no time where the tape is played, either: else the robot would decide before what it drove on the tape, and see that it does
            # not move as told.
            run(**{"limit_s": LIMIT_S, "chip": math.inf, **course}, firmware=firmware, record=Path(scratch) / "run.rec")
            batches, decisions, inputs = _read(Path(scratch) / "run.rec")
        wire = json.loads(robot)["lidar"]
        _write(target.with_suffix(".tape"), inputs, wire, batches)
        for i, changed in enumerate(with_surprise(batches, decisions)):
            _write(Path(f"{target}-{i}.surprise"), inputs, wire, changed)
        target.with_suffix(".done").touch()
    surprises = sorted(folder.glob(target.name + "-*.surprise"))
    paths = [target.with_suffix(".tape"), *surprises]
    return [Tape(name, path, robot, path.suffix == ".surprise", course.get("mode"), course.get("changes")) for path in paths]


def _word(key, value):
    if isinstance(value, dict):
        return " ".join(f"{name}={one}" for name, one in value.items())
    return key if value is True else str(value)


def _read(path):
    """([(time, bytes)] of the lidar, [(time, AF, AR, V)] decided, Inputs) of a recording."""
    batches, decisions, inputs = [], [], Inputs(0, 0, ())
    for time, stream, data in Reader(path):
        if stream == Stream.LIDAR:
            batches.append((time, data))
        elif stream == Stream.DECISION:
            _, af, ar, v = struct.unpack_from("<IhhB", data)
            decisions.append((time, af, ar, v))
        elif stream == Stream.INPUTS:
            inputs = Inputs.unpack(data)
    return batches, decisions, inputs


def _write(path, inputs, wire, batches):
    low, high = (sum(1 << address - base for address in inputs.addresses if base <= address < base + 60) for base in (0, 60))
    with open(path, "wb") as file:
        file.write(_HEADER.pack(inputs.levels, low, high, inputs.battery, wire["rx"], wire["baud"]))
        for time, data in batches:
            file.write(_BATCH.pack(time, len(data)) + data)


def _sources(firmware, twin):
    """Hash of all that makes a recording what it is."""
    digest = hashlib.sha256()
    files = [*Path(firmware).rglob("*.py"), *Path(firmware).glob("*.json")]
    if twin:
        files += [*image.BOARD.parent.rglob("*.py"), *Path(__file__).parent.glob("s*.py")]
    for path in sorted(files):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:12]


def returns(tape):
    """Points with a return in each whole revolution of a tape (Delta family, 16 frames a revolution): the median, int."""
    data = tape.path.read_bytes()
    at, frames = _HEADER.size, []
    while at + _BATCH.size <= len(data):
        _, size = _BATCH.unpack_from(data, at)
        frame = data[at + _BATCH.size : at + _BATCH.size + size]
        at += _BATCH.size + size
        if size > 15 and frame[5] == 0xAD:
            frames.append(sum(1 for place in range(14, size - 2, 3) if frame[place] or frame[place + 1]))
    turns = [sum(frames[i : i + 16]) for i in range(0, len(frames) - 15, 16)]
    return sorted(turns)[len(turns) // 2] if turns else 0
