"""Going to a goal: what comes next on the way, doors, alarms. docs/goals.md tells the whole of it.

Once in two or three revolutions of the lidar, slice by slice between the planner's, the pose is put right (pose.py), what stands there that the map does not have
goes into the grid, a door that lies ahead is measured, the way is searched where something has changed (route.py), and the method is told where to go.

What it knows lies in two arrays, because an attribute costs the board its name, and a place in an array nothing.
    told        array('h'), what the laptop is told as well, in the order of GOAL in link/protocol.py
    numbers     array('i'): the map's and kernels.fit()'s first, kernels.py; the pose's from 24 on, pose.py; the route's from 44 on, route.py; the layer's own, below

Source: paper C, with the equations of its deliberative layer put right; a door has three places to steer for instead of one.
"""

from struct import pack_into
from time import ticks_diff

from micropython import const

from core.trig import cos14, sin14
from core.unload import forget
from goal import pose, route
from link.telemetry import copy

_SIZE = const(1)
_CELL = const(2)
_COUNT = const(7)
_X = const(24)
_Y = const(25)
_TURN = const(26)
_FRAMES = const(33)
_FAILED = const(35)
_REVOLUTION = const(37)
_STAGE = const(43)
_SEARCH = const(44)
_DUE = const(47)  # a search: 1 something has changed
_PLANNED_US = const(48)
_GAINED_US = const(49)
_SHORTEST = const(50)
_FAILS = const(51)
_SIGN = const(52)  # a door is being passed along its normal, 1, or against it, -1
_TOLD_US = const(53)
_NOW_US = const(54)
_MINE = const(55)  # whether this slice is the planner's
_ASIDE = const(56)
_DONE = const(59)
_TELL = const(60)  # messages told, and the cell to tell next, -1 the map's head
_LOOKED = const(61)
_PART = const(62)
_CHANGED = const(65)  # the way was searched because something had changed: it may be longer now

_STATE = const(0)  # places in told
_ALARM = const(1)
_METHOD = const(2)
_POSE = const(3)
_TOLD_X = const(4)
_TOLD_Y = const(5)
_HEADING = const(6)
_GOAL_X = const(9)
_GOAL_Y = const(10)
_STEER_X = const(11)
_STEER_Y = const(12)
_LENGTH = const(13)
_DOOR = const(14)
_THROUGH = const(15)
_SEARCHES = const(18)
_WAITING = const(19)
_PATROL = const(20)
_SIZE_TOLD = const(42)  # bytes

_IDLE = const(0)  # states
_GOING = const(1)
_ARRIVED = const(2)
_ALARMED = const(3)
_SEARCHING = const(4)
_ASTRAY = const(5)
_DOOR_SHUT = const(1)  # alarms
_WALLED_IN = const(2)
_NO_PROGRESS = const(3)
_GUESSED = const(0)  # poses
_GIVEN = const(1)
_KNOWN = const(2)

# planner/reasons.py
_WAITS = const(19)  # reasons.GOAL_NONE
_AT_IT = const(20)  # reasons.GOAL_THERE
_CANNOT = const(21)  # reasons.GOAL_ALARM
_WHERE = const(22)  # reasons.GOAL_WHERE

_THERE = const(200)  # mm from the goal
_PASSED = const(450)  # mm beyond a door's middle: it is passed
_BEFORE = const(570)  # mm before it, on its normal: where it is lined up
_BEYOND = const(500)
_LINED_UP = const(70)  # mm off the normal
_MOUTH = const(200)  # mm before and beyond its middle, for who needs no lining up
_IN_LINE = const(100)  # 0.1 deg off it
_IN_SIGHT = const(850)  # mm: a door on the grid of the cost to go
_MEASURED = const(1000)  # mm from which a door is measured: so far the robot remembers points
_AGAIN_US = const(2_000_000)  # the way is searched anew after that
_PATIENCE_US = const(25_000_000)  # without getting on by a cell
_TELL_US = const(200_000)
_CELLS_AT_ONCE = const(300)
_MOST_FOUND = const(6)
_AT = const(8)  # of a message's payload
_LOOKS = const(8)  # points looked at in a slice


