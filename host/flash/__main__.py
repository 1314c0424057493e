"""python -m host.flash [--deploy] [--port PORT] [--firmware FILE] [--baud N] [--blank] [--arm FILE] [--dry-run]

Puts stock MicroPython and the firmware on an ESP32 and leaves it running. With --deploy only the firmware's changed files are copied. The
robot.json on the board is kept in either case, and a copy of it stays on this machine.

Exit status: 0 done; 1 a step failed (its last line says what to do); 2 wrong arguments; 130 broken off by hand.
"""

import argparse
import shutil
import sys
from pathlib import Path

try:
    from . import flow, ports
except ImportError as error:
    sys.exit(f"{error.name} is not installed for this Python; run `make setup` and use .venv/bin/python")
from host.boards.errors import FlashError
from host.version import add_version


def main(argv: list[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    options = _parser().parse_args(argv)
    steps = flow.DEPLOY if options.deploy else flow.FLASH
    job = None
    try:
        port = (options.port or "PORT") if options.dry_run else ports.choose(options.port, input if sys.stdin.isatty() else None)
        job = flow.Job(port, options.firmware, options.baud, options.blank, arm=_file(options.arm))
        print(f"board on {port}")
        (flow.rehearse if options.dry_run else flow.run)(steps, job)
    except FlashError as error:
        print(f"\n{error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\nbroken off; run it again to finish: the settings are kept on this machine", file=sys.stderr)
        return 130
    finally:
        if job:
            shutil.rmtree(job.folder, ignore_errors=True)
    return 0


def _file(path: Path | None) -> bytes | None:
    """FlashError if it cannot be read."""
    if path is None:
        return None
    try:
        return path.read_bytes()
    except OSError as error:
        raise FlashError(f"{path} cannot be read: {error.strerror}", "name the arm.json of this robot, or leave --arm out") from None


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m host.flash", description="Put MicroPython and the firmware on an ESP32.")
    add_version(parser)
    parser.add_argument("--deploy", action="store_true", help="copy the firmware only, and of it what changed")
    parser.add_argument("--port", help="serial port of the board; found by itself if there is only one")
    parser.add_argument("--firmware", type=Path, metavar="FILE", help="a MicroPython image of your own (no download)")
    parser.add_argument("--baud", type=int, default=460800, help="rate of the ROM loader (default %(default)s)")
    parser.add_argument("--blank", action="store_true", help="do not save the settings on the board before erasing it")
    parser.add_argument("--arm", type=Path, metavar="FILE", help="arm.json of a robot with an arm; without it that on the board stays")
    parser.add_argument("--dry-run", action="store_true", help="print the steps, make the checks that need no board, touch nothing")
    return parser


if __name__ == "__main__":
    sys.exit(main())
