"""Command line of the monitor."""

import argparse
import asyncio
import os
import sys
import webbrowser

from host.link import AddressError, LinkError
from host.link.address import FORMS
from host.recording import RecordingError
from host.version import add_version, python

TWIN = "twin:z?width=550"


def main(arguments=None) -> int:
    """Run the monitor; returns the exit code: 0 closed by the person, 1 no robot, 2 bad arguments."""
    options = _parser().parse_args(arguments)
    address = options.address or find()
    if address is None:
        print(f"no robot on USB, none in the network. See the twin instead: {python()} -m host.monitor {TWIN!r}", file=sys.stderr)
        return 1
    try:
        from .station import Station

        station = Station(address, options.record)
    except (AddressError, LinkError, RecordingError) as error:
        print(f"python -m host.monitor: {error}", file=sys.stderr)
        # A robot that is not there may come; a file that is not there, or a name that is none, was written wrongly.
        return 1 if isinstance(error, LinkError) and not address.startswith("file:") else 2
    try:
        if options.text:
            from .text import run

            return run(station)
        return _serve(station, options)
    except KeyboardInterrupt:
        return 0
    except BrokenPipeError:  # whoever read it, head or less, has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    finally:
        station.close()


def find() -> str | None:
    """The robot that is meant when none is named: a board on USB, else one in the network, else, if the person agrees, the twin."""
    from host.link import discover

    boards = discover.boards()
    if trouble := discover.trouble():
        print(trouble, file=sys.stderr)
    if boards:
        return _only(boards)
    print("no board on USB; listening for robots in the network ...", file=sys.stderr)
    robots = [address for address, _ in discover.robots()]
    if robots:
        return _only(robots)
    if sys.stdin.isatty():
        answer = input(f"No robot found. Start the twin ({TWIN})? [Y/n] ")
        if answer.strip().lower() in ("", "y", "yes"):
            return TWIN
    return None


def _only(found: list[str]) -> str:
    if len(found) > 1:
        print(f"several robots: {', '.join(found)}; taking the first", file=sys.stderr)
    return found[0]


def _serve(station, options) -> int:
    try:
        from .server import Server
    except ImportError:
        print("microdot is not installed for this Python: run `make setup` and use .venv/bin/python", file=sys.stderr)
        return 1
    try:
        server = Server(station, "0.0.0.0" if options.share else "127.0.0.1", options.port)
    except OSError as error:
        print(f"port {options.port} cannot be used: {error.strerror}; give another with --port, or 0 for any", file=sys.stderr)
        return 1
    here, *elsewhere = server.addresses
    print(f"{station.address} is at {here}", flush=True)
    for other in elsewhere:
        print(f"from a phone or another computer: {other}", flush=True)
    if elsewhere:
        print(
            "the page and its key go over the network unencrypted: whoever listens there can drive the robot; share it only in a network of your own",
            file=sys.stderr, flush=True,
        )  # fmt: skip
    if not options.no_browser:
        webbrowser.open(here)
    asyncio.run(server.run())
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m host.monitor", description="See the robot, drive it, tune it, record it.", epilog="exit code: 0 closed, 1 no robot, 2 bad arguments"
    )
    add_version(parser)
    add = parser.add_argument
    add("address", nargs="?", metavar="ADDRESS", help=f"one of: {FORMS}; without it, the robot that is found")
    add("--text", action="store_true", help="in this terminal instead of a browser")
    add("--port", type=int, default=0, metavar="N", help="port of the page (default: any free one)")
    add("--no-browser", action="store_true", help="serve the page without opening it")
    add("--share", action="store_true", help="let other devices of the network open the page too, a phone for example")
    add("--record", metavar="FILE", help="record from the start; of the twin, a recording that can be replayed")
    return parser
