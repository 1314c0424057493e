"""The board's MicroPython side, through mpremote."""

import ast
import tempfile
from dataclasses import dataclass
from pathlib import Path

from host.boards.build import BoardFile
from host.boards.errors import FlashError

from . import tools
from .chip import PACKAGES, Chip

# One round trip for all there is to know: who the board is, how much room it has, and the SHA-256 of every file
_SURVEY = """
import os, sys, hashlib, binascii, machine, gc
files = {}
folders = []
def walk(folder):
    for entry in os.ilistdir(folder or '/'):
        path = folder + '/' + entry[0]
        if entry[1] & 0x4000:
            folders.append(path[1:])
            walk(path)
        else:
            digest = hashlib.sha256()
            with open(path, 'rb') as f:
                while chunk := f.read(1024):
                    digest.update(chunk)
            files[path[1:]] = binascii.hexlify(digest.digest()).decode()
walk('')
size = os.statvfs('/')
name = sys.implementation._machine
fuses = machine.mem32[0x3FF5A00C] if name.endswith('with ESP32') else 0
gc.collect()
heap = gc.mem_alloc() + gc.mem_free()
print(repr((binascii.hexlify(machine.unique_id()).decode(), sys.implementation[1][:3], size[0] * size[3], files, folders, name, fuses, heap)))
"""
# The modules that lay flat in lib/ until they were put into packages, and packages that are no more
_OLD_MODULES = frozenset(
    """
    auth avoid carriers commands config config_checks constructors crc16 drive envelope envelope_arcs envelope_rings envelope_strips
    envelope_tables field field_nose field_queue field_spread field_spread_naws field_stamps field_steps field_ways health keep lidar link
    link_start odometry once outputs pairs pca9685 radio reasons report robot room schema screen settings steering surroundings sweep telemetry
    texts trig version whole_frames windows worth
    """.split()
)
_OLD_PACKAGES: frozenset[str] = frozenset()
_BLOCK = 4096  # littlefs gives out whole blocks


@dataclass(frozen=True)
class Survey:
    """identity: unique number of the chip, hex. micropython: version. free: bytes. files: path -> SHA-256 in hex. folders: paths.
    machine: what MicroPython calls the board. fuses: eFuse word 3, which names the package. heap: bytes."""

    identity: str
    micropython: tuple[int, int, int]
    free: int
    files: dict[str, str]
    folders: list[str]
    machine: str
    fuses: int
    heap: int

    @property
    def chip(self) -> Chip:
        """The chip, as far as it can be told from here."""
        name = self.machine.rpartition("with ")[2]
        if name == "ESP32":
            name = PACKAGES.get(self.fuses >> 9 & 7 | (self.fuses >> 2 & 1) << 3, name)
        return Chip(name, heap=self.heap)


def survey(port: str, timeout: float = 60) -> Survey:
    """What is on the board now. Raises FlashError if no MicroPython answers."""
    said = tools.read(tools.mpremote(port, "exec", _SURVEY), timeout)
    try:
        return Survey(*ast.literal_eval(said.strip().splitlines()[-1]))
    except (SyntaxError, ValueError, IndexError, TypeError):
        raise FlashError(f"the board answered something else: {said!r}", "press its EN (reset) button and run this again") from None


def pull(port: str, name: str) -> bytes:
    """Content of one file of the board."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "file"
        tools.read(tools.mpremote(port, "fs", "cp", f":{name}", str(target)))
        return target.read_bytes()


def copy_commands(port: str, files: list[BoardFile], survey: Survey) -> list[list[str]]:
    """The mpremote command lines that make the board hold `files`, given what it holds."""
    found = survey.files
    changed = [file for file in files if found.get(file.name) != file.sha256]
    folders = {parent.as_posix() for file in changed for parent in Path(file.name).parents} - {"."}
    words = [["fs", "mkdir", f":{folder}"] for folder in sorted(folders - set(survey.folders))]
    words += [["fs", "cp", str(file.path), f":{file.name}"] for file in changed]
    return _chain(port, words)


def clear_commands(port: str, files: list[BoardFile], survey: Survey) -> list[list[str]]:
    """The mpremote command lines that take away what an older firmware left: modules that are no more, or lie elsewhere now, and its empty folders.

    A lib/x.py left on the board goes as well, because MicroPython prefers it to lib/x.mpy. Files of the builder's own stay: those in lib/ that no
    firmware of ours ever had, and all that are no compiled modules.
    """
    ours = {file.name for file in files}
    packages = {name.split("/")[1] for name in ours if name.startswith("lib/") and name.count("/") > 1}
    stale = [name for name in sorted(survey.files) if name not in ours and _was_ours(name, ours, packages)]
    left = {parent.as_posix() for name in set(survey.files) - set(stale) | ours for parent in Path(name).parents}
    touched = {parent.as_posix() for name in stale for parent in Path(name).parents} - {".", "lib"}
    empty = sorted(touched - left, key=lambda folder: -folder.count("/"))
    return _chain(port, [["fs", "rm", f":{name}"] for name in stale] + [["fs", "rmdir", f":{folder}"] for folder in empty])


def _was_ours(name: str, ours: set[str], packages: set[str]) -> bool:
    if name.endswith(".py"):
        return name.removesuffix(".py") + ".mpy" in ours
    parts = name.split("/")
    if parts[0] != "lib" or not name.endswith(".mpy"):
        return False
    if len(parts) == 2:
        return parts[1].removesuffix(".mpy") in _OLD_MODULES
    return parts[1] in packages | _OLD_PACKAGES


def _chain(port: str, words: list[list[str]]) -> list[list[str]]:
    """One call of mpremote for all: each costs a second of its own."""
    if not words:
        return []
    chain = words[0]
    for more in words[1:]:
        chain = [*chain, "+", *more]
    return [tools.mpremote(port, *chain)]


def check_room(files: list[BoardFile], survey: Survey) -> None:
    """Raise FlashError if the changed files do not fit: a board must not be left with half a firmware."""
    changed = [file for file in files if survey.files.get(file.name) != file.sha256]
    needed = sum(-(-len(file.data) // _BLOCK) * _BLOCK for file in changed)
    # the room of the files being replaced is not counted: littlefs gives it back only after the new content is written
    if needed > survey.free:
        raise FlashError(
            f"not enough room on the board: {needed} bytes to write, {survey.free} free",
            "remove files of your own from it (mpremote fs ls, mpremote fs rm), or run make flash, which empties it",
        )


def compare(files: list[BoardFile], found: dict[str, str]) -> None:
    """Raise FlashError if a file on the board is not the one that was meant."""
    wrong = [file.name for file in files if found.get(file.name) != file.sha256]
    if wrong:
        raise FlashError(
            "read back, these files differ from what was written: " + ", ".join(wrong),
            "run this again; if it stays so, the flash memory is worn or the power too weak: try another cable, then another board",
        )
