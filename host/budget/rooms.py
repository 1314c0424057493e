"""What each room of the firmware takes: a package of firmware/lib, or a module beside the packages.

Measured while the firmware starts: what the heap grows by when a module is loaded, the names that it adds to those of the interpreter, and at
the end a walk over all objects for the arrays that they hold.
"""

import re
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

from . import trace

_POOL = re.compile(r"n_qstr=(\d+), n_str_data_bytes=(\d+), n_total_bytes=(\d+)")
_ENTRY = 7  # bytes that the interpreter's list of names has for each, besides its letters


@dataclass
class Room:
    """Bytes. arrays: with their heads. code: bytecode, classes, dicts of the modules that stay loaded. names: identifiers it is the first to use.
    native: machine code, outside the heap."""

    arrays: int = 0
    code: int = 0
    names: int = 0
    native: int = 0


def measure(folder: Path, pieces: dict[str, list[int]]) -> tuple[dict[str, Room], int]:
    """(room by name, bytes of the heap after the start). folder: of trace.board; pieces: of trace.native_pieces."""
    said = trace.start(folder, "rooms").output.decode(errors="replace")
    loaded = _words(said, "loaded")[-1]
    rooms: dict[str, Room] = defaultdict(Room)
    rooms_known = {path.stem for path in (folder / "lib").iterdir()} | {"main"}
    arrays = {words[0]: int(words[1]) for words in _words(said, "array")}
    for owner, count in arrays.items():
        if _room(owner) in rooms_known:
            rooms[_room(owner)].arrays += count
    for module, (grown, names) in _imports(said).items():
        if _room(module) not in rooms_known:
            continue
        rooms[_room(module)].names += names
        if module in loaded:
            rooms[_room(module)].code += grown
    for module, sizes in pieces.items():
        if module in loaded:
            rooms[_room(module)].native += sum(sizes)
    return dict(rooms), int(_words(said, "live")[-1][0])


def _room(module: str) -> str:
    return module.partition(".")[0]


def _words(said: str, first: str) -> list[list[str]]:
    return [line.split()[1:] for line in said.splitlines() if line.startswith(first + " ")]


def _imports(said: str) -> dict[str, tuple[int, int]]:
    """Module -> (bytes of heap without names, bytes of names), of the module alone, without what it loads itself.

    The list of names grows by steps, for all: what a step takes beyond its names is nobody's.
    """
    open_ones: list[list] = []  # [module, names before, list before, of those inside: heap, names]
    found: dict[str, tuple[int, int]] = {}
    pending: list[str] = []
    for line in said.splitlines():
        words = line.split()
        if words[:1] in (["before"], ["after"]) and len(words) in (2, 4):
            pending = words
        elif pending and (pool := _POOL.search(line)):
            names, whole = _ENTRY * int(pool[1]) + int(pool[2]), int(pool[3])
            if pending[0] == "before":
                open_ones.append([pending[1], names, whole, 0, 0])
            else:
                module, names_before, whole_before, inner_heap, inner_names = open_ones.pop()
                grown, added = int(pending[3]) - (whole - whole_before), names - names_before
                found[module] = max(grown - inner_heap, 0), max(added - inner_names, 0)
                if open_ones:
                    open_ones[-1][3] += grown
                    open_ones[-1][4] += added
            pending = []
    return found
