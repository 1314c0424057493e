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
_VERSION = const(5)  # to be raised whenever a table comes to mean something else, or is made otherwise
_HEAD = const(12)
_LARGEST = const(16384)  # bytes of one array: a damaged file must not ask for all memory
_TYPES = ("hhHHBHiHh", "BHH")  # of the arrays of each part; B: a bytearray
_BYTES = {"B": 1, "h": 2, "H": 2, "i": 4}


def cost_to_go(config):
    """Footprint masks, motion primitives, costs of rim headings: see footprint_masks.py, primitives.py, primitives_naws.py."""
    return _part(config, 1)


def candidates(config):
    """af, ar, lengths, consts, table, seconds, strips, ends, turns: see Candidates."""
    return _part(config, 0)


def save(config, path):
    """Make all tables for a Config and write them to path, for the board to find as tables.bin. OSError if it cannot be written."""
    with open(path, "wb") as file:
        file.write(_head(config))
        for part in (0, 1):
            _write(file, _make(config, part), part)


def _part(config, part):
    arrays = _load(config, part)
    if arrays is None:
        arrays = _make(config, part)
        _keep(config, arrays, part)
    return arrays


def _head(config):
    """Coordinates are taken to 1/8 mm: floats are written differently with 32 and with 64 bits."""
    key = (
        config.mode, config.robot_width, config.robot_length, config.axles_track, [round(s * 8) for s in config.axles_spacings],
        round(config.axles_first * 8), config.avoid_margin, config.avoid_soft_margin, config.windows_look_ahead,
    )  # fmt: skip
    return b"GSTB" + pack("<HHI", _VERSION, 0, crc32(repr(key).encode()))


def _load(config, part):
    """The arrays of a part; None if the file is missing, for another robot, or damaged."""
    try:
        with open(PATH, "rb") as file:
            if file.read(_HEAD) != _head(config):
                return None
            for k in range(part):
                _skip(file, k)
            return _read(file, part)
    except (OSError, ValueError):
        return None


def _sizes(file, part):
    sizes = array("H", bytes(2 * len(_TYPES[part])))
    if file.readinto(sizes) != 2 * len(sizes) or max(sizes) > _LARGEST:
        raise ValueError
    return sizes


def _skip(file, part):
    sizes = _sizes(file, part)
    file.seek(sum(sizes) + 4, 1)


def _read(file, part):
    sizes = _sizes(file, part)
    check = file.read(4)
    arrays = []
    found = 0
    for kind, size in zip(_TYPES[part], sizes):
        made = bytearray(size) if kind == "B" else array(kind, bytes(size))
        if file.readinto(made) != size:
            return None
        found = crc32(made, found)
        arrays.append(made)
    return arrays if pack("<I", found) == check else None


def _write(file, arrays, part):
    found = 0
    for made in arrays:
        found = crc32(made, found)
    file.write(array("H", [len(made) * _BYTES[kind] for made, kind in zip(arrays, _TYPES[part])]))
    file.write(pack("<I", found))
    for made in arrays:
        file.write(made)


def _keep(config, arrays, part):
    """Write what was made, behind what fits before it. Without a robot.json this is no robot's folder, and nothing is left there."""
    try:
        os.stat("robot.json")
        if part == 0:
            with open(PATH, "wb") as file:
                file.write(_head(config))
                _write(file, arrays, part)
        else:
            with open(PATH, "r+b") as file:
                if file.read(_HEAD) == _head(config):
                    _skip(file, 0)
                    _write(file, arrays, part)
    except (OSError, ValueError):
        pass


def _make(config, part):
    return _make_cost_to_go(config) if part else _make_candidates(config)


def _make_cost_to_go(config):
    from planner import footprint_masks

    cell = config.robot_length * 8 // 12  # of the grid, 1/8 mm
    made = [footprint_masks.masks(config.robot_width, config.robot_length, config.avoid_margin, cell)]
    footprint_masks = None
    unload("planner.footprint_masks")
    if config.mode == "AWS":
        from planner import primitives

        made.append(primitives.steps(config.robot_length, cell))
        made.append(primitives.rim(True))
    else:
        from planner import primitives, primitives_naws

        made.append(primitives_naws.ways(sum(config.axles_spacings), config.axles_first, cell))
        made.append(primitives.rim(False))
    primitives = primitives_naws = None
    unload("planner.primitives", "planner.primitives_naws")
    return made


def _make_candidates(config):
    from planner import candidate_set

    draft = candidate_set.Draft(config)
    candidate_set = None
    unload("planner.candidate_set")
    # One after the other: together they would be more than the heap has to spare.
    for name in ("planner.candidate_arcs", "planner.candidate_rings", "planner.candidate_strips"):
        maker = __import__(name, None, None, ("fill",))
        maker.fill(draft)
        maker = None
        unload(name)
    return draft.arrays()
