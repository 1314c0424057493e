"""Obstacles (discs, boxes, half planes) and the paper's scenes. Metres inside, mm and degrees in files."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from .errors import ArmError
from .model import numbers


@dataclass(frozen=True)
class Disc:
    """Centre and radius, m."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class Box:
    """Centre, width and height, m, turned counter-clockwise by `angle`, rad."""

    x: float
    y: float
    width: float
    height: float
    angle: float = 0.0


@dataclass(frozen=True)
class HalfPlane:
    """All that lies beyond the line through (x, y); `angle`, rad, points out of it, to where the arm may be: pi / 2 for a floor."""

    x: float
    y: float
    angle: float


Obstacle = Disc | Box | HalfPlane


@dataclass(frozen=True)
class Scene:
    """start and end: (x, y, angle) of the arm's end in m and rad, None where the person gives them."""

    name: str
    obstacles: tuple[Obstacle, ...] = ()
    start: tuple[float, float, float] | None = None
    end: tuple[float, float, float] | None = None
    notes: str = field(default="", compare=False)


# The end of the paper's experiments is their start turned by 90 degrees about the base, so its angle is 190.
_START, _END = (0.5, 2.0, math.radians(100)), (-2.0, 0.5, math.radians(190))
_FIRST = Disc(0.0, 2.0, 0.35)

SCENES = {
    "paper-1": Scene("paper-1", (_FIRST,), _START, _END, "experiment I"),
    "paper-2": Scene("paper-2", (_FIRST, Disc(-1.3, 1.6, 0.21), Disc(-1.9, 1.0, 0.16)), _START, _END, "experiment II"),
    "free": Scene("free", (), _START, _END, "the paper's poses without an obstacle"),
}


def scene(name: str) -> Scene:
    """A scene by its name. ArmError where there is none."""
    if name not in SCENES:
        raise ArmError(f"no scene {name!r}: there are {', '.join(SCENES)}")
    return SCENES[name]


def disc(values, where: str) -> Disc:
    """A Disc from [x, y, radius] in mm."""
    x, y, radius = numbers(values, 3, where, -100000, 100000)
    if radius <= 0:
        raise ArmError(f"{where}: radius = {radius:g}: above 0 mm is needed")
    return Disc(x / 1000, y / 1000, radius / 1000)


def box(values, where: str) -> Box:
    """A Box from [x, y, width, height] or [.., angle] in mm and degrees."""
    if isinstance(values, list | tuple) and len(values) == 4:
        values = [*values, 0]
    x, y, width, height, angle = numbers(values, 5, where, -100000, 100000)
    if width <= 0 or height <= 0:
        raise ArmError(f"{where}: width and height must lie above 0 mm")
    return Box(x / 1000, y / 1000, width / 1000, height / 1000, math.radians(angle))


def half_plane(values, where: str) -> HalfPlane:
    """A HalfPlane from [x, y, angle] in mm and degrees."""
    x, y, angle = numbers(values, 3, where, -100000, 100000)
    return HalfPlane(x / 1000, y / 1000, math.radians(angle))


def as_file(obstacle: Obstacle) -> dict:
    """An obstacle as it stands in files: one key, its numbers in mm and degrees."""
    mm = [round(1000 * v, 6) for v in (obstacle.x, obstacle.y)]
    if isinstance(obstacle, Disc):
        return {"disc": [*mm, round(1000 * obstacle.radius, 6)]}
    degrees = round(math.degrees(obstacle.angle), 9)
    if isinstance(obstacle, Box):
        return {"box": [*mm, round(1000 * obstacle.width, 6), round(1000 * obstacle.height, 6), degrees]}
    return {"half_plane": [*mm, degrees]}


_KINDS: dict[str, Callable[[object, str], Obstacle]] = {"disc": disc, "box": box, "half_plane": half_plane}


def from_file(values, where: str) -> Obstacle:
    """The obstacle of one entry of a file. ArmError names what is wrong."""
    if not isinstance(values, dict) or len(values) != 1 or next(iter(values)) not in _KINDS:
        raise ArmError(f'{where}: one of {", ".join(_KINDS)} with its numbers is needed, as {{"disc": [0, 2000, 350]}}')
    kind = next(iter(values))
    return _KINDS[kind](values[kind], f"{where}.{kind}")
