"""python -m host.reference: writes docs/robot-json.md and docs/protocol.md anew, from the firmware's own table of parameters and page of the wire format."""

import argparse
import sys

from host.version import add_version

from . import pages


def main(arguments=None):
    """Exit code: 0 written, 1 the table has what the page cannot describe."""
    parser = argparse.ArgumentParser(prog="python -m host.reference", description=__doc__.partition(": ")[2])
    add_version(parser)
    parser.parse_args(arguments)
    try:
        for path, text in pages().items():
            path.write_text(text)
            print(path)
    except (OSError, ValueError) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
