"""Worlds from files: what a robot met elsewhere, as a course of the twin.

    .yaml, .png, .pgm   a map of the ROS map_server: the image and, beside it, its YAML (resolution, origin, negate, occupied_thresh)
    .world, .sdf        a Gazebo world of cylinders and boxes, such as those of the BARN data set (D. Perille et al., Benchmarking Metric Ground Navigation, 2020)
    .npy                a grid of the BARN data set: cells of 150 mm, each that is not 0 a cylinder
    .json               {"segments": [[x1, y1, x2, y2], ...], "start": [x, y, heading], "goal": [x, y], "moving": [...]}, or the list of segments alone

Lengths of a JSON are mm, those of the others metres, as their makers write them. The twin has mm, x right, y up, headings in degrees clockwise from +y.
Moving boxes of a JSON: {"size": [across, along], "heading": degrees, "path": [[s, x, y], ...], "again": true}; from place to place they go at an even speed.
"""

import json
from dataclasses import dataclass
from math import cos, hypot, pi, radians, sin
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

SUFFIXES = (".yaml", ".yml", ".png", ".pgm", ".world", ".sdf", ".npy", ".json")
REACHED = 500.0  # mm: the centre has come so near to a goal that was given as a place
LIMIT_S = 200.0
BARN_CELL, BARN_RADIUS = 150.0, 75.0
BARN_START, BARN_GOAL, BARN_REACHED = (-2000.0, 3000.0, 0.0), (-2000.0, 13000.0), 1000.0  # of its challenge
SIDES = 12  # of a cylinder
MOST = 40_000  # segments; more would take the twin longer than anybody waits


@dataclass(frozen=True)
class Mover:
    """A box that moves: corners (4, 2) about its centre, mm; times (n,) s and places (n, 2); again: whether it starts over at the end of its path."""

    corners: np.ndarray
    times: np.ndarray
    places: np.ndarray
    again: bool = False

    def at(self, time):
        """Its sides (4, 4), x1 y1 x2 y2, at the time, s."""
        first, last = self.times[0], self.times[-1]
        if self.again and last > first:
            time = first + (time - first) % (last - first)
        corners = self.corners + [np.interp(time, self.times, self.places[:, k]) for k in (0, 1)]
        return np.hstack([corners, np.roll(corners, -1, axis=0)])


@dataclass
class Layout:
    """What a file holds: segments (n, 4) and boxes (k, 4, 2) in mm; start, goal and reached where it names them; moving: Movers."""

    segments: np.ndarray
    start: tuple | None = None
    goal: tuple | None = None
    reached: float = REACHED
    moving: tuple = ()


def is_file(name):
    """True for what names a file of a world rather than a course."""
    return Path(name).suffix.lower() in SUFFIXES


def load(path, start=None, goal=None, scale=1.0):
    """The Layout of a file, every length times `scale`; start (x, y, degrees) and goal (x, y) in mm take the place of the file's, and are not scaled.

    ValueError names the file, what is wrong, and what to do.
    """
    path = Path(path)
    kind = path.suffix.lower()
    readers = {".world": _gazebo, ".sdf": _gazebo, ".npy": _grid, ".json": _json}
    try:
        layout = readers.get(kind, _map)(path)
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror or error}") from None
    if not len(layout.segments):
        raise ValueError(f"{path} holds no wall: there is nothing to drive round")
    if len(layout.segments) > MOST:
        raise ValueError(f"{path} holds {len(layout.segments)} pieces of wall, {MOST} are accepted: take a coarser map")
    layout.segments = layout.segments * scale
    layout.reached *= scale
    layout.moving = tuple(Mover(m.corners * scale, m.times, m.places * scale, m.again) for m in layout.moving)
    layout.start = start or (layout.start and (layout.start[0] * scale, layout.start[1] * scale, layout.start[2]))
    if goal is not None:
        layout.goal, layout.reached = goal, REACHED
    elif layout.goal:
        layout.goal = tuple(v * scale for v in layout.goal)
    if layout.start is None:
        raise ValueError(f"{path} does not say where the robot starts: give --start X,Y,HEADING (mm and degrees clockwise from +y)")
    return layout


def _numbers(values, count, what):
    """A tuple of `count` numbers. ValueError if it is none."""
    if not isinstance(values, list) or len(values) != count or not all(isinstance(v, int | float) and abs(v) < 1e6 for v in values):
        raise ValueError(f"{what} is {values!r}; {count} numbers are needed")
    return tuple(float(v) for v in values)


