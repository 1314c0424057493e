"""Finds the MicroPython that runs the firmware on this machine, and fetches the one with the board's word size.

    from host import micropython
    port = micropython.find()       # 32-bit words where it can be had
    subprocess.run([*port.command, "main.py"])

The ESP32 has 32-bit words. Only a MicroPython with words of that size takes as much heap as the board, has its small integers of 31 bits and computes
in its 32-bit machine integers. Debian packages one for i386, which any x86-64 Linux runs; `make setup` unpacks it into .venv without touching the
system (`debian.fetch`). Elsewhere the 64-bit unix port from PyPI stands in for it, with twice the heap.
"""

from .limited import run
from .ports import ENGINES, Port, ToolMissing, cross_compiler, find

__all__ = ["ENGINES", "Port", "ToolMissing", "cross_compiler", "find", "run"]
