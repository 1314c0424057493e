"""The way over the grid: distances from the goal, the next corner to steer for, doors and how wide they are open.

Functions of the Goal, whose numbers they keep; layer.py lists them. Steps of the search are slices.
"""

from micropython import const

from core.trig import cos14, sin14
from goal.kernels import spread

_COLS = const(0)
_SIZE = const(1)
_CELL = const(2)
_X = const(24)
_Y = const(25)
_TURN = const(26)
_SEARCH = const(44)  # where the search stands: see search()
_AT = const(45)
_BLIND = const(46)
_ASIDE = const(56)
_LEAST = const(57)
_LINE = const(63)
_MASK = const(58)  # of a door being measured: strips that have a point, and how many points have been looked at
_DONE = const(59)
_RIGHT = const(64)  # ... of its right half
_SPARE = const(15)  # mm kept free in a door beyond what is least
_POINTS = const(90)  # in a slice

_TOLD_GOAL_X = const(9)
_TOLD_GOAL_Y = const(10)
_TOLD_LENGTH = const(13)
_TOLD_DOOR = const(14)
_TOLD_OPEN = const(16)
_TOLD_MIDDLE = const(17)

_FAR = const(4095)
_CLOSED = const(0x8000)
_SIDE = const(130)  # mm to each side that a line of sight has to be free: half the body's width and a little
_CORNER = const(350)  # mm: a corner nearer than that is passed over
_FOLLOWED = const(2)  # cells in a slice
_STRIPS = const(30)  # across half of a door
_DEEP = const(210)  # mm before and behind a door's middle: the wall, and what stands in it
_AGREED = const(3)  # measurements in a row that say the same before a door counts as shut or open

# Of a door: x, y of its middle, normal (0.1 deg), width; then what was measured: how much is open (-1 not yet), the middle of that, how often it was found shut
_NORMAL = const(2)
_WIDTH = const(3)
_OPEN = const(4)
_MIDDLE = const(5)
_SHUT = const(6)
_DOOR = const(7)


