"""A house with a map: paper C's two rooms, or a map's own, with what the map does not have, and the errand that the robot is sent on.

The world is the map's walls, each up to 25 mm from where the map has it, and boxes that the map does not have. The start is up to 150 mm and 6 degrees from the one that the
robot is told. Source: paper C, section 3, its figures made good as far as its runs allow.
"""

from dataclasses import dataclass
from math import cos, hypot, inf, pi, radians, sin
from pathlib import Path

import numpy as np

from host.floorplan import board_file, drawn
from host.floorplan.model import FREE, WALL, HouseMap

from . import worlds
from .boxes import distance
from .courses import Course
from .image import ROOT

HOUSE = ROOT / "maps" / "house.json"
LIMIT_S = 180.0
WALLS_OFF = 25.0
START_OFF, TURN_OFF = 93.0, 1.0  # Simulation adds up to 57 mm and 5 degrees to these
PLANTS = ((2300, 4900, 2700, 5300), (6600, 6000, 7000, 6400))
RING = (6500, 4350, 7800, 5650, 150)
POCKET = (3000, 4300, 1300, 900, 100)  # x, y of the middle of its bottom, width, depth, thickness; open to the left below
SIDES = 200.0, 500.0
APART = 480.0  # of boxes from each other and from walls, or they touch
CLEAR = 700.0  # round start, goal and doors
PERSON = 500.0, 300.0, 300.0  # across, along, mm/s
SHUT, OPEN = "shut", "open"


@dataclass(frozen=True)
class Plan:
    """What stands in the house, and the errand.

    map: file of a map drawn by hand. door: mm that the first door is open, SHUT or None for as the paper has it (600 of 900; other maps: open). walled: a ring round
    the goal. boxes: how many the map does not have. pocket: a U in the way. goal: x, y or None for the map's place "goal". start: x, y, heading, or None. method: gap, field or behaviour, None as
    robot.json says. person: one crosses the way. shuts, opens: s after which the door shuts, or opens. lost: nobody tells the robot where it stands; it may be anywhere. go_on: after an alarm it is
    told to go on once the door is open. by_hand: a page tells it what to do.
    """

    map: str | None = None
    door: float | str | None = None
    walled: bool = False
    boxes: int = 0
    pocket: bool = False
    goal: tuple | None = None
    start: tuple | None = None
    method: str | None = None
    person: bool = False
    shuts: float | None = None
    opens: float | None = None
    lost: bool = False
    go_on: bool = False
    by_hand: bool = False


@dataclass
class House:
    """course: Course. house: HouseMap. told: the pose that the robot is told, None: none. goal: x, y. closing: (n, 4) segments of what closes the way, for seen_at_s."""

    course: Course
    house: HouseMap
    told: tuple | None
    goal: tuple
    closing: np.ndarray

    @property
    def map_bytes(self):
        return board_file.encode(self.house)


