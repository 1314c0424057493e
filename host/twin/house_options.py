"""What the command line says about the course house."""

import argparse

from .errand import ALARM
from .house import OPEN, SHUT, Plan
from .simulation import PASS

NAME = "house"


def add(parser):
    """The options of the course house."""
    add = parser.add_argument_group(
        "house", "paper C's two rooms, or a map drawn by hand, and an errand in it (docs/goals.md); --start and --goal in mm on the map"
    ).add_argument
    add("--map", metavar="FILE", help="map drawn by hand, JSON (default maps/house.json)")
    add("--door", type=_door, metavar="MM|shut|open", help="how far the first door is open (default 600 of 900 in the paper's house)")
    add("--walled", action="store_true", help="a ring round the goal")
    add("--boxes", type=int, default=0, metavar="N", help="boxes that the map does not have")
    add("--pocket", action="store_true", help="a U-shaped pocket on the way")
    add("--person", action="store_true", help="a box as large as a person crosses the way, 300 mm/s")
    add("--shuts", type=float, metavar="S", help="the door shuts after so many seconds")
    add("--opens", type=float, metavar="S", help="it opens after so many")
    add("--go-on", action="store_true", help="after an alarm, and once the door is open, tell the robot to go on")
    add("--lost", action="store_true", help="nobody tells the robot where it is: it may be anywhere")
    add("--method", choices=("gap", "field", "behaviour"), help="how it makes for the goal (default: as robot.json says)")
    add("--cruise", type=int, metavar="V", help="drive.cruise, 91 to 180")


def plan(options):
    """The house.Plan of the options, None for another course. ValueError for options of a house with another course."""
    given = {name: getattr(options, name) for name in ("map", "door", "walled", "boxes", "pocket", "person", "shuts", "opens", "go_on", "lost", "method")}
    if options.course != NAME:
        for name, value in given.items():
            if value:
                raise ValueError(f"--{name.replace('_', '-')} is for the course house")
        return None
    if not 0 <= options.boxes <= 40:
        raise ValueError(f"--boxes {options.boxes}: 0 to 40 are accepted")
    return Plan(start=options.start, goal=options.goal, **given)


def expected(options, result):
    """Whether the result is what was asked for: with a shut door and no other way, or a walled goal, the alarm is."""
    if options.course == NAME and (options.door == SHUT or options.walled) and result.result == ALARM:
        return True
    return result.result == PASS


def _door(text):
    if text in (SHUT, OPEN):
        return text
    try:
        width = float(text)
    except ValueError:
        width = -1.0
    if not 0 <= width <= 3000:
        raise argparse.ArgumentTypeError(f"{text!r} is no door; mm from 0 to 3000, shut or open are accepted")
    return width
