"""What has to be joined to what, by a robot.json: the table of pins and outputs, the power budget, and with --to a drawing."""

import argparse
import sys
from pathlib import Path

from host.twin.image import FIRMWARE
from host.version import add_version

from . import DRAWING, PAGE, as_json, drawing, pages, power, table, wiring


def main(arguments=None):
    """Exit code: 0 told, 2 misused."""
    parser = argparse.ArgumentParser(prog="python -m host.wiring", description=__doc__)
    add_version(parser)
    add = parser.add_argument
    add("config", metavar="FILE", nargs="?", type=Path, help="a robot.json (default firmware/robot.json)")
    add("--to", metavar="FILE", type=Path, help="draw it, an .svg")
    add("--servo", metavar="A,A", type=_currents, default=power.SERVO, help="current of one servo, usual and most (default %(default)s)")
    add("--motor", metavar="A,A", type=_currents, default=power.MOTOR, help="current of one motor, usual and most (default %(default)s)")
    add("--json", action="store_true", help="the wiring for programs, and nothing else")
    add("--docs", action="store_true", help="write docs/wiring.md and docs/wiring.svg anew, from the default robot.json")
    options = parser.parse_args(arguments)
    if options.to and options.to.suffix.lower() != ".svg":
        parser.error(f"--to {options.to}: the name must end in .svg")
    try:
        wired = wiring(options.config)
        if options.docs:
            PAGE.write_text(pages.renew(PAGE.read_text()))
            options.to = DRAWING
        if options.to:
            options.to.write_text(drawing.draw(wired, (options.config or FIRMWARE / "robot.json").name))
    except (OSError, ValueError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 2
    print(as_json(wired) if options.json else f"{table(wired)}\n{power.text(wired, options.servo, options.motor)}", end="")
    if options.to and not options.json:
        print(f"\ndrawing: {options.to}")
    return 0


def _currents(text):
    try:
        usual, most = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: two numbers are needed, such as 0.5,2.5") from None
    if not 0 <= usual <= most <= 100:
        raise argparse.ArgumentTypeError(f"{text!r}: ampere, the usual first, 0 to 100")
    return usual, most


if __name__ == "__main__":
    sys.exit(main())
