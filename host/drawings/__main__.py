"""Makes the drawings of docs/planner.md from a run of the firmware, and its stage diagram from the code."""

import argparse
import sys
from pathlib import Path

from host.twin import image
from host.version import add_version

from . import FOLDER, PAGE, draw
from .moments import DrawingError
from .stages import renew


def main(arguments=None):
    """Exit code: 0 drawn, 1 the run gave nothing to draw, 2 misused."""
    parser = argparse.ArgumentParser(prog="python -m host.drawings", description=__doc__)
    add_version(parser)
    parser.add_argument("--to", type=Path, metavar="FOLDER", help="where the drawings go, instead of docs/planner; the page is left alone")
    options = parser.parse_args(arguments)
    try:
        made = draw(options.to or FOLDER)
    except (DrawingError, image.ToolMissing) as error:
        print(f"python -m host.drawings: {error}", file=sys.stderr)
        return 1
    if options.to is None:
        PAGE.write_text(renew(PAGE.read_text()))
    for path in made:
        print(f"{path}  {path.stat().st_size // 1000} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
