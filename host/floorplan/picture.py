"""Maps from pictures: a map_server pair of ROS (map.yaml and its .pgm or .png), or a plain picture with a JSON beside it.

    plain picture   dark is a wall, light is free; doors are painted in a colour (red by default, any shade that is clearly not grey). Beside it NAME.json:
                    {"mm_per_pixel": 20, "doors": [[x, y, normal, width]], "start": [x, y, heading], "places": {...}}; all but mm_per_pixel may be left out

Cells are as large as the board needs them: the smallest of 100, 150, 200, 250, 300, ... mm with which it holds them. A cell is a wall when the robot's middle, in the middle of the
cell, would be nearer than half its width and 25 mm to a wall: so the search may take any way through free cells.
"""

import json
from pathlib import Path

import numpy as np

from .board_file import MOST_CELLS, MOST_SIDE
from .errors import MapError
from .model import DOOR, FREE, WALL, Door, HouseMap

HALF = 150.0  # mm: half the body's width and 25
SIZES = (100, 150, 200, 250, 300, 350, 400, 450, 500, 600, 750, 1000)
COLOURED = 60  # difference of the largest and the smallest of red, green and blue, from which a pixel is a door
_KEYS = {"mm_per_pixel", "doors", "start", "places"}


def read(path: Path, cell: int | None = None) -> HouseMap:
    """The map of a .yaml of the map_server, or of a picture."""
    return _ros(path, cell) if path.suffix.lower() in (".yaml", ".yml") else _plain(path, cell)


