"""Rooms made at random, as people have them: hallways with blind arms, furnished rooms, people who walk about.

Every function takes a seed and gives a Course; the same seed gives the same room. Lengths in mm.
"""

from math import cos, hypot, pi, sin

import numpy as np

from .courses import Course
from .worlds import Mover, extent

LEG = 25.0  # of a table or a chair, square
DOOR = 900.0
BOX = 300.0


def hallway(seed, width=None):
    """A hallway, open at its far end, with two or three blind arms on the way; the robot starts at its closed end, or with its nose in an arm.

    Grown from a line of cells: the hallway along y, arms to either side, one to three widths deep.
    """
    random = np.random.default_rng([seed, 31])
    width = width or float(random.choice([700, 800, 900]))
    cells = {(0, j) for j in range(8)}
    arms = []
    for j in sorted(random.choice([1, 3, 5], int(random.integers(2, 4)), replace=False)):
        side, deep = int(random.choice([-1, 1])), int(random.integers(2, 5))
        arms.append((side * deep, int(j)))
        cells |= {(side * k, int(j)) for k in range(1, deep + 1)}
    # The open end leads into a room, or nothing would be there to be seen.
    half, end, room = width / 2, 7.5 * width, 2500.0
    walls = outline(cells, width, {(0, 7)})
    corners = [(-half, end), (-room, end), (-room, end + 3000), (room, end + 3000), (room, end), (half, end)]
    walls = np.vstack([walls, [(*a, *b) for a, b in zip(corners, corners[1:])]])
    if random.random() < 0.5:
        start = 0.0, 0.0, 0.0
    else:
        at, j = arms[0]
        start = at * width, j * width, pi / 2 if at > 0 else -pi / 2
    return _course("hallway", walls, start, (0.0, end + 400, 0.0, room), limit_s=120.0)


def outline(cells, size, open_above=()):
    """Walls round square cells (i, j) centred at (i, j) * size, but for the upper sides of those in open_above."""
    half, walls = size / 2, []
    for i, j in sorted(cells):
        x, y = i * size, j * size
        sides = {
            (0, 1): (-half, half, half, half),
            (0, -1): (-half, -half, half, -half),
            (-1, 0): (-half, -half, -half, half),
            (1, 0): (half, -half, half, half),
        }
        for (di, dj), (x1, y1, x2, y2) in sides.items():
            if (i + di, j + dj) not in cells and not (dj == 1 and (i, j) in open_above):
                walls.append((x + x1, y + y1, x + x2, y + y2))
    return np.array(walls, float)


def furnished(seed, size=5000.0):
    """A room of 5 x 5 m with a door 900 mm wide in its upper wall and four tables on legs of 25 mm; chairs stand round them."""
    random = np.random.default_rng([seed, 32])
    door = float(random.uniform(600, size - 600 - DOOR))
    walls = [(0, 0, size, 0), (0, 0, 0, size), (size, 0, size, size), (0, size, door, size), (door + DOOR, size, size, size)]
    walls += [(0, size, 0, size + 2000), (0, size + 2000, size, size + 2000), (size, size, size, size + 2000)]  # a hall behind the door
    start = np.array([random.uniform(700, size - 700), random.uniform(600, 1200)])
    boxes: list[np.ndarray] = []
    middle = np.array([door + DOOR / 2, size])
    for _ in range(4):
        for _ in range(100):
            centre, turn = random.uniform(900, size - 900, 2), random.uniform(0, pi)
            table = random.uniform(500, 1000), random.uniform(800, 1600)
            legs = _corners(centre, *table, turn)
            chairs = [_corners(centre + _along(turn + k * pi / 2, 300 + table[1 - k % 2] / 2), 400, 400, turn) for k in range(4) if random.random() < 0.5]
            feet = np.vstack([legs, *chairs])
            free = feet.min() > 100 and feet.max() < size - 100
            # The robot stands clear, the door can be come to, and no gap is so narrow that nobody can tell whether it is one.
            if free and _far(feet, start, 600) and _far(feet, middle, 900) and all(_apart(feet, other) for other in boxes):
                boxes += [_corners(foot, LEG, LEG, turn) for foot in feet]
                break
    sides = [np.hstack([box, np.roll(box, -1, axis=0)]) for box in boxes]
    segments = np.vstack([np.array(walls, float), *sides])
    heading = float(random.uniform(-pi, pi))
    return _course("furnished", segments, (*start, heading), (middle[0], size + 400, 0.0, DOOR), np.array(boxes).reshape(-1, 4, 2), limit_s=120.0)


def _far(feet, place, least):
    return np.hypot(*(feet - place).T).min() > least


def _apart(feet, other):
    """The feet of another table keep at least a passage away."""
    return np.hypot(*(feet - other.mean(axis=0)).T).min() > 450


def people(seed, kind=None):
    """A hall 4 m wide through which the robot drives, and somebody, 300 x 300 mm, who crosses, walks ahead, or comes at it at 0.3 to 1.2 m/s.

    kind: cross, ahead or towards; None: by the seed, two of four cross.
    """
    random = np.random.default_rng([seed, 33])
    kind = kind or ("cross", "towards", "cross", "ahead")[seed % 4]
    speed = float(random.uniform(300, 1200))
    walls = np.array([(-2000, -900, -2000, 7000), (2000, -900, 2000, 7000), (-2000, -900, 2000, -900), (-2000, 7000, 2000, 7000)], float)
    sideways, far = float(random.uniform(-150, 150)), 6500.0
    # It drives off after about 5 s, at about 260 mm/s.
    if kind == "cross":
        y, side = float(random.uniform(900, 2500)), int(random.choice([-1, 1]))
        meets = 5.0 + (y - 300) / 260 + random.uniform(-1.0, 1.0)
        places = [(-side * 1800.0, y), (side * 1800.0, y)]
    elif kind == "ahead":
        meets = 6.0
        places = [(sideways, 900.0), (sideways, far)]
    else:
        meets = 12.0
        places = [(sideways, far), (sideways, -700.0)]
    length = hypot(places[1][0] - places[0][0], places[1][1] - places[0][1])
    first = {"cross": meets - length / 2 / speed, "ahead": meets, "towards": max(meets - far / speed, 0.0)}[kind]
    if kind == "cross" and first < 0:
        first = 0.0
    mover = Mover(_corners((0.0, 0.0), BOX, BOX, 0.0), np.array([first, first + length / speed]), np.array(places))
    return _course(f"people-{kind}", walls, (0.0, 0.0, 0.0), (0.0, 3800.0, 0.0, 2000.0), moving=(mover,), limit_s=60.0)


def _along(turn, distance):
    return np.array([distance * sin(turn), distance * cos(turn)])


def _corners(centre, across, along, turn):
    s, c = sin(turn), cos(turn)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (across / 2, along / 2)
    return corners @ np.array([(c, -s), (s, c)]) + centre


def _course(name, segments, start, goal, boxes=None, **more):
    (x0, y0), (x1, y1) = extent(segments)
    floor = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    boxes = np.zeros((0, 4, 2)) if boxes is None else boxes
    return Course(name, float(min(x1 - x0, y1 - y0)), segments, floor, tuple(float(v) for v in start), goal, boxes, **more)
