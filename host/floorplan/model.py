"""A map: walls as a fine picture, cells for the search, doors, places."""

from dataclasses import dataclass, field
from math import cos, radians, sin

import numpy as np

from .errors import MapError

WALL, FREE, DOOR = 0, 1, 2
LARGEST = 32000  # mm: the board's coordinates have 16 bits


@dataclass(frozen=True)
class Door:
    """x, y: its middle, mm from the map's lower left corner. normal: direction of passing, degrees clockwise from +y, 0..180. width: mm."""

    x: float
    y: float
    normal: float
    width: float

    def point(self, ahead: float, aside: float = 0.0) -> tuple[float, float]:
        """The place so far along its normal, and so far to the right of that."""
        s, c = sin(radians(self.normal)), cos(radians(self.normal))
        return self.x + ahead * s + aside * c, self.y + ahead * c - aside * s


@dataclass
class HouseMap:
    """Lengths in mm from the lower left corner, x right, y up.

    cells: (rows, columns) of WALL, FREE, DOOR, the lowest row first; cell: their side. walls: (m, n) bool, True where a wall is, in pixels of `pixel` mm, the
    lowest row first; doors are open in it. origin: where the lower left corner lies in the frame of whoever drew the map. start: x, y, heading (deg) or None. places:
    {name: (x, y)}. notes: what was done to it, for people. source: file.
    """

    cells: np.ndarray
    cell: int
    walls: np.ndarray
    pixel: float
    doors: list[Door] = field(default_factory=list)
    origin: tuple[float, float] = (0.0, 0.0)
    start: tuple[float, float, float] | None = None
    places: dict[str, tuple[float, float]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    source: str = ""

    @property
    def size(self) -> tuple[float, float]:
        """Width and height, mm."""
        rows, cols = self.cells.shape
        return cols * self.cell, rows * self.cell

    def at(self, x: float, y: float) -> tuple[int, int]:
        """Row and column of a place. MapError if it lies beside the map."""
        row, col = int(y // self.cell), int(x // self.cell)
        rows, cols = self.cells.shape
        if not (0 <= row < rows and 0 <= col < cols):
            width, height = self.size
            raise MapError(f"{self.source}: {x:g}, {y:g} lies beside the map, which is {width:g} x {height:g} mm")
        return row, col


def doors_of(cells: np.ndarray, cell: int) -> list[Door]:
    """The doors of a grid: each group of door cells that touch, passed across its longer side; a single cell where walls stand on two opposite sides."""
    doors = []
    left = cells == DOOR
    while left.any():
        group = [tuple(int(v) for v in np.argwhere(left)[0])]
        left[group[0]] = False
        for row, col in group:
            for dr, dc in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                r, c = row + dr, col + dc
                if 0 <= r < cells.shape[0] and 0 <= c < cells.shape[1] and left[r, c]:
                    left[r, c] = False
                    group.append((r, c))
        doors.append(_door(np.array(group), cells, cell))
    return doors


def _door(group: np.ndarray, cells: np.ndarray, cell: int) -> Door:
    low, high = group.min(axis=0), group.max(axis=0)
    height, width = (high - low + 1) * cell
    y, x = (low + high + 1) / 2 * cell
    upright = height > width or height == width and _wall(cells, low[0] - 1, low[1]) and _wall(cells, high[0] + 1, low[1])
    return Door(float(x), float(y), 90.0 if upright else 0.0, float(height if upright else width))


def _wall(cells: np.ndarray, row: int, col: int) -> bool:
    return not (0 <= row < cells.shape[0] and 0 <= col < cells.shape[1]) or cells[row, col] == WALL
