"""Puts each fault into a run of the twin and writes what the robot did into docs/safety.md."""

import argparse
import sys

from host.version import add_version

from . import KINDS, table


def main(arguments=None):
    """Returns the exit code: 0 written (or measured, with names), 1 with --check when a promise was broken."""
    parser = argparse.ArgumentParser(prog="python -m host.twin.faults", description=__doc__, epilog="With names or --quick the page stays as it is.")
    add_version(parser)
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these faults (python -m host.twin --fault list shows all)")
    parser.add_argument("--quick", action="store_true", help=f"only {', '.join(table.QUICK)}")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="runs at a time (default 2)")
    parser.add_argument("--check", action="store_true", help="exit code 1 when a promise was broken")
    options = parser.parse_args(arguments)
    for name in options.names:
        if name not in KINDS:
            parser.error(f"{name!r} is no fault; python -m host.twin --fault list shows them")
    names = options.names or (table.QUICK if options.quick else None)
    rows = []
    for row in table.measure(names, max(options.jobs, 1)):
        rows.append(row)
        print(f"{len(rows)} {row.kind.name}", file=sys.stderr, flush=True)
    text = table.markdown(rows)
    print(text)
    if names is None:
        table.write(text)
        print(f"written into {table.PAGE}", file=sys.stderr)
    return 1 if options.check and not all(row.kept for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