def build(plan, seed):
    """The House of a plan. ValueError says what cannot be."""
    house = drawn.read(Path(plan.map) if plan.map else HOUSE)
    papers = not plan.map
    random = np.random.default_rng([seed, 0xC])
    goal = plan.goal or house.places.get("goal")
    told = plan.start or house.start
    if goal is None or told is None:
        raise ValueError(
            f'{house.source} has no {"start" if told is None else "goal"}: give --start X,Y,HEADING and --goal X,Y, or put "start" and "places" into the file'
        )
    for what, place in (("goal", goal), ("start", told)):
        if house.cells[house.at(*place[:2])] == WALL:
            raise ValueError(f"the {what} {place[0]:g}, {place[1]:g} lies in a wall of {house.source}")
    walls = _walls(house, random if seed else None)
    boxes = [_rectangle(*one) for one in PLANTS] if papers else []
    closing, moving = [], []
    door = 600.0 if plan.door is None and papers and plan.shuts is None and plan.opens is None else plan.door
    if door is not None and door != OPEN:
        if not house.doors:
            raise ValueError(f"{house.source} has no door")
        plant = _plant(house.doors[0], 0.0 if door == SHUT else float(door))
        if plant is not None:
            boxes.append(plant)
        if door == SHUT:
            closing.append(plant)
    if plan.shuts is not None or plan.opens is not None:
        mover = _leaf(house.doors[0], plan.shuts, plan.opens)
        moving.append(mover)
    if plan.walled:
        ring = _ring(goal, papers)
        boxes += ring
        closing += ring
    if plan.pocket:
        boxes += _pocket()
    if plan.person:
        moving.append(_person(house, told, goal, seed))
    start = told
    if plan.lost:
        start = _anywhere(house, boxes, random)
    elif seed:
        r, a = START_OFF * random.uniform(0, 1) ** 0.5, random.uniform(0, 2 * pi)
        start = told[0] + r * sin(a), told[1] + r * cos(a), told[2] + random.uniform(-TURN_OFF, TURN_OFF)
    boxes += _scatter(house, plan.boxes, boxes, (start, goal), np.random.default_rng([seed, 0xB]))
    segments = np.vstack([walls] + [worlds_closed(box) for box in boxes])
    width, height = house.size
    floor = np.array([(0, 0), (width, 0), (width, height), (0, height)], float)
    course = Course(
        "house", float(house.cell), segments, floor, (start[0], start[1], radians(start[2])), (0.0, 1e9, 0.0, inf),
        np.array(boxes).reshape(-1, 4, 2), moving=tuple(moving), limit_s=LIMIT_S,
    )  # fmt: skip
    sides = [worlds_closed(box) for box in closing]
    return House(course, house, None if plan.lost else told, goal, np.vstack(sides) if sides else np.zeros((0, 4)))


def worlds_closed(corners):
    """The sides of a polygon, (n, 4)."""
    return np.hstack([corners, np.roll(corners, -1, axis=0)])


def _walls(house, random):
    """Outlines of the walls, each line of them up to WALLS_OFF from its place on the map."""
    segments = worlds.outlines(house.walls) * house.pixel
    if random is None:
        return segments
    for axis in (0, 1):
        values = np.unique(segments[:, axis::2])
        moved = values + random.uniform(-WALLS_OFF, WALLS_OFF, len(values))
        for k in (axis, axis + 2):
            segments[:, k] = moved[np.searchsorted(values, segments[:, k])]
    return segments


def _rectangle(x0, y0, x1, y1):
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], float)


def _plant(door, opening):
    """What stands in a door so that `opening` mm are left at the end that lies to the left along its normal... seen from above: it fills the door from its right end."""
    if opening >= door.width:
        return None
    half, deep = door.width / 2, 150.0
    corners = [door.point(a, s) for a, s in ((-deep, half), (deep, half), (deep, opening - half), (-deep, opening - half))]
    return np.array(corners, float)


def _leaf(door, shuts, opens):
    """A door's leaf that slides out of the wall, and back."""
    half = door.width / 2
    corners = np.array([door.point(a, s) for a, s in ((-60, half), (60, half), (60, -half), (-60, -half))]) - (door.x, door.y)
    inside, there = np.array(door.point(0, 2 * half)), np.array((door.x, door.y))
    if shuts is not None and opens is None:
        times, places = [0, shuts, shuts + 1.5], [inside, inside, there]
    elif shuts is None:
        times, places = [0, opens, opens + 1.5], [there, there, inside]
    else:
        times, places = [0, shuts, shuts + 1.5, opens, opens + 1.5], [inside, inside, there, there, inside]
    return worlds.Mover(corners, np.array(times, float), np.array(places, float))


def _ring(goal, papers):
    x0, y0, x1, y1, thick = RING if papers else (goal[0] - 650, goal[1] - 650, goal[0] + 650, goal[1] + 650, 150)
    return [
        _rectangle(x0, y0, x1, y0 + thick), _rectangle(x0, y1 - thick, x1, y1),
        _rectangle(x0, y0 + thick, x0 + thick, y1 - thick), _rectangle(x1 - thick, y0 + thick, x1, y1 - thick),
    ]  # fmt: skip


