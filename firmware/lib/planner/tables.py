"""The planner's tables: read from a file, or made and written to it. Loaded at the start, then let go.

What the planner knows of the robot before it sees anything depends on robot.json alone: for the cost to go its footprint masks and motion primitives, for the
candidates what the body sweeps. Making that takes seconds on the ESP32 and leaves the names of the code that makes it in the heap, so it is
made on the laptop when the robot is set up (save()) and put beside robot.json as tables.bin. Where that is missing, or was made for another robot.json,
the board makes the tables itself and tries to write them; a file system that is full or read-only costs the time again at the next start, no more.

    head   "GSTB", version (2 bytes), 0 (2 bytes), key (4 bytes): CRC-32 of the parameters that the tables depend on
    part 0 sizes of its arrays in bytes (2 each), CRC-32 of their contents (4), their contents: for Candidates
    part 1 likewise, for CostToGo

Little-endian, as every machine that this runs on.
"""

import os
from array import array
from binascii import crc32
from struct import pack

from micropython import const

from core.unload import unload

PATH = "tables.bin"
_MADE = const("tables made")  # key in Config.once, where it was no use
TYPES = ("hhHHBHiHH", "BHH")  # of the arrays of each part; B: a bytearray
_VERSION = const(8)  # to be raised whenever a table comes to mean something else, or is made otherwise
_HEAD = const(12)
_LARGEST = const(16384)  # bytes of one array: a damaged file must not ask for all memory


def load(config, part):
    """The arrays of a part, from the file or made now.

    0: af, ar, lengths, consts, table, seconds, strips, ends, turns, see Candidates. 1: footprint masks, motion primitives, costs of rim headings, see
    footprint_masks.py, primitives.py, primitives_naws.py.
    """
    arrays = None
    try:
        with open(PATH, "rb") as file:
            if file.read(_HEAD) == head(config):
                if part:
                    sizes = read(file, 0)
                    file.seek(sum(sizes) + 4, 1)
                sizes = read(file, part)
                check = file.read(4)
                arrays = []
                found = 0
                for kind, size in zip(TYPES[part], sizes):
                    made = bytearray(size) if kind == "B" else array(kind, bytes(size))
                    if file.readinto(made) != size:
                        raise ValueError
                    found = crc32(made, found)
                    arrays.append(made)
                if pack("<I", found) != check:
                    arrays = None
    except (OSError, ValueError):
        arrays = None
    if arrays is None:
        from planner import make_tables

        arrays = make_tables.make(config, part)
        keep(config, arrays, part)
        make_tables = None
        unload("planner.make_tables")
        config.once[_MADE] = True
    return arrays


def save(config, path):
    """Make all tables for a Config and write them to path, for the board to find as tables.bin. OSError if it cannot be written."""
    from planner import make_tables

    with open(path, "wb") as file:
        file.write(head(config))
        for part in (0, 1):
            write(file, make_tables.make(config, part), part)


def head(config):
    """The file's head for a Config. Coordinates are taken to 1/8 mm: floats are written differently with 32 and with 64 bits."""
    key = (
        config.mode, config.robot_width, config.robot_length, config.axles_track, [round(s * 8) for s in config.axles_spacings],
        round(config.axles_first * 8), config.avoid_margin, config.avoid_soft_margin, config.windows_look_ahead,
    )  # fmt: skip
    return b"GSTB" + pack("<HHI", _VERSION, 0, crc32(repr(key).encode()))


def read(file, part):
    """Sizes of a part's arrays, bytes. ValueError if there are none."""
    sizes = array("H", bytes(2 * len(TYPES[part])))
    if file.readinto(sizes) != 2 * len(sizes) or max(sizes) > _LARGEST:
        raise ValueError
    return sizes


def keep(config, arrays, part):
    """Write what was made, behind what fits before it. Without a robot.json this is no robot's folder, and nothing is left there."""
    try:
        os.stat("robot.json")
        if part == 0:
            with open(PATH, "wb") as file:
                file.write(head(config))
                write(file, arrays, part)
        else:
            with open(PATH, "r+b") as file:
                if file.read(_HEAD) == head(config):
                    file.seek(sum(read(file, 0)) + 4, 1)
                    write(file, arrays, part)
    except (OSError, ValueError):
        pass


def write(file, arrays, part):
    found = 0
    for made in arrays:
        found = crc32(made, found)
    file.write(array("H", [len(made) * {"B": 1, "i": 4}.get(kind, 2) for made, kind in zip(arrays, TYPES[part])]))
    file.write(pack("<I", found))
    for made in arrays:
        file.write(made)
