"""Reads the map from its file and makes the parts of the goal layer. Needed once, at the start: then it is unloaded.

The file (host/floorplan/board_file.py writes it), little-endian:

    0   4s   GSMP
    4   4B   version 1, rows, columns, doors
    8   H    side of a cell, mm
    10  2B   rows and columns of the field's nodes
    12  H    from node to node, mm
    14  H    0
    16  2i   where the map's lower left corner lies in the frame of whoever drew it, mm: for the laptop
    24  doors, 4 H each: x, y, normal (0.1 deg), width
    ..  cells, 2 bits each, from the lower left, row by row: 0 a wall, 1 free, 2 a door
    ..  field, bytes
    ..  H    CRC-16 (Modbus) over all before
"""

import struct
import sys
from array import array

from core.crc16 import crc16
from core.unload import unload
from goal.layer import Goal
from goal.pose import again

FILE = "map.bin"
METHODS = ("gap", "field", "behaviour")
_HEAD = 24
_CELLS = 1600
_POINTS = 80  # pose.py
_QUEUE = 8  # orders.py
_NUMBERS = 68  # layer.py; more than compat's ptr32 looks through for what is negative
_TOLD = 21
_NONE = 32767


def load(path=FILE):
    """The map as (its bytes, its header's numbers, place of the cells, place of the field), or None if there is no file. ValueError says what is wrong with it."""
    try:
        with open(path, "rb") as file:
            data = file.read()
    except OSError:
        return None
    if len(data) < _HEAD + 2 or data[:4] != b"GSMP":
        raise ValueError(path + " is no map: send it again with python -m host.map")
    head = struct.unpack("<BBBBHBBH", data[4:14])
    version, rows, cols, doors, cell, field_rows, field_cols, spacing = head
    if version != 1:
        raise ValueError("%s is of version %d, this firmware reads version 1: send it again" % (path, version))
    cells = _HEAD + 8 * doors
    field = cells + (rows * cols + 3) // 4
    size = field + field_rows * field_cols + 2
    if len(data) != size:
        raise ValueError("%s has %d bytes, not the %d that belong to it: send it again" % (path, len(data), size))
    if crc16(data, 0, size - 2) != data[-2] | data[-1] << 8:
        raise ValueError(path + " is damaged, its check does not hold: send it again")
    if rows < 3 or cols < 3 or rows * cols > _CELLS or not 50 <= cell <= 1000 or not 50 <= spacing <= 1000 or field_rows < 2 or field_cols < 2:
        raise ValueError("%s has %d x %d cells of %d mm: 3 x 3 to %d cells of 50 to 1000 mm are read" % (path, rows, cols, cell, _CELLS))
    return data, head, cells, field


def build(config, avoid, found):
    """The Goal for what load() gave."""
    data, head, cells_at, field_at = found
    _, rows, cols, doors, cell, field_rows, field_cols, spacing = head
    self = Goal()
    self.cells = cells = array("H", bytes(2 * rows * cols))
    gates = []
    for k in range(rows * cols):
        kind = data[cells_at + (k >> 2)] >> 2 * (k & 3) & 3
        if kind == 3 or k // cols in (0, rows - 1) or k % cols in (0, cols - 1):
            kind = 0  # the kernels look at all eight neighbours
        cells[k] = (0xFFFF, 0x0FFF, 0x7FFF)[kind]
        if kind == 2:
            gates.append(k)
    self.gates = array("H", gates)
    self.head = data[4:cells_at]
    self.field = bytearray(data[field_at:-2])
    self.px = array("H", bytes(2 * _POINTS))
    self.py = array("H", bytes(2 * _POINTS))
    self.around = array("h", (0, cols, -cols, 1, -1, cols + 1, -cols + 1, cols - 1, -cols - 1))
    self.queue = array("h", bytes(4 * _QUEUE))
    records = []
    for k in range(doors):
        records += list(struct.unpack("<4H", data[_HEAD + 8 * k : _HEAD + 8 * k + 8])) + [-1, 0, 0]
    self.doors = array("h", records)
    self.told = told = array("h", bytes(2 * _TOLD))
    told[7] = 999  # the pose's error
    told[13] = told[14] = told[15] = told[16] = -1  # length, door, through, open
    self.numbers = n = array("i", bytes(4 * _NUMBERS))
    n[0] = cols
    n[1] = rows * cols
    n[2] = cell
    n[3] = field_cols
    n[4] = (field_cols - 1) * spacing * 8 - 1
    n[5] = (field_rows - 1) * spacing * 8 - 1
    n[6] = spacing * 8
    n[37] = config.lidar_frames
    n[38] = 4 * config.lidar_far
    n[39] = 4 * config.lidar_near
    n[40] = config.lidar_x
    n[41] = config.lidar_y
    n[62] = -1
    n[50] = _NONE
    n[57] = config.robot_width + 60  # an opening that can be passed
    self.avoid = avoid
    self.holds = True
    self.why = 19  # reasons.GOAL_NONE
    self.asked = False
    self.locate = self.method = None
    self.x = self.y = 0
    again(n)
    choose(self, METHODS.index(config.goal_method))
    return self


def choose(goal, number):
    """Give the Goal its method, by its place in METHODS; the one before is let go. The robot is to stand: a module is loaded."""
    if goal.method is not None:
        goal.method.end()
        goal.method = None
        unload("goal.gap", "goal.field", "goal.behaviour", "goal.reactive")
    name = METHODS[number]
    __import__("goal." + name)
    goal.method = getattr(sys.modules["goal." + name], name[0].upper() + name[1:])(goal.avoid)
    goal.avoid.configure()
    goal.told[2] = number
