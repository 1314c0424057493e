"""Making the planner's tables and writing them to their file, see tables.py. On the board loaded only where the file does not fit, then let go."""

import os
from array import array
from binascii import crc32
from struct import pack

from micropython import const

from core.unload import unload
from planner.tables import PATH, TYPES, head, read

_HEAD = const(12)
_BYTES = {"B": 1, "h": 2, "H": 2, "i": 4}


def save(config, path):
    """Make all tables for a Config and write them to path, for the board to find as tables.bin. OSError if it cannot be written."""
    with open(path, "wb") as file:
        file.write(head(config))
        for part in (0, 1):
            _write(file, make(config, part), part)


def _write(file, arrays, part):
    found = 0
    for made in arrays:
        found = crc32(made, found)
    file.write(array("H", [len(made) * _BYTES[kind] for made, kind in zip(arrays, TYPES[part])]))
    file.write(pack("<I", found))
    for made in arrays:
        file.write(made)


def keep(config, arrays, part):
    """Write what was made, behind what fits before it. Without a robot.json this is no robot's folder, and nothing is left there."""
    try:
        os.stat("robot.json")
        if part == 0:
            with open(PATH, "wb") as file:
                file.write(head(config))
                _write(file, arrays, part)
        else:
            with open(PATH, "r+b") as file:
                if file.read(_HEAD) == head(config):
                    file.seek(sum(read(file, 0)) + 4, 1)
                    _write(file, arrays, part)
    except (OSError, ValueError):
        pass


def make(config, part):
    """The arrays of a part of the file."""
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
