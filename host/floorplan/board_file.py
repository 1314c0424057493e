"""The board's map as bytes: firmware/lib/goal/build.py reads and describes the file."""

import struct

import numpy as np

from . import field
from .errors import MapError
from .model import LARGEST, HouseMap

HEAD = "<4sBBBBHBBHHii"
VERSION = 1
MOST_CELLS = 1600
MOST_SIDE = 250
MOST_DOORS = 16
FIELD_BYTES = 1400  # so much is kept of the board's memory for the field


def spacings(width: float, height: float, most: int = FIELD_BYTES) -> range:
    """Spacings of the field's nodes, whole 5 mm, with which it fits: from the closest one on."""
    spacing = 100
    while (int(np.ceil(width / spacing)) + 1) * (int(np.ceil(height / spacing)) + 1) > most:
        spacing += 5
    return range(spacing, max(min(spacing * 5 // 4, 300), spacing) + 1, 5)


def encode(house: HouseMap) -> bytes:
    """The file. MapError says what does not fit."""
    rows, cols = house.cells.shape
    width, height = house.size
    if rows * cols > MOST_CELLS or max(rows, cols) > MOST_SIDE:
        raise MapError(f"{house.source}: {rows} x {cols} cells, the board holds {MOST_CELLS} in all: make the cells larger (--cell)")
    if max(width, height) > LARGEST:
        raise MapError(f"{house.source}: {width:g} x {height:g} mm, the board's coordinates end at {LARGEST} mm: cut the map")
    if len(house.doors) > MOST_DOORS:
        raise MapError(f"{house.source}: {len(house.doors)} doors, the board holds {MOST_DOORS}")
    fitting = spacings(width, height)
    if fitting[0] > 300:
        raise MapError(f"{house.source}: {width:g} x {height:g} mm is too large for the board to keep its place on: cut the map")
    spacing, nodes = field.best(house.walls, house.pixel, fitting)
    head = struct.pack(
        HEAD, b"GSMP", VERSION, rows, cols, len(house.doors), house.cell, *nodes.shape, spacing, 0, round(house.origin[0]), round(house.origin[1])
    )  # fmt: skip
    doors = b"".join(struct.pack("<4H", round(d.x), round(d.y), round(d.normal * 10) % 1800, round(d.width)) for d in house.doors)
    flat = house.cells.reshape(-1)
    fours = np.concatenate([flat, np.zeros(-len(flat) % 4, np.uint8)]).reshape(-1, 4).astype(np.uint8)
    packed = (fours << np.array([0, 2, 4, 6], np.uint8)).sum(axis=1).astype(np.uint8).tobytes()
    body = head + doors + packed + field.encode(nodes)
    return body + struct.pack("<H", crc(body))


def crc(data: bytes) -> int:
    """CRC-16 (Modbus), as firmware/lib/core/crc16.py."""
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xA001 if value & 1 else 0)
    return value


def decode_head(data: bytes) -> dict:
    """Header, doors and cells of a file, or of what MAP told of it."""
    _, version, rows, cols, count, cell, field_rows, field_cols, spacing, _, x, y = struct.unpack_from(HEAD, data)
    at = struct.calcsize(HEAD)
    doors = [list(struct.unpack_from("<4H", data, at + 8 * k)) for k in range(count)]
    at += 8 * count
    cells = [data[at + (k >> 2)] >> 2 * (k & 3) & 3 for k in range(rows * cols)]
    return {"rows": rows, "cols": cols, "cell": cell, "doors": [[d[0], d[1], d[2] / 10, d[3]] for d in doors], "cells": cells, "origin": [x, y]}
