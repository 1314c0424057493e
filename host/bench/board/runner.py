"""Runs the firmware's main.py on a tape under MicroPython and writes down what each part of its loop took.

    runner.py WHAT TAPE LOG TWIN_BOARD FIRMWARE BASELINES [DECISIONS FULL PAPER PLAIN | COSTS]

WHAT: time   microseconds of each part here; of DECISIONS decisions, FULL of which are made in full, the baselines make PAPER of all, PAPER and PLAIN of
           those in full, spread evenly
      count  instructions on the ESP32: FIRMWARE has counters, COSTS (i32 each) says what each counted block costs
      decisions  what it decides and writes, see record.py
      calibrate  instructions of each method that the twin charges for, see meter.py: FIRMWARE has counters; COSTS; SIZES: JSON, see charge.begin
      heap   heap that the steady loop takes, and the bytes of all buffers
LOG   time and count: the rows of log.py as i32. TURN is what the rest of a turn of the loop took, its extra the whole turn. count: after
      the rows the counters of the worst row of each kind
      heap: one line of JSON
"""

import gc
import sys
import time as clock

_what, _tape, _path, _twin_board, _firmware, _baselines = sys.argv[1:7]
sys.path[:] = [sys.argv[0].rsplit("/", 1)[0], _twin_board, _firmware, _firmware + "/lib", _baselines]


def _take_over(name):
    """Make the board's module the one that `import name` gives."""
    sys.modules.pop(name, None)
    sys.modules[name] = __import__(name)


import lockstep

_take_over("time")
_take_over("machine")


def _measure():
    """Watch the robot as soon as there is one; write the log at the end."""
    import log
    import watch

    watching = None

    def step(time):
        nonlocal watching
        robot = getattr(sys.modules.get("main"), "robot", None)
        if watching is None and robot is not None:
            watching = watch.Counter(robot, sys.argv[7]) if _what == "count" else watch.Stopwatch(robot, clock, *[int(word) for word in sys.argv[7:11]])

    def end():
        lockstep.on_step, lockstep.on_end = None, lambda: None  # the firmware switches off yet
        log.save(_path, watching.worst_counters if _what == "count" else ())
        sys.exit(0)

    gc.disable()
    lockstep.on_step, lockstep.on_end = step, end


def _record():
    import record

    recorder = record.Recorder(_path)

    def end():
        lockstep.on_step, lockstep.on_write, lockstep.on_end = None, None, lambda: None  # the firmware switches off yet
        recorder.close()
        sys.exit(0)

    lockstep.on_step, lockstep.on_write, lockstep.on_end = recorder.step, recorder.write, end


def _calibrate():
    import json

    import charge
    import meter

    with open(sys.argv[8]) as file:
        charge.begin(0, json.load(file))
    metered = meter.Meter(_path, sys.argv[7])

    def end():
        lockstep.on_end = lambda: None  # the firmware switches off yet
        metered.close()
        sys.exit(0)

    gc.disable()
    lockstep.on_end = end


if _what == "calibrate":
    _calibrate()
elif _what == "decisions":
    _record()
elif _what == "heap":
    import heap

    heap.watch(_path)
else:
    _measure()
lockstep.connect(_tape)

import main  # noqa: F401
