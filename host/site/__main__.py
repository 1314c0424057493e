"""Makes a site of the README and docs/ that needs no network to be read."""

import argparse
import sys
from pathlib import Path

from host.version import add_version

from . import SITE, SiteError, build


def main(arguments=None):
    """Exit code: 0 made, 1 not."""
    parser = argparse.ArgumentParser(prog="python -m host.site", description=__doc__)
    add_version(parser)
    parser.add_argument("--to", type=Path, default=SITE, metavar="FOLDER", help="where it goes; what is in there is removed (default out/site)")
    options = parser.parse_args(arguments)
    try:
        lacking = build(options.to.absolute())
    except (SiteError, OSError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    for what in lacking:
        print(f"{parser.prog}: {what}", file=sys.stderr)
    print(f"{options.to}/index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
