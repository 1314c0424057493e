"""Lets CPython import firmware/lib unchanged.

    from host import compat
    compat.install()
    import steering          # firmware/lib/steering.py

What MicroPython has and CPython lacks, and nothing more:

    micropython     module: const, native, viper, heap_lock, ... (`host.compat.micropython`)
    ptr8 ptr16 ptr32 uint
                    builtins used inside viper functions; the pointers are unsigned views, as in viper, but checked: an index
                    outside the buffer raises IndexError, a negative value stored raises ValueError (mask it first)
    time            ticks_ms, ticks_us, ticks_add, ticks_diff, sleep_ms, sleep_us
    gc, sys         mem_free, mem_alloc, threshold; print_exception

`machine` is not here: unit tests hand their own buses in, and the twin has a whole board (`host.twin`).
"""

import builtins
import gc
import sys
import time
import traceback
from pathlib import Path

from . import micropython, pointers, ticks

FIRMWARE = Path(__file__).resolve().parents[2] / "firmware"


def install(firmware=FIRMWARE):
    """Make `import` find the firmware's modules and give them what they expect. Calling it again does no harm.

    firmware: folder with main.py and lib/.
    """
    sys.modules["micropython"] = micropython
    for name in ("ptr8", "ptr16", "ptr32", "uint"):
        setattr(builtins, name, getattr(pointers, name))
    for name in ticks.__all__:
        if not hasattr(time, name):
            setattr(time, name, getattr(ticks, name))
    _fill_in(gc, "mem_free", lambda: 100_000)
    _fill_in(gc, "mem_alloc", lambda: 0)
    _fill_in(gc, "threshold", lambda size=-1: -1)
    _fill_in(sys, "print_exception", lambda error, file=None: traceback.print_exception(error, file=file))
    library = str(Path(firmware) / "lib")
    if library not in sys.path:
        sys.path.append(library)


def _fill_in(module, name, value):
    if not hasattr(module, name):
        setattr(module, name, value)
