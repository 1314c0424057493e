"""Command line of the twin."""

import argparse
import json
import os
import sys

from host.recording import RecordingError
from host.version import add_version, python

from . import check, courses, faults, house_options, worlds
from .console import Progress, summary_line
from .image import FIRMWARE, ToolMissing
from .process import ENGINES
from .run import MODES, load_config, run
from .screen import KINDS

PASSED, FAILED, MISUSED = 0, 1, 2
LIST = "list"
CHECKED = (
    "course",
    "width",
    "gap",
    "seed",
    "mode",
    "engine",
    "speed",
    "config",
    "mirror",
    "reverse",
    "angle",
    "scale",
    "length",
    "side",
    "start",
    "goal",
    "record",
)  # before
# the run


def main(arguments=None):
    """Run the twin; returns the exit code: 0 pass, 1 any other result, 2 bad arguments."""
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.fault == LIST:
        print("\n".join(faults.listing()))
        return PASSED
    if options.course is None:
        parser.error("the following arguments are required: COURSE")
    progress = None if options.json else Progress(_say)
    try:
        plan = house_options.plan(options)
        if plan is None:
            check.check({name: getattr(options, name) for name in CHECKED})
        if options.picture:
            check.picture(options.picture)
        changes = dict(options.changes or {})
        if options.cruise:
            changes["drive.cruise"] = options.cruise
        if options.screen:
            check.picture(options.screen, "--screen", (".png",))
            changes |= _screen(options)
        result = run(
            options.course,
            options.width,
            500.0 if options.gap is None else options.gap,
            options.seed,
            options.mode,
            options.engine,
            options.speed,
            options.config,
            watch=progress,
            mirror=options.mirror,
            reverse=options.reverse,
            angle=options.angle,
            scale=options.scale,
            firmware=options.firmware or FIRMWARE,
            record=options.record,
            chip=options.chip,
            changes=changes,
            fault=options.fault,
            length=options.length,
            side=options.side,
            start=None if plan else options.start,
            goal=None if plan else options.goal,
            limit_s=options.limit,
            house=plan,
        )
    except (ValueError, ToolMissing, SyntaxError, RecordingError) as error:
        print(f"python -m host.twin: {error}", file=sys.stderr)
        return MISUSED
    except KeyboardInterrupt:
        return FAILED
    _tell(result, options)
    return PASSED if house_options.expected(options, result) else FAILED


