"""Runs the firmware on a tape and writes down what the planner knows at each decision that takes two moves. Runs under MicroPython.

    watch.py TAPE LOG BENCH_BOARD TWIN_BOARD FIRMWARE

LOG: a line of JSON for each such decision, and a shorter one for each in which candidates were checked best first; buffers in hexadecimal. Nothing in the firmware is changed: its stages are called through a
function that looks on.
"""

import json
import sys
from binascii import hexlify

_tape, _path, _bench_board, _twin_board, _firmware = sys.argv[1:6]
sys.path[:] = [_bench_board, _twin_board, _firmware, _firmware + "/lib"]


def _take_over(name):
    """Make the board's module the one that `import name` gives."""
    sys.modules.pop(name, None)
    sys.modules[name] = __import__(name)


import lockstep

_take_over("time")
_take_over("machine")

_log = open(_path, "w")
_kept = {}  # the grid made last, and the pose from which the points were looked at last


def _hex(buffer):
    return hexlify(bytes(buffer)).decode()


def _words(buffer, n):
    return [buffer[i] for i in range(n)]


def _grid(decision):
    """A cost to go has just been made: what it was made of is still there."""
    made = decision.cost_to_go
    _kept["grid"] = {
        "cost": _hex(made.cost),
        "scratch": _hex(made.scratch),
        "corner": [made.grid[0], made.grid[1]],
        "cell": made.grid[2],
    }


def _pair(decision):
    """Two moves, or the best single one, have been chosen, and the first has been looked at again among the points as they are now."""
    two, plan, ways, here = decision.two_step, decision.plan, decision.ways, decision.map
    n = two.count
    if "grid" not in _kept:
        return
    line = {
        "time_us": lockstep.now,
        "grid": _kept["grid"],
        "pose": _kept["pose"],
        "x": _words(ways.x, ways.n),
        "y": _words(ways.y, ways.n),
        "near": ways.near,
        "map_x": _words(here.x, here.count),
        "map_y": _words(here.y, here.count),
        "first": {"mirroring": _words(two.mirroring, n), "candidate": _words(two.candidate, n), "length": _words(two.length, n)},
        "chosen": two.chosen,
        "found": bool(two.found),
        "second": [two.second_mirroring, two.second_candidate, two.second_length],
        "taken": [plan.mirroring, plan.candidate, plan.free],
    }
    _log.write(json.dumps(line) + "\n")


def _checked(decision):
    """The best single move is about to be taken, or not; candidates have been checked best first."""
    bounds = _kept.pop("bounds", {})
    count = decision.candidates.count
    if len(bounds) == 2:
        line = {
            "time_us": lockstep.now,
            "bounds": [bounds[side] for side in (0, 1)],
            "scores": [_words(decision.scores[side], 5 * count) for side in (0, 1)],
            "free": [_words(decision.ways.free_of[side], count) for side in (0, 1)],
        }
        _log.write(json.dumps(line) + "\n")


def _watch(decision):
    ways = decision.ways
    look = type(ways).look

    def looked(x, y, heading):
        _kept["pose"] = [x, y, heading]
        look(ways, x, y, heading)

    ways.look = looked
    bound, choose, settle = decision.STAGES[2], decision.STAGES[4], decision.STAGES[-1]

    def looking_on(stage):
        def call(decision, odometry):
            renewing, side = decision.renewing, decision.side
            if stage is choose:
                _checked(decision)
            comes_next = stage(decision, odometry)
            if renewing and not decision.renewing:
                _grid(decision)
            elif stage is bound:
                _kept.setdefault("bounds", {})[side] = _words(decision.scores[side], 5 * decision.candidates.count)
            elif stage is settle:
                _pair(decision)
            return comes_next

        return call

    decision.STAGES = tuple(looking_on(stage) for stage in decision.STAGES)


def _step(time):
    avoid = getattr(getattr(sys.modules.get("main"), "robot", None), "avoid", None)
    if avoid is not None:
        _watch(avoid.decision)
        lockstep.on_step = None


def _end():
    lockstep.on_step, lockstep.on_end = None, lambda: None  # the firmware switches off yet
    _log.close()
    sys.exit(0)


lockstep.on_step, lockstep.on_end = _step, _end
lockstep.connect(_tape)

import main  # noqa: F401
