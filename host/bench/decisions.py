"""Whether two firmwares do the same: both are played the bench's tapes, and each decision and register write is compared, byte for byte."""

import io
import json
import struct
import subprocess
import tarfile
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

from host.recording import Decision
from host.replay import table
from host.replay.compare import Difference
from host.twin import image, load_config
from host.twin.run import starting

from . import scans
from .measure import play

WORKERS = 2

_ENTRY = struct.Struct("<qBBH")
_DECISION = struct.Struct("<11i")


@dataclass
class Outcome:
    """decisions, writes: how many were compared. first: what differs first, in words, or "". only_times: all that differs is when."""

    decisions: int = 0
    writes: int = 0
    first: str = ""
    only_times: bool = True


@contextmanager
def firmware_of(ref):
    """Folder of the firmware (main.py and lib/) of a folder, of a working tree or of a git commit. ValueError if it is none of these."""
    for folder in (Path(ref), Path(ref) / "firmware"):
        if (folder / "main.py").is_file():
            yield folder
            return
    done = subprocess.run(["git", "-C", str(image.ROOT), "archive", "--format=tar", ref, "firmware"], capture_output=True)
    if done.returncode:
        said = done.stderr.decode(errors="replace").strip().splitlines()
        raise ValueError(f"{ref} is neither a folder with a firmware in it nor a commit: {said[-1] if said else 'git says nothing'}")
    with tempfile.TemporaryDirectory() as scratch:
        with tarfile.open(fileobj=io.BytesIO(done.stdout)) as archive:
            archive.extractall(scratch, filter="data")
        yield Path(scratch) / "firmware"


def compare(ref, courses=scans.COURSES, firmware=image.FIRMWARE, each=None):
    """[(Tape, Outcome)] of the firmware of `ref` beside that of a folder. each(): called for each tape. BenchError, ValueError as firmware_of."""
    with firmware_of(ref) as before:
        try:
            tapes = scans.tapes(courses, before, WORKERS, twin=False)
        except Exception:  # of a firmware that no longer starts in this twin: then the other one drives
            tapes = scans.tapes(courses, firmware, WORKERS, twin=False)
        boards = [(*image.compiled(Path(folder)), Path(folder) / "robot.json") for folder in (before, firmware)]

        def one(tape):
            then, now = (_entries(play("decisions", tape, _robot(tape, robot), board, built)) for board, built, robot in boards)
            return tape, outcome(then, now)

        out = []
        with ThreadPoolExecutor(WORKERS) as pool:
            for found in pool.map(one, tapes):
                out.append(found)
                if each:
                    each()
        return out


def outcome(then, now):
    """Outcome of two logs, [(time us, kind, address, bytes)]."""
    out = Outcome()
    for a, b in zip_longest(then, now):
        if (a or b)[1]:
            out.writes += 1
        else:
            out.decisions += 1
        if a == b:
            continue
        same = a is not None and b is not None and a[1:] == b[1:]
        if not out.first or not same and out.only_times:
            out.first = _words(a, b)
        out.only_times = out.only_times and same
    return out


def report(found):
    """(text, exit code): 0 all the same, 1 something differs, 2 nothing was compared."""
    decisions = sum(one.decisions for _, one in found)
    writes = sum(one.writes for _, one in found)
    counted = f"{len(found)} tapes, {decisions} decisions and {writes} register writes compared"
    if not decisions or not writes:
        return counted + ": that proves nothing", 2
    unlike = [(tape, one) for tape, one in found if one.first]
    if not unlike:
        return counted + ": all the same", 0
    tape, one = min(unlike, key=lambda item: item[1].only_times)
    what = "the bytes are the same, but not their times" if one.only_times else "not the same"
    name = tape.name + (", surprised" if tape.surprise else "")
    return f"{counted}: {what} on {len(unlike)} tapes\n{name}: {one.first}", 1


def _robot(tape, path):
    """Text of the robot.json that a firmware comes with, changed as the tape's course wants it."""
    return json.dumps(load_config(path if path.is_file() else None, tape.mode, {**starting(path.parent), **(tape.changes or {})}))


def _entries(data):
    out, at = [], 0
    while at < len(data):
        time, kind, address, size = _ENTRY.unpack_from(data, at)
        at += _ENTRY.size
        out.append((time, kind, address, data[at : at + size]))
        at += size
    return out


def _words(a, b):
    time = min(entry[0] for entry in (a, b) if entry)
    if any(entry and not entry[1] for entry in (a, b)):
        then, now = (Decision(*_DECISION.unpack(entry[3])) if entry and not entry[1] else None for entry in (a, b))
        return f"decision at {time / 1e6:.6f} s: then {then and _plain(then)}; now {now and _plain(now)}" + _moved(a, b)
    return "write " + table.write(Difference(time, a and a[2:], b and b[2:])) + _moved(a, b)


def _moved(a, b):
    return f" ({b[0] - a[0]:+d} us)" if a and b and a[0] != b[0] else ""


def _plain(decision):
    return " ".join(f"{name} {value}" for name, value in decision._asdict().items())