def _say(text):
    """Print a line; when whoever read them, head or less, has seen enough, the rest goes nowhere."""
    try:
        print(text, flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _tell(result, options):
    """The result first: what goes wrong with the picture must not lose it."""
    _say(json.dumps(result.summary(best=True)) if options.json else summary_line(result))
    if options.picture:
        from .picture import draw

        try:
            draw(result, options.picture)
        except (OSError, ValueError) as error:
            print(f"python -m host.twin: {error}", file=sys.stderr)
        else:
            if not options.json:
                _say(f"picture: {options.picture}")
    if options.screen:
        try:
            result.glass.picture().save(options.screen)
        except OSError as error:
            print(f"python -m host.twin: {options.screen} cannot be written: {error.strerror}", file=sys.stderr)
        else:
            if not options.json:
                _say(f"screen: {options.screen}")
    if result.lost:
        print(f"python -m host.twin: {result.lost}", file=sys.stderr)
    if result.recording:
        print(f"recorded; to replay it: {again(result.recording)}", file=sys.stderr)


def again(recording):
    """The command that replays a recording, for the Python that runs this."""
    return f"{python()} -m host.replay {recording}"


def _screen(options):
    """The changes to robot.json for a robot that has no screen yet."""
    kind = options.screen_kind
    if kind is None and load_config(options.config).get("screen", {}).get("kind", "none") == "none":
        kind = KINDS[0]
    return {"screen.kind": kind} if kind else {}


def _parser():
    parser = argparse.ArgumentParser(
        prog="python -m host.twin",
        description="Drive a course in the digital twin with the robot's own firmware.",
        epilog="exit code: 0 passed, 1 any other result, 2 bad arguments",
    )
    add_version(parser)
    add = parser.add_argument
    add(
        "course",
        metavar="COURSE",
        type=_course,
        nargs="?",
        help=", ".join((*courses.NAMES, house_options.NAME)) + "; or the file of a world: " + ", ".join(worlds.SUFFIXES),
    )
    add("--width", type=float, metavar="MM", help="width of the passage (default 550; of the alley 450)")
    add("--length", type=float, metavar="MM", help="alley: from its mouth to its closed end (default 2500)")
    add("--side", action="store_true", help="alley: closed at the other end too, with an arm to the right as the way out")
    add("--start", type=_start, metavar="X,Y,HEADING", help="of a world from a file: where the robot starts, mm, and degrees clockwise from +y")
    add(
        "--goal",
        type=_goal,
        metavar="X,Y",
        help="of a world from a file: it is through within 500 mm of it, mm (default: outside all walls, or as the file says)",
    )
    add("--limit", type=float, metavar="S", help="end the run after so many seconds (default 60; worlds from files 200)")
    add("--gap", type=float, metavar="MM", help="random: least distance between obstacles (default 500)")
    add("--seed", type=_seed, default=0, metavar="N", help="of the robot's imperfections and the noise; other than 0 also shifts the start")
    add("--mode", type=str.lower, choices=MODES, help="all axles steer, or the last one stays straight (default: as robot.json says)")
    add("--engine", choices=ENGINES, default=ENGINES[0], help="what runs the firmware")
    add("--speed", type=_speed, default=None, metavar="X|max", help="factor on real time, or max (default)")
    add("--chip", type=_chip, metavar="X|inf", help="factor on the speed of the ESP32 that computes (default 1); inf: takes no time")
    add("--config", metavar="FILE", help="robot.json to use (default firmware/robot.json)")
    add("--firmware", metavar="FOLDER", help="main.py and lib/ to run (default firmware/)")
    add("--fault", type=_fault, metavar="NAME[@SECONDS]", help="what fails, and when (default: once it drives and 4 s have passed); list: shows the names")
    add("--no-autostart", dest="changes", action="store_const", const={"drive.autostart": False}, help="wait for a start, as the robot does after power-up")
    add("--json", action="store_true", help="print one JSON object with the result and nothing else")
    recording = parser.add_mutually_exclusive_group().add_argument
    recording("--record", metavar="FILE", help="record the run (without it, a run that ends badly leaves a recording in out/ended-badly)")
    recording("--no-record", dest="record", action="store_const", const=False, help="never record")
    add("--picture", metavar="FILE", help="draw the run (.png, .svg or .pdf)")
    add("--screen", metavar="FILE", help="give the robot a touch screen if it has none, and keep what it shows in the end (.png)")
    add("--screen-kind", choices=KINDS, help="its dialect (default: as robot.json says, else usart-gpu)")
    add("--mirror", action="store_true", help="the course with left and right exchanged")
    add("--reverse", action="store_true", help="enter from the other end")
    add("--angle", type=float, default=90.0, metavar="DEG", help="bend: angle of its two bends (default 90)")
    add("--scale", type=float, default=1.0, metavar="X", help="factor on the area, and so on the length of the legs; not on the width (default 1)")
    house_options.add(parser)
    return parser


def _place(text, count, what):
    try:
        values = tuple(float(v) for v in text.split(","))
        if len(values) != count or not all(abs(v) < 1e6 for v in values):
            raise ValueError
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not {what}; write it like {'1200,-300,90' if count == 3 else '1200,-300'}") from None
    return values


def _start(text):
    return _place(text, 3, "a start")


def _goal(text):
    return _place(text, 2, "a goal")


def _course(text):
    if worlds.is_file(text):
        return text
    names = {name.lower(): name for name in (*courses.NAMES, house_options.NAME)}
    if text.lower() not in names:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a course; courses are {', '.join(courses.NAMES)}, or a file with a name in {', '.join(worlds.SUFFIXES)}"
        )
    return names[text.lower()]


def _fault(text):
    if text != LIST:
        try:
            faults.make(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None
    return text


def _seed(text):
    if not text.isdigit():
        raise argparse.ArgumentTypeError(f"{text!r} is not a seed; whole numbers from 0 are accepted")
    return int(text)


def _chip(text):
    try:
        factor = float(text)
    except ValueError:
        factor = 0.0
    if not 0.05 <= factor:
        raise argparse.ArgumentTypeError(f"{text!r} is not a chip's speed; a factor from 0.05 or inf is accepted")
    return factor


def _speed(text):
    if text == "max":
        return None
    try:
        speed = float(text)
    except ValueError:
        speed = 0
    if not 0.01 <= speed <= 1000:
        raise argparse.ArgumentTypeError(f"{text!r} is not a speed; a factor from 0.01 to 1000 or max is accepted")
    return speed
