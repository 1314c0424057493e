"""python -m host.export FILE OUT.mcap|OUT.csv

Turns a recording into a file for Foxglove (MCAP) or a table (CSV).

Exit status: 0 done; 1 the recording was cut off or damaged, and what is whole was exported; 2 nothing was exported.
"""

import argparse
import sys
from pathlib import Path

from host.recording import Reader, RecordingError
from host.version import add_version

from . import ExportError

WHOLE, CUT, FAILED = 0, 1, 2


def main(argv: list[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    options = _parser().parse_args(argv)
    try:
        reader = Reader(options.file)
        count, things, lacks = _export(reader, options.out)
    except (RecordingError, ExportError) as error:
        print(f"python -m host.export: {error}", file=sys.stderr)
        return FAILED
    except OSError as error:
        print(f"python -m host.export: cannot write {options.out}: {error.strerror}; choose a folder you may write to", file=sys.stderr)
        return FAILED
    print(f"{options.out}: {count} {things}")
    for lack in lacks:
        print(f"it lacks {lack}")
    for text in reader.damage:
        print(f"the recording is {text}")
    if reader.cut:
        print(f"the recording is {reader.cut}; what is before that was exported")
    return CUT if reader.cut or reader.damage else WHOLE


def _export(reader: Reader, out: Path) -> tuple[int, str, list[str]]:
    """(how many, of what, what the recording lacks)."""
    if out.suffix == ".csv":
        from . import to_csv

        return to_csv.export(reader, out), "decisions", []
    if out.suffix == ".mcap":
        from . import to_mcap

        lacks: list[str] = []
        return to_mcap.export(reader, out, lacks), "messages", lacks
    raise ExportError(f"{out}: the name must end in .mcap (for Foxglove) or .csv (a table)")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m host.export", description="Turn a recording into a file that other programs open.",
        epilog="exit status: 0 done, 1 the recording was cut off or damaged (what is whole was exported), 2 nothing was exported",
    )  # fmt: skip
    add_version(parser)
    parser.add_argument("file", metavar="FILE", help="recording")
    parser.add_argument("out", metavar="OUT", type=Path, help="file to write: .mcap opens in Foxglove, .csv in a spreadsheet")
    return parser


if __name__ == "__main__":
    sys.exit(main())
