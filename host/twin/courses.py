"""The reference courses: walls, where the body starts and when it is through.

Lengths in mm, x right, y up; headings in radians clockwise from +y. A corridor is given by its centre line: the walls are the two mitred
offset curves, the entrance is lengthened and closed behind the robot, the exit is lengthened and open.
"""

from dataclasses import dataclass, field
from math import atan2, cos, hypot, radians, sin

import numpy as np

from . import worlds
from .boxes import scatter

ENTRANCE, EXIT = 700.0, 900.0
START, GOAL = 50.0, 50.0  # the body starts so far before the centre line begins; it is through so far beyond its end
AREA = 2160.0, 1580.0
NAMES = ("Z", "U", "S", "S-sharp", "bend", "random", "alley")
DEFAULT_WIDTH = {"Z": 550, "U": 550, "S": 550, "S-sharp": 550, "bend": 550, "random": 1500, "alley": 450}
ALLEY_LENGTH = 2500.0
ALLEY_START, ALLEY_OUT = 450.0, 700.0  # the centre starts so far before the closed end, and is out so far beyond the mouth
HALL = 2500.0, 4000.0  # half the width and the length of the hall before the mouth
RANDOM_SIZE = 1500.0, 2920.0


@dataclass(frozen=True)
class Course:
    """A course.

    segments: (n, 4) walls and, behind them, the sides of the boxes, x1 y1 x2 y2. floor: (m, 2) corners of the ground between the walls.
    start: x, y, heading. goal: x, y, heading, half width: through when the centre is beyond the point in the heading's direction and no
    further than the half width to its side. boxes: corners of each box, (k, 4, 2).

    Of a file: reached: mm, within which the goal, then a place, counts as reached; 0 where it is a line; without any goal the robot is through once its
    centre has left the square round all walls. moving: worlds.Mover. limit_s: how long a run may take, 0: as usual.
    """

    name: str
    width: float
    segments: np.ndarray
    floor: np.ndarray
    start: tuple
    goal: tuple
    boxes: np.ndarray = field(default_factory=lambda: np.zeros((0, 4, 2)))
    reached: float = 0.0
    moving: tuple = ()
    limit_s: float = 0.0

    def through(self, x, y):
        """True when the body's centre has passed the goal."""
        if self.goal is None:
            low, high = self.floor.min(axis=0), self.floor.max(axis=0)
            return not (low[0] <= x <= high[0] and low[1] <= y <= high[1])
        if self.reached:
            return worlds.reached(self.goal, self.reached, x, y)
        gx, gy, heading, half = self.goal
        dx, dy = x - gx, y - gy
        s, c = sin(heading), cos(heading)
        return dx * s + dy * c > 0 and abs(dx * c - dy * s) <= half


def make(name, width=None, gap=500.0, seed=0, mirror=False, reverse=False, angle=90.0, scale=1.0, length=None, side=False, start=None, goal=None):
    """A course by name, or the world of a file (worlds.py); a Course is given back as it is.

    width: of the corridor. gap: random only, the least distance between obstacles. seed: random only. mirror: left and right
    exchanged. reverse: entered from the other end. angle: bend only, of its two bends (degrees). scale: factor on the area, and so on the
    length of the legs; not on the width. length, side: alley only, see `alley`. start, goal: of a file, see `worlds.load`. ValueError names what is allowed.
    """
    if isinstance(name, Course):
        return name
    if worlds.is_file(name):
        return from_file(name, start, goal, scale, mirror)
    if start is not None or goal is not None:
        raise ValueError(f"start and goal are for worlds from files; {name} has its own")
    if name != "alley" and (length is not None or side):
        raise ValueError(f"length and side are for the alley; {name} has its own shape")
    if name not in NAMES:
        raise ValueError(f"course {name!r} is not known; courses are {', '.join(NAMES)}")
    if name != "bend" and angle != 90:
        raise ValueError(f"an angle is for the bend; {name} has its own shape")
    if not 0.5 <= scale <= 3:
        raise ValueError(f"scale {scale:g} is out of range; 0.5 to 3 is accepted")
    width = float(DEFAULT_WIDTH[name] if width is None else width)
    if not 260 <= width <= 3000:
        raise ValueError(f"width {width:g} mm is out of range; 260 to 3000 is accepted")
    if name == "alley":
        return alley(width, scale * (ALLEY_LENGTH if length is None else length), side, mirror)
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


def alley(width, length=ALLEY_LENGTH, side=False, mirror=False):
    """A blind alley: the robot stands with its nose to the closed end; it is out when its centre is 700 mm outside, however it got there.

    side: closed at its other end too, 2500 mm beyond; the way out is an arm to the right there, as wide as the alley and 3 m long.
    """
    if not 900 <= length <= 20000:
        raise ValueError(f"length {length:g} mm is out of range; 900 to 20000 is accepted")
    half = width / 2
    if side:
        arm = 3000.0
        corners = [(-half, -ALLEY_LENGTH), (-half, length), (half, length), (half, 0), (half + arm, 0)]
        walls = _walls(corners) + _walls([(half + arm, -width), (half, -width), (half, -ALLEY_LENGTH), (-half, -ALLEY_LENGTH)])
        goal = half + ALLEY_OUT, -half, radians(90), width
    else:
        across, along = HALL
        walls = _walls([(-half, 0), (-half, length), (half, length), (half, 0)])
        walls += _walls([(-half, 0), (-across, 0), (-across, -along)]) + _walls([(half, 0), (across, 0), (across, -along), (-across, -along)])
        goal = 0.0, -ALLEY_OUT, radians(180), across
    segments = np.array(walls)
    if mirror:
        segments[:, 0::2] *= -1
        goal = -goal[0], goal[1], -goal[2], goal[3]
    return Course("alley", width, segments, _square(segments), (0.0, length - ALLEY_START, 0.0), goal)


def from_file(path, start=None, goal=None, scale=1.0, mirror=False):
    """The world of a file, see worlds.py; heading of the start in degrees."""
    if not 0.1 <= scale <= 10:
        raise ValueError(f"scale {scale:g} is out of range; 0.1 to 10 is accepted")
    if mirror:
        raise ValueError("a world from a file is not mirrored")
    layout = worlds.load(path, start, goal, scale)
    floor = _square(layout.segments)
    x, y, heading = layout.start
    size = float(np.ptp(floor, axis=0).min())
    return Course(
        str(path), size, layout.segments, floor, (x, y, radians(heading)), layout.goal, reached=layout.reached, moving=layout.moving, limit_s=worlds.LIMIT_S
    )


def _walls(corners):
    """Segments along a line of corners."""
    return [(*a, *b) for a, b in zip(corners, corners[1:])]


def _square(segments):
    """Corners of the square round all segments."""
    (x0, y0), (x1, y1) = worlds.extent(segments)
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


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
