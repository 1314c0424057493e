"""Maps drawn by hand: JSON with rows of 0, 1 and x.

    {"cell": 300, "rows": ["111...", ...], "start": [1805.5, 2800, 90], "places": {"goal": [7150, 5005]}, "doors": [[4650, 6450, 90, 900]]}

rows: the first is the top; 0 free, 1 a wall, x a door. start: x, y (mm from the lower left corner), heading (deg clockwise from +y). doors, which may be left out: x, y of the
middle, direction of passing, width; else they follow from the x.
"""

import json
from pathlib import Path

import numpy as np

from .errors import MapError
from .model import DOOR, FREE, WALL, Door, HouseMap, doors_of

_KINDS = {"0": FREE, "1": WALL, "x": DOOR, "X": DOOR}
_KEYS = {"cell", "rows", "start", "places", "doors", "origin"}
_PIXELS = 12  # a cell's side


def read(path: Path) -> HouseMap:
    """The map in a JSON file."""
    try:
        values = json.loads(path.read_text())
    except OSError as error:
        raise MapError(f"{path} cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise MapError(f"{path} is not JSON: {error}") from None
    return parse(values, str(path))


def parse(values, source: str) -> HouseMap:
    """The map in the JSON's values."""
    if not isinstance(values, dict) or "rows" not in values:
        raise MapError(f'{source}: an object with "rows" and "cell" is needed, as in maps/house.json')
    if unknown := sorted(set(values) - _KEYS):
        raise MapError(f"{source}: unknown key {unknown[0]}; there are {', '.join(sorted(_KEYS))}")
    cell = values.get("cell", 300)
    if not isinstance(cell, int) or not 50 <= cell <= 1000:
        raise MapError(f"{source}: cell is {cell!r}; a whole number of mm, 50 to 1000, is needed")
    cells = _cells(values["rows"], source)
    walls = np.kron(cells == WALL, np.ones((_PIXELS, _PIXELS), bool))
    doors = [_door(one, source) for one in values["doors"]] if "doors" in values else doors_of(cells, cell)
    origin = tuple(_numbers(values.get("origin", [0, 0]), 2, "origin", source))
    start = tuple(_numbers(values["start"], 3, "start", source)) if values.get("start") is not None else None
    places = {str(name): tuple(_numbers(place, 2, f"place {name}", source)) for name, place in dict(values.get("places", {})).items()}
    return HouseMap(cells, cell, walls, cell / _PIXELS, doors, origin, start, places, [], source)  # type: ignore[arg-type]


def _cells(rows, source: str) -> np.ndarray:
    if not isinstance(rows, list) or not rows or not all(isinstance(row, str) for row in rows):
        raise MapError(f"{source}: rows must be a list of texts of 0, 1 and x")
    rows = [row.replace(" ", "") for row in rows]
    for number, row in enumerate(rows, 1):
        if len(row) != len(rows[0]):
            raise MapError(f"{source}: row {number} has {len(row)} cells, the first has {len(rows[0])}")
        for column, letter in enumerate(row, 1):
            if letter not in _KINDS:
                raise MapError(f"{source}: row {number}, column {column} is {letter!r}; 0 (free), 1 (wall) and x (door) are known")
    return np.array([[_KINDS[letter] for letter in row] for row in reversed(rows)], np.uint8)


def _door(value, source: str) -> Door:
    x, y, normal, width = _numbers(value, 4, "door", source)
    return Door(x, y, normal % 180, width)


def _numbers(value, count: int, what: str, source: str) -> list[float]:
    if not isinstance(value, list) or len(value) != count or not all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in value):
        raise MapError(f"{source}: {what} is {value!r}; a list of {count} numbers is needed")
    return [float(one) for one in value]
