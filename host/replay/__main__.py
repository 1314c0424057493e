"""python -m host.replay FILE [--set KEY=VALUE ...] [--engine ENGINE] [--firmware FOLDER] [--rows N]

Feeds the recorded lidar bytes, at their recorded times, through the firmware's own code, and compares every decision and every register
byte with those recorded. With --set the firmware runs with other settings, and what would have changed is shown.

Exit status: 0 all the same; 1 something differs; 2 nothing to replay, or wrong arguments.
"""

import argparse
import json
import os
import sys
from pathlib import Path

try:
    import numpy  # noqa: F401
except ImportError:
    sys.exit("numpy is not installed for this Python; run `make setup` and use .venv/bin/python")

from host.recording import Reader, RecordingError
from host.twin.image import FIRMWARE, ToolMissing
from host.twin.process import ENGINES
from host.twin.recorder import version
from host.version import add_version

from . import compare, table
from .rerun import rerun, settings
from .tape import Tape

SAME, DIFFERS, MISUSED = 0, 1, 2


def main(argv: list[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    options = _parser().parse_args(argv)
    try:
        reader = Reader(options.file)
        tape = Tape(reader)
        changes = dict(_change(text) for text in options.set)
        robot = settings(reader.header.robot, changes)
    except (RecordingError, ValueError, TypeError, AttributeError) as error:
        return _misused(error)
    try:
        notes = reader.header.notes
        files = {"arm.json": notes["arm"].encode()} if isinstance(notes.get("arm"), str) else None
        again = rerun(tape, robot, options.engine, options.firmware, float(notes.get("chip", "inf")), files)
    except (ToolMissing, SyntaxError) as error:
        return _misused(error)
    print(f"{options.file}: {reader.header.source}, {tape.then.end_us / 1e6:.1f} s")
    if tape.cut:
        print(f"the file is {tape.cut}; what is before that was replayed, what is behind it can be looked at (host.export, the monitor)")
        # The cut may lie between the writes of one moment: those behind it have nothing to be compared with.
        del again.log.writes[len(tape.then.writes) :]
    if reader.header.firmware != (here := version(options.firmware)):
        print(f"recorded with firmware {reader.header.firmware}, this is {here}: differences are to be expected")
    if tape.cut and not tape.then.decisions:
        print("nothing was compared: no decision was recorded before that")
        return MISUSED
    return _report(tape.then, again, changes, reader.header.reasons, options.rows)


def _misused(error: Exception) -> int:
    print(f"python -m host.replay: {error}", file=sys.stderr)
    return MISUSED


def _report(then, again, changes, reasons, rows) -> int:
    match = compare.decisions_by_time if changes else compare.decisions_by_number
    decisions, writes = match(then, again.log), compare.writes(then, again.log)
    print(table.summary("decisions", decisions) if then.decisions else "no decision was recorded")
    for line in table.decisions(decisions, reasons, rows):
        print(line)
    print(table.summary("register writes", writes))
    if writes.differences:
        print("          " + table.write(writes.differences[0]))
    if again.stopped:
        print(f"now it ended early: {again.stopped}")
    if changes and decisions.differences:
        print("after the first difference the robot would have gone elsewhere than the recorded lidar did: drive it in the twin to see where")
    return DIFFERS if decisions.differences or writes.differences else SAME


def _change(text: str) -> tuple[str, object]:
    """ "avoid.margin=20" -> ("avoid.margin", 20)."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise ValueError(f"--set {text}: write section.key=value, as in avoid.margin=20")
    try:
        return key.strip(), json.loads(value)
    except ValueError:
        return key.strip(), value.strip()


def _rows(text: str) -> int:
    if not text.isdigit():
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of rows; whole numbers from 0 are accepted")
    return int(text)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m host.replay", description="Run a recording through the firmware again and compare what it decides.",
        epilog="exit status: 0 all the same, 1 something differs, 2 nothing to replay or wrong arguments",
    )  # fmt: skip
    add_version(parser)
    parser.add_argument("file", metavar="FILE", help="recording")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="another setting of robot.json: avoid.margin=20")
    parser.add_argument("--engine", choices=ENGINES, default=ENGINES[0], help="what runs the firmware")
    parser.add_argument("--firmware", type=Path, default=FIRMWARE, metavar="FOLDER", help="main.py and lib/ to run (default firmware/)")
    parser.add_argument("--rows", type=_rows, default=10, metavar="N", help="differing decisions to show (default %(default)s)")
    return parser


if __name__ == "__main__":
    try:
        status = main()
        sys.stdout.flush()
    except BrokenPipeError:  # whoever read it, head or less, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = DIFFERS
    sys.exit(status)
