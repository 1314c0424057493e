"""Command line of the arm."""

import argparse
import json
import math
import sys

from host.version import add_version

from . import check, model, planning, reach, scenes, search
from .errors import ArmError

DONE, FAILED, MISUSED = 0, 1, 2
_LISTS = ("--from", "--to", "--obstacle", "--box", "--half-plane", "--floor", "--from-joints", "--to-joints", "--joints", "--extra")


def main(arguments=None) -> int:
    """Returns the exit code: 0 done, 1 nothing valid was found or the trajectory is not valid, 2 what was asked for is impossible or bad."""
    options = _parser().parse_args(_joined(sys.argv[1:] if arguments is None else list(arguments)))
    try:
        return options.run(options)
    except ArmError as error:
        if getattr(options, "json", False):
            print(json.dumps({"refused": str(error)}))
        print(f"python -m host.arm: {error}", file=sys.stderr)
        return MISUSED
    except KeyboardInterrupt:
        return FAILED
    except BrokenPipeError:
        sys.stderr.close()
        return FAILED


def _joined(arguments):
    """argparse takes -2000,500,190 for an option: such values are tied to the option before them."""
    joined: list[str] = []
    for one in arguments:
        if joined and joined[-1] in _LISTS and one[:1] == "-" and one[1:2] in "0123456789.":
            joined[-1] = f"{joined[-1]}={one}"
        else:
            joined.append(one)
    return joined


def _plan(options) -> int:
    return planning.run(options)


def _check(options) -> int:
    found = reach.read(options.file)
    wrong, figures = check.check(found, options.clearance / 1000)
    if options.csv:
        reach.write_csv(found, options.csv)
    if options.json:
        print(json.dumps({"valid": not wrong, "wrong": wrong, **figures}))
    else:
        print("valid" if not wrong else "\n".join(f"not valid: {line}" for line in wrong))
        print(planning.words(figures))
    return FAILED if wrong else DONE


def _play(options) -> int:
    return _on_robot(options, "play")


def _home(options) -> int:
    return _on_robot(options, "home")


def _on_robot(options, word) -> int:
    from host.link import AddressError, LinkError

    from . import play

    def say(text):
        if not options.json:
            print(text, flush=True)

    try:
        if word == "play":
            found = reach.read(options.file)
            wrong, _ = check.check(found)
            if wrong and not options.unchecked:
                raise ArmError(f"{options.file}: not valid: {wrong[0]}; see python -m host.arm check; --unchecked plays it all the same")
            play.play(options.address, found, say)
        else:
            play.home(options.address, options.arm and model.load(options.arm), say)
    except (AddressError, LinkError) as error:
        raise ArmError(str(error)) from None
    if options.json:
        print(json.dumps({word: "done"}))
    return DONE


def _demo(options) -> int:
    from . import demo

    return demo.run(options.out, options.scene, options.seed, options.json)


def _draw(options) -> int:
    from . import picture

    found = reach.read(options.file)
    animated = options.picture.endswith((".gif", ".apng"))
    (picture.animate if animated else picture.draw)(found, options.picture)
    print(f"written: {options.picture}")
    return DONE


def _report(options) -> int:
    from pathlib import Path

    from . import report

    return report.run(options.parts or report.PARTS, options.seeds, Path(options.out), options.again, options.scenes)


def _numbers(count, what, more=0):
    def parse(text):
        try:
            values = [float(part) for part in text.split(",")]
        except ValueError:
            values = []
        if not (count <= len(values) <= count + more) or not all(math.isfinite(v) for v in values):
            raise argparse.ArgumentTypeError(f"{text!r}: {what} is needed, numbers with commas between them")
        return values

    return parse


def _number(low, high):
    def parse(text):
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text!r}: a number {low:g} .. {high:g} is needed")
        return value

    return parse


def _whole(low, high):
    def parse(text):
        if not text.isdigit() or not low <= int(text) <= high:
            raise argparse.ArgumentTypeError(f"{text!r}: a whole number {low} .. {high} is needed")
        return int(text)

    return parse


