"""Command line of the maps: python -m host.map FILE"""

import argparse
import sys
from pathlib import Path

from host.floorplan import board_file, drawn, picture
from host.floorplan.errors import MapError
from host.version import add_version

from . import check

DONE, FAULTY, MISUSED = 0, 1, 2


def main(arguments=None) -> int:
    options = _parser().parse_args(arguments)
    try:
        path = Path(options.file)
        house = drawn.read(path) if path.suffix.lower() == ".json" else picture.read(path, options.cell)
        data = board_file.encode(house)
        print(check.summary(house))
        for note in house.notes:
            print(f"  {note}")
        print(f"  {len(data)} bytes on the board")
        found = check.faults(house)
        for fault in found:
            print(f"  wrong: {fault}")
        if options.picture:
            from .draw import draw

            draw(house, Path(options.picture))
            print(f"picture: {options.picture}")
        if options.output:
            Path(options.output).write_bytes(data)
            print(f"map for the board: {options.output}")
        if options.send:
            if found:
                raise MapError("not sent: put right what is wrong first, or write it with --output and look at it")
            _send(options.send, data)
    except (MapError, OSError) as error:
        print(f"python -m host.map: {error}", file=sys.stderr)
        return MISUSED
    return FAULTY if found else DONE


def _send(address: str, data: bytes) -> None:
    from host import link

    from .send import send

    try:
        with link.connect(address) as robot:
            print(send(robot, data) or "sent")
    except (link.AddressError, link.LinkError) as error:
        raise MapError(str(error)) from None


def _parser():
    parser = argparse.ArgumentParser(
        prog="python -m host.map",
        description="Make the board's map from a map_server pair of ROS, a picture or a drawing in JSON; check it, draw it, send it.",
        epilog="exit code: 0 all is well, 1 something is wrong with the map, 2 it cannot be read or sent",
    )
    add_version(parser)
    add = parser.add_argument
    add("file", metavar="FILE", help="map.yaml of ROS, a picture with NAME.json beside it, or rows of 0, 1, x in JSON (docs/goals.md)")
    add("--cell", type=int, metavar="MM", help="side of a cell (default: the smallest that the board holds)")
    add("--picture", metavar="FILE", help="draw the map (.png, .svg or .pdf)")
    add("--output", metavar="FILE", help="write the board's file")
    add("--send", metavar="ADDRESS", help="send it to the robot: serial:/dev/ttyUSB0, udp:..., any address of the monitor; counts from the next start")
    return parser


if __name__ == "__main__":
    sys.exit(main())