def _image(path: Path) -> np.ndarray:
    """(rows, columns, 4) of 0..255, the first row the top."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as picture:
            return np.asarray(picture.convert("RGBA"))
    except FileNotFoundError:
        raise MapError(f"{path} cannot be read: no such file") from None
    except (UnidentifiedImageError, OSError):
        raise MapError(f"{path} is not a picture: PNG or PGM is needed") from None


def _ros(path: Path, cell: int | None) -> HouseMap:
    import yaml

    try:
        values = yaml.safe_load(path.read_text())
    except OSError as error:
        raise MapError(f"{path} cannot be read: {error.strerror}") from None
    except yaml.YAMLError as error:
        raise MapError(f"{path} is not YAML: {str(error).splitlines()[0]}") from None
    try:
        pixel = float(values["resolution"]) * 1000
        origin = float(values["origin"][0]) * 1000, float(values["origin"][1]) * 1000
        occupied = float(values.get("occupied_thresh", 0.65))
        negate = bool(int(values.get("negate", 0)))
        picture = path.parent / values["image"]
        if not pixel > 0:
            raise ValueError
    except (KeyError, TypeError, ValueError, AttributeError, IndexError):
        raise MapError(f"{path} is no map: image, resolution (m) and origin [x, y, yaw] are needed") from None
    image = _image(picture)
    grey = image[..., :3].mean(axis=2) / 255
    share = grey if negate else 1 - grey
    free_thresh = float(values.get("free_thresh", 0.196))
    seen = image[..., 3] > 127
    walls = np.flipud((share > occupied) & seen)
    unknown = np.flipud(~((share < free_thresh) & seen)) & ~walls
    return _made(walls, unknown, np.zeros_like(walls), pixel, cell, str(path), origin, {})


def _plain(path: Path, cell: int | None) -> HouseMap:
    beside = path.with_suffix(".json")
    if not beside.exists():
        raise MapError(f'{path} needs {beside.name} beside it, at least {{"mm_per_pixel": 20}}')
    try:
        values = json.loads(beside.read_text())
        pixel = float(values["mm_per_pixel"])
        if unknown := sorted(set(values) - _KEYS):
            raise MapError(f"{beside}: unknown key {unknown[0]}; there are {', '.join(sorted(_KEYS))}")
        if not 1 <= pixel <= 500:
            raise ValueError
    except MapError:
        raise
    except (ValueError, KeyError, TypeError, AttributeError):
        raise MapError(f'{beside} must be a JSON object with "mm_per_pixel", 1 to 500') from None
    image = _image(path).astype(int)
    rgb = image[..., :3]
    coloured = np.flipud(rgb.max(axis=2) - rgb.min(axis=2) > COLOURED)
    walls = np.flipud(rgb.mean(axis=2) < 128) & ~coloured
    return _made(walls, np.zeros_like(walls), coloured, pixel, cell, str(path), (0.0, 0.0), values)


def _made(walls, unknown, coloured, pixel: float, cell: int | None, source: str, origin, values: dict) -> HouseMap:
    if not walls.any():
        raise MapError(f"{source} has no wall: nothing of it is dark")
    # What lies round the known part is cut off
    rows, cols = np.nonzero(~unknown)
    low, left, high, right = rows.min(), cols.min(), rows.max() + 1, cols.max() + 1
    walls, unknown, coloured = (one[low:high, left:right] for one in (walls, unknown, coloured))
    width, height = walls.shape[1] * pixel, walls.shape[0] * pixel
    notes = [f"{walls.shape[1]} x {walls.shape[0]} pixels of {pixel:g} mm, {width / 1000:.2f} x {height / 1000:.2f} m"]
    size = _cell(width, height, cell, source)
    if size > pixel:
        notes.append(f"coarsened to cells of {size} mm, as the board holds {MOST_CELLS}")
    blocked = _grown(walls | unknown, HALF / pixel)
    cells = _cells(blocked, coloured, pixel, size)
    doors = [Door(*map(float, door)) for door in values.get("doors", [])] or _doors(coloured, walls, pixel)
    for door in doors:
        _mark(cells, door, size)
    place = (origin[0] + left * pixel, origin[1] + low * pixel)
    start: tuple | None = tuple(map(float, values["start"])) if values.get("start") else None
    places: dict = {name: tuple(map(float, where)) for name, where in values.get("places", {}).items()}
    return HouseMap(cells, size, walls, pixel, doors, place, start, places, notes, source)


def _cell(width: float, height: float, cell: int | None, source: str) -> int:
    for size in (cell,) if cell else SIZES:
        rows, cols = int(np.ceil(height / size)), int(np.ceil(width / size))
        if rows * cols <= MOST_CELLS and max(rows, cols) <= MOST_SIDE:
            return size
    raise MapError(
        f"{source}: {width / 1000:.1f} x {height / 1000:.1f} m is too large for the board, which holds {MOST_CELLS} cells of at most 1 m: cut the map"
    )


def _grown(solid: np.ndarray, reach: float) -> np.ndarray:
    """Solid pixels, and all nearer to one than `reach` pixels."""
    out = solid.copy()
    n = int(reach)
    for dy in range(-n, n + 1):
        dx = int((reach * reach - dy * dy) ** 0.5)
        moved = np.zeros_like(solid)
        if dy >= 0:
            moved[dy:] = solid[: solid.shape[0] - dy]
        else:
            moved[:dy] = solid[-dy:]
        # along the row, by running sums
        sums = np.pad(moved.astype(np.int32).cumsum(axis=1), ((0, 0), (dx + 1, dx)), mode="edge")
        sums[:, : dx + 1] = 0
        out |= sums[:, 2 * dx + 1 :] - sums[:, : -2 * dx - 1] > 0
    return out


def _cells(blocked: np.ndarray, coloured: np.ndarray, pixel: float, size: int) -> np.ndarray:
    rows, cols = int(np.ceil(blocked.shape[0] * pixel / size)), int(np.ceil(blocked.shape[1] * pixel / size))
    ys = np.minimum(((np.arange(rows) + 0.5) * size / pixel).astype(int), blocked.shape[0] - 1)
    xs = np.minimum(((np.arange(cols) + 0.5) * size / pixel).astype(int), blocked.shape[1] - 1)
    cells = np.where(blocked[ys][:, xs], WALL, FREE).astype(np.uint8)
    cells[coloured[ys][:, xs]] = DOOR
    cells[0] = cells[-1] = WALL
    cells[:, 0] = cells[:, -1] = WALL
    return cells


def _doors(coloured: np.ndarray, walls: np.ndarray, pixel: float) -> list[Door]:
    """Each painted patch is a door, passed across its longer side."""
    from .model import doors_of

    found = doors_of(np.where(coloured, DOOR, np.where(walls, WALL, FREE)).astype(np.uint8), 1)
    return [Door(d.x * pixel, d.y * pixel, d.normal, d.width * pixel) for d in found]


def _mark(cells: np.ndarray, door: Door, size: int) -> None:
    """The cells in which a door lies are door cells."""
    for k in np.linspace(-door.width / 2, door.width / 2, max(int(door.width / size * 4), 2)):
        x, y = door.point(0, k * 0.9)
        row, col = int(y // size), int(x // size)
        if 0 < row < cells.shape[0] - 1 and 0 < col < cells.shape[1] - 1:
            cells[row, col] = DOOR