def _json(path):
    try:
        data = json.loads(path.read_text())
    except ValueError as error:
        raise ValueError(f"{path} is not JSON: {error}") from None
    if isinstance(data, list):
        data = {"segments": data}
    if not isinstance(data, dict) or not isinstance(data.get("segments"), list):
        raise ValueError(f'{path} has no "segments": a list of [x1, y1, x2, y2] in mm is needed')
    unknown = set(data) - {"segments", "start", "goal", "moving"}
    if unknown:
        raise ValueError(f'{path}: {sorted(unknown)[0]!r} is not known; there are "segments", "start", "goal" and "moving"')
    try:
        walls = [_numbers(s, 4, f"segments[{i}]") for i, s in enumerate(data["segments"])]
        start = _numbers(data["start"], 3, '"start"') if "start" in data else None
        goal = _numbers(data["goal"], 2, '"goal"') if "goal" in data else None
        if not isinstance(data.get("moving", []), list):
            raise ValueError('"moving" must be a list')
        moving = tuple(mover(m, f"moving[{i}]") for i, m in enumerate(data.get("moving", [])))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return Layout(np.array(walls).reshape(-1, 4), start, goal, moving=moving)


def mover(entry, what):
    if not isinstance(entry, dict) or set(entry) - {"size", "heading", "path", "again"} or not isinstance(entry.get("path"), list) or not entry["path"]:
        raise ValueError(f'{what} must be an object of "size" [across, along], "path" [[s, x, y], ...] and, if wished, "heading" and "again"')
    size = _numbers(entry.get("size"), 2, f"{what}.size")
    steps = np.array([_numbers(step, 3, f"{what}.path[{i}]") for i, step in enumerate(entry["path"])])
    if (np.diff(steps[:, 0]) <= 0).any():
        raise ValueError(f"{what}.path: its times must rise")
    turn = radians(_numbers([entry.get("heading", 0)], 1, f"{what}.heading")[0])
    return Mover(_box(0.0, 0.0, size[0], size[1], turn), steps[:, 0], steps[:, 1:], bool(entry.get("again")))


def _box(x, y, across, along, turn):
    """Corners (4, 2) of a rectangle, turned clockwise by `turn` radians."""
    s, c = sin(turn), cos(turn)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (across / 2, along / 2)
    return corners @ np.array([(c, -s), (s, c)]) + (x, y)


def _closed(corners):
    return np.hstack([corners, np.roll(corners, -1, axis=0)])


def _round(x, y, radius):
    turn = np.arange(SIDES) * 2 * pi / SIDES
    return _closed(np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1) if radius else np.zeros((0, 2)))


def _gazebo(path):
    """Every cylinder and box of a world that stands upright on the floor."""
    try:
        root = ElementTree.fromstring(path.read_text())
    except ElementTree.ParseError as error:
        raise ValueError(f"{path} is not a Gazebo world: {error}") from None
    poses = {}
    for model in root.iterfind(".//state/model"):
        poses[model.get("name")] = _pose(model, path)
    shapes = []
    for model in root.iterfind("./world/model"):
        at = poses.get(model.get("name")) or _pose(model, path)
        for link in model.iterfind("link"):
            for part in link.iterfind("collision"):
                pose = _joined(_joined(at, _pose(link, path)), _pose(part, path))
                shapes += _shape(part, pose, path)
    segments = np.vstack(shapes) * 1000 if shapes else np.zeros((0, 4))
    return Layout(segments, BARN_START, BARN_GOAL, BARN_REACHED)


def _pose(element, path):
    """x, y (m) and yaw (anticlockwise, radians) of an element."""
    text = element.findtext("pose") or "0 0 0 0 0 0"
    try:
        x, y, _, _, _, yaw = (float(v) for v in text.split())
    except ValueError:
        raise ValueError(f"{path}: the pose {text!r} is not six numbers") from None
    return x, y, yaw


def _joined(first, second):
    s, c = sin(first[2]), cos(first[2])
    return first[0] + second[0] * c - second[1] * s, first[1] + second[0] * s + second[1] * c, first[2] + second[2]