def _pocket():
    """A U on the straight way from the paper's start to its door, open towards the start."""
    x, y, width, depth, thick = POCKET
    turn = radians(33)
    c, s = cos(turn), sin(turn)

    def part(x0, y0, x1, y1):
        corners = _rectangle(x0, y0, x1, y1)
        return np.stack([x + corners[:, 0] * c + corners[:, 1] * s, y - corners[:, 0] * s + corners[:, 1] * c], axis=1)

    half = width / 2
    return [part(-half, 0, half, thick), part(-half, thick - depth, -half + thick, 0), part(half - thick, thick - depth, half, 0)]


def _person(house, start, goal, seed):
    """A box as large as a person that crosses the line from the start to the first door, or to the goal, to and fro, once the robot is on its way."""
    across, along, speed = PERSON
    aim = (house.doors[0].x, house.doors[0].y) if house.doors else goal
    middle = np.array(start[:2]) + 0.5 * (np.array(aim) - start[:2])
    way = np.array(aim) - start[:2]
    side = np.array([way[1], -way[0]]) / hypot(*way)
    corners = _rectangle(-across / 2, -along / 2, across / 2, along / 2)
    ends = middle - 1200 * side, middle + 1200 * side
    begin = 12.0 + seed % 10
    span = 2400 / speed
    return worlds.Mover(corners, np.array([0, begin, begin + span]), np.array([ends[0], ends[0], ends[1]]))


def _anywhere(house, boxes, random):
    """A place where the body fits, and a heading."""
    free = np.argwhere(house.cells == FREE)
    for _ in range(1000):
        row, col = free[random.integers(len(free))]
        x, y = (col + random.uniform(0, 1)) * house.cell, (row + random.uniform(0, 1)) * house.cell
        room = _rectangle(x - 400, y - 400, x + 400, y + 400)
        low, high = (int((y - 400) // house.cell), int((x - 400) // house.cell)), (int((y + 400) // house.cell), int((x + 400) // house.cell))
        inside = house.cells[max(low[0], 0) : high[0] + 1, max(low[1], 0) : high[1] + 1]
        if (inside == FREE).all() and all(distance(room, box) > 0 for box in boxes):
            return x, y, random.uniform(-180, 180)
    raise ValueError(f"{house.source} has no room for the robot")


def _scatter(house, count, others, kept, random):
    """Boxes at any angle that the map does not have: APART from each other and from walls, and CLEAR of start, goal and doors."""
    found: list[np.ndarray] = []
    free = np.argwhere(house.cells == FREE)
    walls = worlds.outlines(house.walls) * house.pixel
    places = [np.array(place[:2]) for place in kept] + [np.array((d.x, d.y)) for d in house.doors]
    tries = 0
    while len(found) < count:
        tries += 1
        if tries > 20000:
            raise ValueError(f"{count} boxes do not fit into {house.source}")
        row, col = free[random.integers(len(free))]
        a, b = random.uniform(*SIDES, 2) / 2
        turn = random.uniform(0, pi)
        s, c = sin(turn), cos(turn)
        box = _rectangle(-a, -b, a, b) @ np.array([(c, s), (-s, c)]) + ((col + 0.5) * house.cell, (row + 0.5) * house.cell)
        middle = box.mean(axis=0)
        if min(hypot(*(middle - place)) for place in places) < CLEAR + max(a, b):
            continue
        gap = APART if count <= 12 else APART - 60
        if all(distance(box, other) >= gap for other in others + found) and _off_walls(box, walls, gap):
            found.append(box)
    return found


def _off_walls(box, walls, gap):
    return all(distance(box, np.array([(w[0], w[1]), (w[2], w[3])])) >= gap for w in walls)
