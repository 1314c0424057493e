"""As bootstrap.py, where CPython plays the board.

    bootstrap_cpython.py READ_FD WRITE_FD TICKS CAUSE BOARD FIRMWARE ROOT

BOARD: folder of charge, lockstep, machine and time.  FIRMWARE: folder of main and lib.  ROOT: where `host.compat` is found.
"""

import sys
from importlib.util import module_from_spec, spec_from_file_location

_board, _firmware, _root = sys.argv[5:8]


def _take_over(name):
    """Make the board's module the one that `import name` gives, though the interpreter has one of its own."""
    spec = spec_from_file_location(name, _board + "/" + name + ".py")
    sys.modules[name] = module = module_from_spec(spec)
    spec.loader.exec_module(module)


sys.path[:] = ["", _board, _firmware, _firmware + "/lib", *sys.path[1:], _root]
from host import compat
from host.compat.streams import Output

compat.install(_firmware)
sys.stdout = Output(sys.stdout)

import charge
import lockstep

_take_over("time")
_take_over("machine")
lockstep.connect(*[int(word) for word in sys.argv[1:5]])
charge.load("chip.json")
try:
    with open("fault.json") as _file:
        import json

        import fault

        fault.load(json.load(_file))
except OSError:
    pass  # nothing is to fail

try:
    import main  # noqa: F401
except (Exception, KeyboardInterrupt):
    lockstep.flush()  # what it did on its way out belongs to the run
    raise