def _parser():
    parser = argparse.ArgumentParser(
        prog="python -m host.arm",
        description="Plan, check and play trajectories of a planar arm. Lengths in mm, angles in degrees, counter-clockwise, 0 along x.",
        epilog="exit code: 0 done, 1 nothing valid found or not valid, 2 impossible or bad arguments",
    )
    add_version(parser)
    words = parser.add_subparsers(required=True, metavar="WORD")
    _plan_options(words.add_parser("plan", help="find a trajectory from one pose to another past obstacles"))
    one = words.add_parser("check", help="an independent look at a trajectory, whoever made it")
    one.set_defaults(run=_check)
    one.add_argument("file", metavar="reach.json")
    one.add_argument("--clearance", type=_number(0, 1000), default=3.0, metavar="MM", help="what is to be kept from obstacles (default 3)")
    one.add_argument("--csv", metavar="FILE", help="write the curves: angle, speed, acceleration and torque of each joint, place of the end")
    one.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    one = words.add_parser("play", help="play a trajectory on a robot or its twin")
    one.set_defaults(run=_play)
    one.add_argument("address", metavar="ADDRESS", help="serial:/dev/ttyUSB0, udp:robot.local, twin:z (which gets the trajectory's arm)")
    one.add_argument("file", metavar="reach.json")
    one.add_argument("--unchecked", action="store_true", help="even if the check finds something wrong; the board has its own checks")
    one.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    one = words.add_parser("home", help="go to the rest pose, slowly; switches the servos on first")
    one.set_defaults(run=_home)
    one.add_argument("address", metavar="ADDRESS")
    one.add_argument("--arm", metavar="FILE|NAME", help="for a twin: its arm")
    one.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    one = words.add_parser("draw", help="draw a trajectory (.png, .svg, .pdf), or animate it (.gif)")
    one.set_defaults(run=_draw)
    one.add_argument("file", metavar="reach.json")
    one.add_argument("picture", metavar="PICTURE")
    one = words.add_parser("demo", help="plan the paper's experiment II, play it on the firmware in the twin, draw and animate it")
    one.set_defaults(run=_demo)
    one.add_argument("--scene", choices=sorted(scenes.SCENES), default="paper-2")
    one.add_argument("--seed", type=_whole(0, 2**31 - 1), default=0, metavar="N")
    one.add_argument("--out", default="out/arm", metavar="FOLDER", help="where the files go (default out/arm)")
    one.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    one = words.add_parser("report", help="the paper's experiments beside ours: docs/arm-results.md")
    one.set_defaults(run=_report)
    one.add_argument(
        "--parts", nargs="*", choices=("planned", "genetic", "roulette", "global", "masses", "speed", "random"), help="only these are computed (default all)"
    )
    one.add_argument("--seeds", type=_whole(1, 1000), default=20, metavar="N", help="searches of each kind (default 20)")
    one.add_argument("--scenes", type=_whole(2, 10000), default=100, metavar="N", help="random ones (default 100)")
    one.add_argument("--again", action="store_true", help="compute anew what out/arm-results.json has")
    one.add_argument("--out", default="docs", metavar="FOLDER", help="where it goes (default docs)")
    return parser


def _plan_options(one):
    one.set_defaults(run=_plan)
    add = one.add_argument
    add(
        "--arm", default="paper-3r", metavar="FILE|NAME", help=f"arm.json, or {', '.join(sorted(p.stem for p in model.ARMS.glob('*.json')))} (default paper-3r)"
    )
    add("--scene", choices=sorted(scenes.SCENES), help="obstacles and poses of the paper's experiments; other options add to it or take their place")
    pose = _numbers(3, "X,Y,ANGLE")
    add("--from", dest="start", type=pose, metavar="X,Y,ANGLE", help="where the end is at first")
    add("--to", dest="end", type=pose, metavar="X,Y,ANGLE", help="where it is to be")
    angles = _numbers(1, "one angle a joint", model.MOST_JOINTS - 1)
    add("--from-joints", type=angles, metavar="Q,..", help="instead of --from: the joints' angles")
    add("--to-joints", type=angles, metavar="Q,..", help="instead of --to")
    add("--obstacle", action="append", default=[], type=_numbers(3, "X,Y,R"), metavar="X,Y,R", help="a disc; may be given again")
    add(
        "--box",
        action="append",
        default=[],
        type=_numbers(4, "X,Y,WIDTH,HEIGHT[,ANGLE]", 1),
        metavar="X,Y,W,H[,A]",
        help="a box round its centre; may be given again",
    )
    add(
        "--half-plane", action="append", default=[], type=_numbers(3, "X,Y,ANGLE"), metavar="X,Y,ANGLE", help="all beyond a line; ANGLE points to the free side"
    )
    add("--floor", type=_numbers(1, "Y"), metavar="Y", help="all below this height")
    add("--clearance", type=_number(0, 1000), default=3.0, metavar="MM", help="kept from obstacles (default 3)")
    add("--method", choices=search.METHODS, default="ga+cma", help="the paper's genetic algorithm, it and CMA-ES after it (default), or CMA-ES alone")
    add("--selection", choices=("tournament", "roulette"), default="tournament", help="of the genetic algorithm")
    add("--population", type=_whole(10, 10000), default=200, metavar="N", help="of the genetic algorithm (default 200)")
    add("--generations", type=_whole(1, 100000), metavar="N", help="of the genetic algorithm (default 60, alone 300)")
    add("--crossover", type=_number(0, 1), default=0.8, metavar="P", help="its probability (default 0.8)")
    add("--mutation", type=_number(0, 1), default=0.05, metavar="P", help="its probability, of a gene (default 0.05)")
    add("--nodes", type=_whole(1, 4), default=1, metavar="N", help="between start and end (default 1, as in the paper)")
    add("--seed", type=_whole(0, 2**31 - 1), default=0, metavar="N", help="of the search: the same seed finds the same (default 0)")
    add("--limit-time", type=_number(0.05, 86400), default=60.0, metavar="S", help="end the search after this and keep the best so far (default 60)")
    add("--out", metavar="FILE", help="where the trajectory goes, reach.json")
    add("--csv", metavar="FILE", help="where its curves go")
    add("--picture", metavar="FILE", help="draw it (.png, .svg or .pdf)")
    add("--json", action="store_true", help="print one JSON object with the result and nothing else")
