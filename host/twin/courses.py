"""The reference courses: walls, where the body starts and when it is through.

Lengths in mm, x right, y up; headings in radians clockwise from +y. A corridor is given by its centre line: the walls are the two mitred
offset curves, the entrance is lengthened and closed behind the robot, the exit is lengthened and open.
"""

from dataclasses import dataclass, field
from math import atan2, cos, hypot, radians, sin

import numpy as np

from .boxes import scatter

ENTRANCE, EXIT = 700.0, 900.0
START, GOAL = 50.0, 50.0  # the body starts so far before the centre line begins; it is through so far beyond its end
AREA = 2160.0, 1580.0
NAMES = ("Z", "U", "S", "S-sharp", "bend", "random")
DEFAULT_WIDTH = {"Z": 550, "U": 550, "S": 550, "S-sharp": 550, "bend": 550, "random": 1500}
RANDOM_SIZE = 1500.0, 2920.0


@dataclass(frozen=True)
class Course:
    """A course.

    segments: (n, 4) walls and, behind them, the sides of the boxes, x1 y1 x2 y2. floor: (m, 2) corners of the ground between the walls.
    start: x, y, heading. goal: x, y, heading, half width: through when the centre is beyond the point in the heading's direction and no
    further than the half width to its side. boxes: corners of each box, (k, 4, 2).
    """

    name: str
    width: float
    segments: np.ndarray
    floor: np.ndarray
    start: tuple
    goal: tuple
    boxes: np.ndarray = field(default_factory=lambda: np.zeros((0, 4, 2)))

    def through(self, x, y):
        """True when the body's centre has passed the goal."""
        gx, gy, heading, half = self.goal
        dx, dy = x - gx, y - gy
        s, c = sin(heading), cos(heading)
        return dx * s + dy * c > 0 and abs(dx * c - dy * s) <= half


def make(name, width=None, gap=500.0, seed=0, mirror=False, reverse=False, angle=90.0, scale=1.0):
    """A course by name.

    width: of the corridor. gap: random only, the least distance between obstacles. seed: random only. mirror: left and right
    exchanged. reverse: entered from the other end. angle: bend only, of its two bends (degrees). scale: factor on the area, and so on the
    length of the legs; not on the width. ValueError names what is allowed.
    """
    if name not in NAMES:
        raise ValueError(f"course {name!r} is not known; courses are {', '.join(NAMES)}")
    if name != "bend" and angle != 90:
        raise ValueError(f"an angle is for the bend; {name} has its own shape")
    if not 0.5 <= scale <= 3:
        raise ValueError(f"scale {scale:g} is out of range; 0.5 to 3 is accepted")
    width = float(DEFAULT_WIDTH[name] if width is None else width)
    if not 260 <= width <= 3000:
        raise ValueError(f"width {width:g} mm is out of range; 260 to 3000 is accepted")
    if name == "random":
        if not 100 <= gap <= 1500:
            raise ValueError(f"gap {gap:g} mm is out of range; 100 to 1500 is accepted")
        width, length = scale * RANDOM_SIZE[0], scale * RANDOM_SIZE[1]
        boxes = scatter((width, length), gap, np.random.default_rng([seed, 6]))
        line = np.array([[width / 2, 0.0], [width / 2, length]])
    else:
        boxes = np.zeros((0, 4, 2))
        line = centre_line(name, width, angle, scale)
    if mirror:
        line, boxes = _mirrored(line, boxes, scale * AREA[0] if name != "random" else width)
    if reverse:
        line = line[::-1]
    return corridor(name, line, width, boxes)


def centre_line(name, width, angle=90.0, scale=1.0):
    """Corners of a corridor's centre line, (n, 2)."""
    half = width / 2
    right, top = scale * AREA[0], scale * AREA[1]
    if name == "Z":
        return np.array([(half, 0), (half, top / 2), (right - half, top / 2), (right - half, top)], float)
    if name == "U":
        return np.array([(right - half, top), (right - half, half), (half, half), (half, top)], float)
    if name == "bend":
        if not 20 <= angle <= 120:
            raise ValueError(f"angle {angle:g} is out of range; 20 to 120 degrees is accepted")
        leg, across, turn = top / 2, scale * (AREA[0] - width), radians(angle)
        first = np.array([0.0, leg])
        second = first + across * np.array([sin(turn), cos(turn)])
        return np.array([(0.0, 0.0), first, second, second + (0.0, leg)])
    corner = 2520.0 if name == "S-sharp" else 2250.0
    return scale * np.array([(3550, 1400), (2750, 1400), (corner, 450), (1350, 450), (850, 1350), (0, 1350)], float)


def corridor(name, line, width, boxes=None):
    """The course along a centre line, (n, 2)."""
    boxes = np.zeros((0, 4, 2)) if boxes is None else boxes
    first, last = _unit(line[1] - line[0]), _unit(line[-1] - line[-2])
    path = line.copy()
    path[0] -= ENTRANCE * first
    path[-1] += EXIT * last
    left, right = offset(path, width / 2), offset(path, -width / 2)
    if any((np.diff(side, axis=0) * np.diff(path, axis=0)).sum(axis=1).min() <= 0 for side in (left, right)):
        raise ValueError(f"a passage {width:g} mm wide does not fit into the area of {name}: make it narrower or the scale larger")
    walls = [np.hstack([side[:-1], side[1:]]) for side in (left, right)]
    walls.append(np.hstack([left[0], right[0]])[None])
    walls += [np.hstack([box, np.roll(box, -1, axis=0)]) for box in boxes]
    start = line[0] - START * first
    goal = line[-1] + GOAL * last
    return Course(
        name,
        width,
        np.vstack(walls),
        np.vstack([left, right[::-1]]),
        (start[0], start[1], atan2(first[0], first[1])),
        (goal[0], goal[1], atan2(last[0], last[1]), width / 2),
        boxes,
    )


def offset(line, distance):
    """The mitred offset curve of a line, (n, 2), `distance` to its left."""
    directions = np.diff(line, axis=0)
    directions /= np.hypot(*directions.T)[:, None]
    normals = np.stack([-directions[:, 1], directions[:, 0]], axis=1)
    before = np.vstack([normals[:1], normals])
    after = np.vstack([normals, normals[-1:]])
    return line + distance * (before + after) / (1 + np.sum(before * after, axis=1))[:, None]


def _mirrored(line, boxes, size):
    """Left and right exchanged about the middle of the area, `size` wide."""
    line, boxes = line.copy(), boxes.copy()
    line[:, 0] = size - line[:, 0]
    boxes[..., 0] = size - boxes[..., 0]
    return line, boxes


def _unit(vector):
    return vector / hypot(*vector)