def cell_at(n, x, y):
    """Number of the cell of a place; those of the rim for what lies beyond."""
    cell = n[_CELL]
    cols = n[_COLS]
    return min(max(y // cell, 0), n[_SIZE] // cols - 1) * cols + min(max(x // cell, 0), cols - 1)


def sees(goal, dx, dy):
    """Whether a strip as wide as the body lies in open cells, from the robot to the place dx, dy mm off."""
    n = goal.numbers
    cells = goal.cells
    x = n[_X] >> 8
    y = n[_Y] >> 8
    length = max(abs(dx), abs(dy)) + 1  # and up to 0.41 of it more
    sx = dy * _SIDE // length
    sy = -dx * _SIDE // length
    steps = length // 150 + 2
    for k in range(steps):
        px = x + dx * k // steps
        py = y + dy * k // steps
        if cells[cell_at(n, px + sx, py + sy)] >= _CLOSED or cells[cell_at(n, px - sx, py - sy)] >= _CLOSED:
            return False
    return True


def search(goal):
    """One slice. _SEARCH: 0 begin, the cells forget their distances; 1, 2 sweeps to and fro; 3 begin to follow the way; 4 follow. True when it has ended.

    What comes of it: told[length], -1 if there is no way, told[door], the first on it, -1 if there is none, and goal.x, goal.y, the corner to steer for.
    """
    n = goal.numbers
    cells = goal.cells
    told = goal.told
    stage = n[_SEARCH]
    if stage == 0:
        for k in range(n[_SIZE]):
            cells[k] |= _FAR
        cells[cell_at(n, told[_TOLD_GOAL_X], told[_TOLD_GOAL_Y])] &= 0xF000
    elif stage < 3:
        if not spread(0, cells, 0, stage - 1, n):
            stage = 2  # nothing has changed
        elif stage == 2:
            stage = 0
    elif stage == 3:
        at = _begin(goal, cells)
        n[_AT] = at
        n[_BLIND] = 0
        told[_TOLD_DOOR] = told[_TOLD_LENGTH] = -1
        goal.x = told[_TOLD_GOAL_X]
        goal.y = told[_TOLD_GOAL_Y]
        if at < 0:
            return True
        told[_TOLD_LENGTH] = cells[at] & _FAR
    else:
        return _follow(goal, n, cells, told)
    n[_SEARCH] = stage + 1
    return False


def _begin(goal, cells):
    """The robot's cell, or the one next to it that is nearest to the goal, if its own has been closed; -1 if none leads there."""
    n = goal.numbers
    at = cell_at(n, n[_X] >> 8, n[_Y] >> 8)
    best = _FAR
    found = -1
    for i in range(9):
        k = at + goal.around[i]
        if 0 <= k < n[_SIZE] and cells[k] < _CLOSED and cells[k] & _FAR < best:
            best = cells[k] & _FAR
            found = k
            if not i:
                break
    return found


def _follow(goal, n, cells, told):
    """A few cells on: the last corner that is in sight is steered for."""
    x = n[_X] >> 8
    y = n[_Y] >> 8
    cell = n[_CELL]
    for _ in range(_FOLLOWED):
        at = n[_AT]
        here = cells[at] & _FAR
        if cells[at] >> 12 == 7:
            told[_TOLD_DOOR] = door_of(n, goal.doors, at)
            return True  # it has places of its own to steer for
        px = at % n[_COLS] * cell + (cell >> 1)
        py = at // n[_COLS] * cell + (cell >> 1)
        if not here:
            px = told[_TOLD_GOAL_X]
            py = told[_TOLD_GOAL_Y]
        if not n[_BLIND]:
            if abs(px - x) + abs(py - y) < _CORNER or sees(goal, px - x, py - y):
                goal.x = px
                goal.y = py
            else:
                n[_BLIND] = 1
                if abs(goal.x - x) + abs(goal.y - y) < _CORNER:
                    goal.x = px
                    goal.y = py
        if not here:
            return True
        n[_AT] = -1
        for i in range(1, 9):  # straight ones first
            k = at + goal.around[i]
            if cells[k] < _CLOSED and here - (cells[k] & _FAR) == (5 if i < 5 else 7):
                n[_AT] = k
                break
        if n[_AT] < 0:
            told[_TOLD_LENGTH] = -1  # cells have changed since
            return True
    return False


def door_of(n, doors, at):
    """Number of the door that a cell belongs to."""
    cell = n[_CELL]
    x = at % n[_COLS] * cell + (cell >> 1)
    y = at // n[_COLS] * cell + (cell >> 1)
    best = 32767
    for k in range(0, len(doors), _DOOR):
        far = abs(doors[k] - x) + abs(doors[k + 1] - y)
        if far < best:
            best = far
            found = k // _DOOR
    return found


def where(goal, door):
    """How far the robot is beyond a door's middle along its normal, mm; to numbers[_ASIDE] how far to the right of where it is to pass, seen along that.

    It is to pass, numbers[_LINE] to the right of the door's middle, where the straight line to the goal does, as far as what is open has room.
    """
    n = goal.numbers
    told = goal.told
    doors = goal.doors
    k = door * _DOOR
    s = sin14(doors[k + _NORMAL])
    c = cos14(doors[k + _NORMAL])
    x = (n[_X] >> 8) - doors[k]
    y = (n[_Y] >> 8) - doors[k + 1]
    aside = (x * c - y * s) >> 14
    ahead = (x * s + y * c) >> 14
    x = told[_TOLD_GOAL_X] - doors[k]
    y = told[_TOLD_GOAL_Y] - doors[k + 1]
    line = (x * c - y * s) >> 14
    x = abs((x * s + y * c) >> 14)
    y = abs(ahead)
    line = (aside * x + line * y) // (x + y + 1)
    y = doors[k + _MIDDLE]
    x = max(((doors[k + _WIDTH] if doors[k + _OPEN] < 0 else doors[k + _OPEN]) - n[_LEAST] >> 1) - _SPARE, 0)
    if goal.method.lines_up:
        x >>= 1  # who only reacts keeps to the middle
    n[_LINE] = line = min(max(line, y - x), y + x)
    n[_ASIDE] = aside - line
    return ahead


def beside(goal, door, ahead):
    """goal.x, goal.y become the place so far beyond the door along its normal, where the robot is to pass: what where() found last."""
    doors = goal.doors
    k = door * _DOOR
    s = sin14(doors[k + _NORMAL])
    c = cos14(doors[k + _NORMAL])
    aside = goal.numbers[_LINE]
    goal.x = doors[k] + ((ahead * s + aside * c) >> 14)
    goal.y = doors[k + 1] + ((ahead * c - aside * s) >> 14)


def measure(goal, door, odometry, points):
    """See how much of a door is open among the remembered points. 0: it takes another slice; 1 done; 2 it has just become shut, or open again."""
    n = goal.numbers
    doors = goal.doors
    told = goal.told
    k = door * _DOOR
    # The door on the odometry's floor, 1/8 mm, and its normal there
    s = sin14(-n[_TURN] // 100)
    c = cos14(-n[_TURN] // 100)
    x = doors[k] - (n[_X] >> 8)
    y = doors[k + 1] - (n[_Y] >> 8)
    x, y = (odometry.x >> 5) + ((x * c + y * s) >> 11), (odometry.y >> 5) + ((y * c - x * s) >> 11)
    s = sin14(doors[k + _NORMAL] - n[_TURN] // 100)
    c = cos14(doors[k + _NORMAL] - n[_TURN] // 100)
    half = doors[k + _WIDTH] >> 1
    mask = n[_MASK]
    right = n[_RIGHT]
    fx = points.x
    fy = points.y
    first = n[_DONE]
    n[_DONE] += _POINTS
    for i in range(first, min(n[_DONE], points.count)):
        dx = ((fx[i] - x & 0xFFFF ^ 0x8000) - 0x8000) >> 3
        dy = ((fy[i] - y & 0xFFFF ^ 0x8000) - 0x8000) >> 3
        if -_DEEP < (dx * s + dy * c) >> 14 < _DEEP:
            dx = ((dx * c - dy * s) >> 14) + half
            if 0 <= dx < 2 * half:
                dx = dx * _STRIPS // half
                if dx < _STRIPS:
                    mask |= 1 << dx
                else:
                    right |= 1 << dx - _STRIPS
    n[_MASK] = mask
    n[_RIGHT] = right
    if n[_DONE] < points.count:
        return 0
    n[_DONE] = n[_MASK] = n[_RIGHT] = 0
    longest = run = 0
    for b in range(2 * _STRIPS):
        if (mask >> b if b < _STRIPS else right >> b - _STRIPS) & 1:
            run = 0
        else:
            run += 1
        if run > longest:
            longest = run
            doors[k + _MIDDLE] = (2 * b - run + 2) * half // (2 * _STRIPS) - half
    # Half a strip is open beyond the last free one at either end, on the average
    told[_TOLD_OPEN] = doors[k + _OPEN] = (longest + (0 < longest < 2 * _STRIPS)) * half // _STRIPS
    told[_TOLD_MIDDLE] = doors[k + _MIDDLE]
    shut = doors[k + _OPEN] < n[_LEAST]
    count = doors[k + _SHUT]
    doors[k + _SHUT] = min(count + 1, _AGREED) if shut else max(count - 1, 0)
    if count != (_AGREED - 1 if shut else 1):
        return 1
    for i in goal.gates:
        if door_of(n, doors, i) == door:
            goal.cells[i] = 0xFFFF if shut else 0x7FFF
    return 2


def forget(goal):
    """Forget what was found on the way: boxes, and that doors are shut."""
    cells = goal.cells
    for k in range(goal.numbers[_SIZE]):
        if cells[k] & 0x7000 < 0x7000:
            cells[k] = _FAR
    for k in goal.gates:
        cells[k] = 0x7FFF
    doors = goal.doors
    for k in range(0, len(doors), _DOOR):
        doors[k + _OPEN] = -1
        doors[k + _MIDDLE] = doors[k + _SHUT] = 0