class Goal:
    """Laid out by build.py.

    holds       the robot is to stand; why: planner/reasons.py
    queue       array('h') of x, y; told[_WAITING] of them, the one under way first
    x, y        what the way leads to next, mm on the map
    method      how it gets there: gap.py, field.py or behaviour.py
    cells, field, px, py    see kernels.py; px, py: array('H'), mm on the map. doors: see route.py; gates: the cells of all doors
    locate      locate.Locate while the robot looks for itself. asked: somebody wants it to. head: header and doors of the map's file
    """

    def frame(self, lidar, odometry):
        """After each frame of the lidar."""
        pose.advance(self, lidar, odometry)
        self.numbers[_NOW_US] = odometry.now_us

    def step(self, odometry, points):
        """One slice. False if there is nothing to do, or it is the planner's turn."""
        n = self.numbers
        told = self.told
        n[_MINE] ^= 1
        if n[_FRAMES] < n[_REVOLUTION] or n[_MINE] and not self.holds:
            return False
        stage = n[_STAGE]
        if stage == 0:
            if told[_POSE] != _KNOWN:
                self._find()
                return True
            if pose.match(self):
                return True
            n[_LOOKED] = n[_COUNT] if not n[_FAILED] else 0
            if told[_POSE] != _KNOWN:
                self.hold(_ASTRAY, _WHERE)
        elif stage == 1:
            if n[_LOOKED]:
                self.look()
                return True
        elif stage == 2:
            door = told[_THROUGH] if told[_THROUGH] >= 0 else told[_DOOR]
            if door >= 0 and not n[_FAILED]:
                ahead = abs(route.where(self, door))
                if ahead < _MEASURED and abs(n[_ASIDE]) < _MEASURED and (ahead > 250 or told[_THROUGH] < 0):
                    done = route.measure(self, door, odometry, points)
                    if not done:
                        return True
                    if done > 1:
                        n[_DUE] = 1
                        told[_THROUGH] = -1
            n[_SEARCH] = 3
            if n[_DUE] or ticks_diff(n[_NOW_US], n[_PLANNED_US]) > _AGAIN_US:
                told[_SEARCHES] += n[_DUE]
                n[_CHANGED] = n[_DUE]
                n[_PLANNED_US] = n[_NOW_US]
                n[_DUE] = n[_SEARCH] = 0
        elif stage == 3:
            if told[_STATE] == _GOING:
                if not route.search(self):
                    return True
                self._aim(odometry)
        else:
            pose.again(n)
            stage = -1
        n[_STAGE] = stage + 1
        return True

    def hold(self, state, why):
        """Stand."""
        self.told[_STATE] = state
        self.told[_THROUGH] = -1
        self.why = why
        self.holds = True

    def go(self):
        """Set out for the first of the queue; without one, stand."""
        told = self.told
        n = self.numbers
        told[_ALARM] = n[_FAILS] = 0
        if not told[_WAITING]:
            return self.hold(_IDLE, _WAITS)
        told[_GOAL_X] = self.queue[0]
        told[_GOAL_Y] = self.queue[1]
        if told[_POSE] != _KNOWN:
            return self.hold(_SEARCHING, _WHERE)
        told[_THROUGH] = -1
        n[_DUE] = 1
        n[_SHORTEST] = 32767
        n[_GAINED_US] = n[_NOW_US]
        self.hold(_GOING, _WHERE)  # until the way is known
        self.x = told[_TOLD_X]
        self.y = told[_TOLD_Y]
        self.method.begin()

    def tell(self, data, now_us):
        """The next message about it, for the link; 0 when none is due. Returns the payload's length."""
        n = self.numbers
        if ticks_diff(now_us, n[_TOLD_US]) < _TELL_US:
            return 0
        n[_TOLD_US] = now_us
        pack_into("<I", data, _AT, now_us & 0x3FFFFFFF)
        n[_TELL] += 1
        if n[_TELL] % 4:
            data[3] = 0x0D
            copy(self.told, 0, _SIZE_TOLD, data, _AT + 4)
            return 4 + _SIZE_TOLD
        # In between the map: its head, then its cells a part at a time
        first = n[_PART]
        if first < 0:
            n[_PART] = 0
            data[3] = 0x0F
            copy(self.head, 0, len(self.head), data, _AT + 4)
            return 4 + len(self.head)
        count = min(n[_SIZE] - first, _CELLS_AT_ONCE)
        n[_PART] = first + count if first + count < n[_SIZE] else -1
        data[3] = 0x0E
        pack_into("<H", data, _AT + 4, first)
        copy(self.cells, 2 * first, 2 * count, data, _AT + 6)
        return 6 + 2 * count

    def _find(self):
        """The pose is not known well enough: a slice of looking for it, if somebody has said where it is about, or wants to go somewhere."""
        told = self.told
        if told[_STATE] == _ASTRAY or told[_POSE] == _GUESSED and not self.asked:
            pose.again(self.numbers)
            return
        if self.locate is None:
            self.hold(_SEARCHING, _WHERE)
            from goal.locate import Locate

            self.locate = Locate(self, told[_POSE] == _GIVEN)
            return
        done = self.locate.step()
        if done:
            self.locate = None
            self.asked = False
            forget("goal.locate")
            pose.again(self.numbers)
            if done > 0:
                self.go()
            else:
                self.hold(_ASTRAY, _WHERE)

    def look(self):
        """A few of the points: those more than 100 mm from the map's walls count for the cell 60 mm behind them; of some, what the beam has passed is free."""
        n = self.numbers
        cells = self.cells
        cell = n[_CELL]
        x = n[_X] >> 8
        y = n[_Y] >> 8
        last = n[_LOOKED]
        n[_LOOKED] = max(last - _LOOKS, 0)
        for k in range(n[_LOOKED], last):
            dx = self.px[k] - x
            dy = self.py[k] - y
            length = max(abs(dx), abs(dy))
            length += min(abs(dx), abs(dy)) * 3 >> 3
            if length < 200:
                continue
            if self.off(x + dx, y + dy) > 100:
                at = route.cell_at(n, x + dx + dx * 60 // length, y + dy + dy * 60 // length)
                found = cells[at] >> 12 & 7
                if found < _MOST_FOUND:
                    cells[at] += 0x1000
                    if found == 2:
                        cells[at] |= 0x8000
                        n[_DUE] = 1
            if k & 3 == 0:
                for i in range(150, length - 150, 100):
                    px = x + dx * i // length
                    py = y + dy * i // length
                    at = route.cell_at(n, px, py)
                    if 0 < cells[at] >> 12 & 7 <= _MOST_FOUND and abs((px % cell << 1) - cell) + abs((py % cell << 1) - cell) < cell >> 1:
                        cells[at] -= 0x1000
                        if cells[at] >> 12 == 10:  # closed, with 2 found
                            cells[at] &= 0x7FFF
                            n[_DUE] = 1

    def off(self, x, y):
        """How far a place is from the map's walls, mm, by the nearest node of the field."""
        n = self.numbers
        x = (x * 16 // n[6] + 1) >> 1
        y = (y * 16 // n[6] + 1) >> 1
        at = y * n[3] + x
        return self.field[at] * 2 - 256 if at < len(self.field) else 0

    def _aim(self, odometry):
        """What to steer for, from where the way leads."""
        n = self.numbers
        told = self.told
        x = n[_X] >> 8
        y = n[_Y] >> 8
        through = told[_THROUGH]
        if told[_LENGTH] < 0 and through < 0:
            n[_FAILS] += 1
            n[_DUE] = 1
            if n[_FAILS] > 2:
                told[_ALARM] = _WALLED_IN
                for k in range(6, len(self.doors), 7):
                    if self.doors[k] > 2:
                        told[_ALARM] = _DOOR_SHUT
                self.hold(_ALARMED, _CANNOT)
            return
        n[_FAILS] = 0
        dx = told[_GOAL_X] - x
        dy = told[_GOAL_Y] - y
        if abs(dx) < _THERE and abs(dy) < _THERE and dx * dx + dy * dy < _THERE * _THERE:
            return self._there()
        length = told[_LENGTH]
        if 0 <= length < n[_SHORTEST] - 4 or n[_CHANGED] and length > n[_SHORTEST]:
            n[_CHANGED] = 0
            n[_SHORTEST] = length
            n[_GAINED_US] = n[_NOW_US]
        elif ticks_diff(n[_NOW_US], n[_GAINED_US]) > _PATIENCE_US:
            told[_ALARM] = _NO_PROGRESS
            return self.hold(_ALARMED, _CANNOT)
        if through >= 0 and n[_SIGN] * route.where(self, through) > (_PASSED if self.method.lines_up else _MOUTH):
            told[_THROUGH] = through = -1
        door = told[_DOOR]
        self.method.align = 0
        if through < 0 and door >= 0:
            ahead = route.where(self, door)
            sign = -1 if ahead > 0 else 1
            # Who plans finds into the door by himself, once it is on his grid.
            lines_up = self.method.lines_up
            turn = (self.doors[7 * door + 2] + (0 if sign > 0 else 1800) - told[_HEADING] + 1800) % 3600 - 1800
            near = abs(ahead) < (_BEFORE + 60 if lines_up else _IN_SIGHT) and abs(n[_ASIDE]) < (_LINED_UP if lines_up else _IN_SIGHT)
            if near and lines_up:
                self.method.align = turn
            if near and (not lines_up or abs(turn) < _IN_LINE):
                told[_THROUGH] = through = door
                n[_SIGN] = sign
            else:
                tx, ty = self.x, self.y
                route.beside(self, door, -sign * (_BEFORE if lines_up else _MOUTH))
                if not route.sees(self, self.x - x, self.y - y):
                    self.x, self.y = tx, ty
        if through >= 0:
            route.beside(self, through, n[_SIGN] * _BEYOND)
        told[_STEER_X] = self.x
        told[_STEER_Y] = self.y
        self.method.searches = through >= 0
        # Seen from the robot, on the odometry's floor
        s = sin14(-n[_TURN] // 100)
        c = cos14(-n[_TURN] // 100)
        x = self.x - x
        y = self.y - y
        self.holds = False
        self.method.aim((x * c + y * s) >> 14, (y * c - x * s) >> 14, through < 0 and self.x == told[_GOAL_X] and self.y == told[_GOAL_Y], odometry)

    def _there(self):
        """The goal is reached: the next one, or stand."""
        queue = self.queue
        told = self.told
        x = queue[0]
        y = queue[1]
        told[_WAITING] -= 1
        left = 2 * told[_WAITING]
        for k in range(left):
            queue[k] = queue[k + 2]
        if told[_PATROL]:
            queue[left] = x
            queue[left + 1] = y
            told[_WAITING] += 1
        if left:
            self.go()
        else:
            self.hold(_ARRIVED, _AT_IT)
