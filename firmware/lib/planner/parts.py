"""What the constructors of the planner's parts do. Needed once, at the start: then it is unloaded, and leaves its room to the robot."""

from array import array

from micropython import const

from core.unload import forget

_ARC_STRIDE = const(8)  # candidates.py
_SHAPES = const(7)  # cost_grid.py
_ROWS = const(312)
_PLACES = const(676)
_STATES = const(8112)
_TRAIL = const(120)
_CELLS = const(1024)  # known_exits.py
_EXITS = const(104)
_MOVE_FIELDS = const(17)  # move_cost.py
# log2 of sixteenths of a cell in a unit of cost; where the last axle stays straight, to and fro costs more
_UNIT = const(2)
_UNIT_NAWS = const(3)


def _tables(config, part):
    from planner import tables

    found = tables.load(config, part)
    tables = None
    forget("planner.tables")
    return found


def candidates(self, config):
    """Fields of a Candidates."""
    self.af, self.ar, self.lengths, self.consts, self.table, self.seconds, self.strips, self.ends, self.turns = _tables(config, 0)
    self.count = len(self.af)
    self.arcs = len(self.consts) // _ARC_STRIDE
    all_wheels = config.mode == "AWS"
    self.ahead_end = self.arcs if all_wheels else self.arcs // 2
    self.astern_first = 0 if all_wheels else self.arcs // 2
    self.half_width = config.robot_width // 2
    self.half_length = config.robot_length // 2
    self.margin = config.avoid_margin
    self.soft = config.avoid_soft_margin
    self.look_ahead = config.windows_look_ahead
    self.end_x = self.end_y = self.end_turn = 0


def cost_to_go(self, config):
    """Fields of a CostToGo."""
    self.masks, self._primitives, self.rim = _tables(config, 1)
    cell = config.robot_length * 8 // 12
    self.cost = bytearray(_STATES + 1)  # the last byte: log2 of sixteenths of a cell in a unit
    self.cost[_STATES] = shift = _UNIT if config.mode == "AWS" else _UNIT_NAWS
    self.scratch = array("H", bytes(4 * 3 * _ROWS + _PLACES))
    view = memoryview(self.scratch)
    self._closed = view[: 2 * _ROWS]
    self._near = view[2 * _ROWS : 4 * _ROWS]
    self._marks = view[4 * _ROWS : 6 * _ROWS]
    self._revisit = view[6 * _ROWS :]
    radius = config.robot_width * 4 + cell // 2  # of what the trail makes expensive
    size = 0
    while 3 << size < 11 * cell:
        size += 1
    self.grid = array("i", (0, 0, cell, radius, len(self.masks) // (16 * _SHAPES), size))  # of cost_grid.py
    self._known = bytearray(_CELLS >> 1)  # of known_exits.py
    self._exits = bytearray(_EXITS)
    self._old_x = self._old_y = 0
    self._wave = array("i", (0, 0, 0, 0, 0, shift, 20, 16, 4, 0) if config.mode == "AWS" else (0, 0, 0, 0, 0, shift, 24, 16, 6, 1))  # of propagate.py
    self._trail = array("H", bytes(2 * 2 * _TRAIL))  # x, y
    self.laid = 0  # points of it so far
    self.goal = None
    self.ux = 0  # direction of travel over the last few lengths, * 2**10
    self.uy = 1024
    self._pose = array("i", (0, 0, 0))  # for at()
    self._stage = self._lean = self._k = self.builds = self._px = self._py = 0


def move_cost(self, cost_to_go, candidates):
    """Fields of a MoveCost."""
    self.cost_to_go = cost_to_go
    self._candidates = candidates
    self._job = array("i", [0] * _MOVE_FIELDS)
    self._poses = array("i", [0] * 15)
    self.checked = bytearray(candidates.count)
    self.bar = None
    self.x = self.y = self.heading = 0


def collision(self, candidates):
    """Fields of a CollisionCheck."""
    self._candidates = candidates
    # The places from _HALF_WIDTH on, as collision.py lists them; what comes before is put in for each check.
    body = candidates.half_width, candidates.half_length, candidates.margin, candidates.soft, candidates.look_ahead, candidates.arcs
    self._job = array("i", (0,) * 9 + body)