def _shape(part, pose, path):
    x, y, yaw = pose
    radius, size = part.findtext("geometry/cylinder/radius"), part.findtext("geometry/box/size")
    try:
        if radius is not None:
            return [_round(x, y, float(radius))]
        if size is not None:
            across, along, _ = (float(v) for v in size.split())
            return [_closed(_box(x, y, across, along, -yaw))]
    except ValueError:
        raise ValueError(f"{path}: a shape of {radius or size!r} is not understood") from None
    return []  # the ground


def _grid(path):
    """A BARN grid: its first row is the one at the left, and the robot comes from below its first column."""
    try:
        cells = np.load(path, allow_pickle=False)
    except ValueError as error:
        raise ValueError(f"{path} is not an array of numpy: {error}") from None
    if cells.ndim != 2 or cells.dtype.kind not in "biuf":
        raise ValueError(f"{path} holds no grid: rows and columns of numbers are needed")
    shapes = [_round((i + 0.5) * BARN_CELL, (j + 0.5) * BARN_CELL, BARN_RADIUS) for i, j in np.argwhere(cells != 0)]
    return Layout(np.vstack(shapes) if shapes else np.zeros((0, 4)))


def _map(path):
    """A map of the map_server, given by its YAML or by its image."""
    import yaml
    from PIL import Image, UnidentifiedImageError

    said = path
    if path.suffix.lower() not in (".yaml", ".yml"):
        if not path.exists():
            raise ValueError(f"{path} cannot be read: no such file")
        beside = [path.with_suffix(suffix) for suffix in (".yaml", ".yml")]
        said = next((p for p in beside if p.exists()), None)
        if said is None:
            raise ValueError(f"{path} is an image without its map: {beside[0].name} (resolution, origin) must lie beside it")
    try:
        values = yaml.safe_load(said.read_text())
    except yaml.YAMLError as error:
        raise ValueError(f"{said} is not YAML: {str(error).splitlines()[0]}") from None
    try:
        cell = float(values["resolution"]) * 1000
        origin = [float(v) * (1000, 1000, 1)[k] for k, v in enumerate(values["origin"][:3])]
        negate = bool(int(values.get("negate", 0)))
        occupied = float(values.get("occupied_thresh", 0.65))
        image = path if path != said else said.parent / values["image"]
        if not cell > 0 or len(origin) < 2:
            raise ValueError
    except (KeyError, TypeError, ValueError, AttributeError, IndexError):
        raise ValueError(f"{said} is no map: image, resolution (m) and origin [x, y, yaw] are needed") from None
    try:
        with Image.open(image) as picture:
            grey = np.asarray(picture.convert("LA" if "A" in picture.getbands() else "L"), float)
    except UnidentifiedImageError:
        raise ValueError(f"{image} is not an image: PNG or PGM is needed") from None
    seen = np.ones(grey.shape[:2], bool)
    if grey.ndim == 3:
        grey, seen = grey[..., 0], grey[..., 1] > 127  # what is transparent is unknown
    share = grey / 255 if negate else 1 - grey / 255
    edges = outlines(np.flipud((share > occupied) & seen)) * cell
    turn = origin[2] if len(origin) > 2 else 0.0
    s, c = sin(turn), cos(turn)
    ends = edges.reshape(-1, 2) @ np.array([(c, s), (-s, c)]) + origin[:2]
    return Layout(ends.reshape(-1, 4))


def outlines(solid):
    """The borders between solid and free cells as segments (n, 4), each as long as it goes on straight; solid: (rows, columns), row 0 lowest."""
    found = []
    for turned in (False, True):
        cells = np.pad(solid.T if turned else solid, 1)
        change = np.diff(cells.astype(np.int8), axis=0)  # between a row and the one above
        for row in np.flatnonzero(change.any(axis=1)):
            line = change[row]
            ends = np.flatnonzero(np.diff(np.concatenate([[0], line, [0]])))
            for first, last in zip(ends, ends[1:]):
                if line[first]:
                    a, b, at = first - 1.0, last - 1.0, float(row)
                    found.append((at, a, at, b) if turned else (a, at, b, at))
    return np.array(found).reshape(-1, 4)


def extent(segments):
    """Lower left and upper right corner of all there is."""
    points = segments.reshape(-1, 2)
    return points.min(axis=0), points.max(axis=0)


def reached(goal, radius, x, y):
    return hypot(x - goal[0], y - goal[1]) <= radius
