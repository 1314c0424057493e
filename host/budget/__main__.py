"""python -m host.budget [--config FILE] [--option GROUP.KEY=VALUE] [--json] [--check]

Prints what the firmware takes of the board's memory, measured on this machine, against what it may take.

Exit status: 0 done; 1 with --check: a figure misses what is to be reached, or the start does not fit the board; 2 wrong arguments, or a tool is missing.
"""

import argparse
import json
import sys
from pathlib import Path

from host import micropython
from host.twin import image
from host.twin.run import load_config
from host.version import add_version
from params.config import Config

from . import chip_memory, report, targets, trace


def main(argv: list[str] | None = None) -> int:
    """Run the command line; returns the exit status."""
    options = _parser().parse_args(argv)
    try:
        config = _config(options.config, options.option)
        figures = report.measure(config)
        missed = [row for row in targets.rows(figures) if row.missed]
        print(json.dumps(figures, indent=2) if options.json else report.text(config, figures))
        if options.check:
            refused = {option: found for option, found in report.chip(config).items() if isinstance(found, chip_memory.NoRoom)}
            for option, error in refused.items():
                print(f"{option} does not start: {error}", file=sys.stderr)
            return 1 if missed or refused else 0
    except (OSError, ValueError, micropython.ToolMissing, trace.Failed) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def _config(path: Path, options: list[str]) -> dict:
    """The robot.json with the options put in. ValueError names the file, the option or the key that is wrong."""
    config = load_config(path)
    for option in options:
        key, equals, value = option.partition("=")
        group, _, name = key.partition(".")
        if not (equals and group):
            raise ValueError(f"--option {option}: write it as group.key=value, such as screen.kind=nextion")
        try:
            told = json.loads(value)
        except ValueError:
            told = value
        config = trace.merged(config, {group: {name: told}}) if name else {**config, group: told}
    Config(config)  # says what the robot would refuse
    return config


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m host.budget", description="What the firmware takes of the board's memory.")
    parser.add_argument("--config", type=Path, default=image.FIRMWARE / "robot.json", metavar="FILE", help="a robot.json (default: firmware/robot.json)")
    parser.add_argument("--option", action="append", default=[], metavar="GROUP.KEY=VALUE", help="change one value of it; may be given several times")
    parser.add_argument("--json", action="store_true", help="the figures only, as JSON")
    parser.add_argument("--check", action="store_true", help="exit 1 if a figure misses what is to be reached, or the start does not fit")
    add_version(parser)
    return parser


if __name__ == "__main__":
    sys.exit(main())
