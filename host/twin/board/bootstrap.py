"""First thing to run on the simulated board: puts the board's `machine` and `time` in place and starts main.py.

    bootstrap.py READ_FD WRITE_FD BOARD FIRMWARE [ROOT]

BOARD: folder of lockstep, machine and time.  FIRMWARE: folder of main and lib.  ROOT: where CPython finds `host.compat`.
"""

import sys

_board, _firmware = sys.argv[3:5]


def _take_over(name):
    """Make the board's module the one that `import name` gives, though the interpreter has one of its own."""
    sys.modules.pop(name, None)
    if sys.implementation.name == "micropython":
        sys.modules[name] = __import__(name)  # the file comes before the built-in one
        return
    from importlib.util import module_from_spec, spec_from_file_location

    spec = spec_from_file_location(name, _board + "/" + name + ".py")
    sys.modules[name] = module = module_from_spec(spec)
    spec.loader.exec_module(module)


_own = ["", _board, _firmware, _firmware + "/lib"]
if sys.implementation.name == "micropython":
    sys.path[:] = _own
else:
    sys.path[:] = _own + sys.path[1:] + sys.argv[5:]
    from host import compat

    compat.install(_firmware)

import lockstep

_take_over("time")
_take_over("machine")
lockstep.connect(int(sys.argv[1]), int(sys.argv[2]))

try:
    import main
except (Exception, KeyboardInterrupt):
    lockstep.flush()  # what it did on its way out belongs to the run
    raise
