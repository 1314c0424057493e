"""The board's MicroPython side, through mpremote."""

import ast
import tempfile
from dataclasses import dataclass
from pathlib import Path

from . import tools
from .build import BoardFile
from .errors import FlashError

# One round trip for all there is to know: who the board is, how much room it has, and the SHA-256 of every file
_SURVEY = """
import os, sys, hashlib, binascii, machine
files = {}
def walk(folder):
    for entry in os.ilistdir(folder or '/'):
        path = folder + '/' + entry[0]
        if entry[1] & 0x4000:
            walk(path)
        else:
            digest = hashlib.sha256()
            with open(path, 'rb') as f:
                while chunk := f.read(1024):
                    digest.update(chunk)
            files[path[1:]] = binascii.hexlify(digest.digest()).decode()
walk('')
size = os.statvfs('/')
print(repr((binascii.hexlify(machine.unique_id()).decode(), sys.implementation[1][:3], size[0] * size[3], files)))
"""
_BLOCK = 4096  # littlefs gives out whole blocks


@dataclass(frozen=True)
class Survey:
    """identity: unique number of the chip, hex. micropython: version. free: bytes. files: path -> SHA-256 in hex."""

    identity: str
    micropython: tuple[int, int, int]
    free: int
    files: dict[str, str]


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


def copy_commands(port: str, files: list[BoardFile], found: dict[str, str]) -> list[list[str]]:
    """The mpremote command lines that make the board hold `files`, given what it holds (path -> SHA-256).

    A lib/x.py left on the board is removed, because MicroPython prefers it to lib/x.mpy.
    """
    words: list[list[str]] = []
    stale = [file.name.removesuffix(".mpy") + ".py" for file in files if file.name.endswith(".mpy")]
    words += [["fs", "rm", f":{name}"] for name in stale if name in found]
    changed = [file for file in files if found.get(file.name) != file.sha256]
    folders = {parent.as_posix() for file in changed for parent in Path(file.name).parents} - {"."}
    there = {parent.as_posix() for name in found for parent in Path(name).parents}
    words += [["fs", "mkdir", f":{folder}"] for folder in sorted(folders - there)]
    words += [["fs", "cp", str(file.path), f":{file.name}"] for file in changed]
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
