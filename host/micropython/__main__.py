"""python -m host.micropython: fetch the 32-bit MicroPython unless it is there, and say which one runs the firmware.

--required   fail where it cannot be had, instead of falling back to the 64-bit port
"""

import argparse
import sys

from host.version import add_version

from . import debian, ports


def main(arguments=None):
    """Exit code: 0 there is a MicroPython to use, 1 not, or with --required not the 32-bit one."""
    parser = argparse.ArgumentParser(prog="python -m host.micropython", description="Fetch the MicroPython with the board's word size.")
    parser.add_argument("--required", action="store_true", help="fail where it cannot be had, instead of falling back to the 64-bit port")
    add_version(parser)
    options = parser.parse_args(arguments)
    try:
        if not (ports.HOME.is_dir() and ports.ask(ports.command32(ports.HOME))):
            print("Fetching the 32-bit MicroPython (3 MB, and Debian's package lists)", flush=True)
            debian.fetch()
        print("The firmware runs on the 32-bit MicroPython, with the board's heap.")
        return 0
    except debian.CannotFetch as trouble:
        print(f"No 32-bit MicroPython: {trouble}.", file=sys.stderr)
    except ports.ToolMissing as trouble:
        print(trouble, file=sys.stderr)
        return 1
    if options.required:
        return 1
    try:
        ports.find("micropython64")
    except ports.ToolMissing as trouble:
        print(trouble, file=sys.stderr)
        return 1
    print(
        "The firmware runs on the 64-bit MicroPython instead, with twice the heap; what it takes of the board's memory is not measured then.", file=sys.stderr
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
