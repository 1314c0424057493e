"""First thing to run on the simulated board: puts the board's `machine` and `time` in place and starts main.py.

    micropython -m bootstrap READ_FD WRITE_FD TICKS CAUSE

in a folder that holds what the board does (main, lib/) and, in board/, charge, lockstep, machine and time.
"""

import gc
import sys

sys.path[:] = ["", "board", "lib"]
_NAMES = 980  # with those of the board more than 1260

import charge
import lockstep

for _name in ("time", "machine", "machine_more"):
    sys.modules.pop(_name, None)
    sys.modules[_name] = __import__(_name)  # the file comes before the built-in one
lockstep.connect(*[int(word) for word in sys.argv[1:5]])
charge.load("chip.json")
try:
    with open("fault.json") as _file:
        import json

        import fault

        fault.load(json.load(_file))
except OSError:
    pass  # nothing is to fail
for _name in range(_NAMES):
    hasattr(sys, "~%d" % _name)  # each is a name from now on: see memory.py
gc.collect()  # main.py begins with what the twin has measured; see memory.py there

try:
    import main  # noqa: F401
except (Exception, KeyboardInterrupt):
    lockstep.flush()  # what it did on its way out belongs to the run
    raise
