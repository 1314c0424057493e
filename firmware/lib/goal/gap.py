"""Getting there by gap seeking: the goal as a term in the planner's choice. The way out that the cost to go looks for is the one towards what is steered for;
where the goal itself lies on its grid, the goal is the only way out."""

from array import array

from micropython import const

from planner.cost_grid import fill

_N = const(26)
_ROWS = const(312)
_ON_GRID = const(520)  # mm
_STATES = const(8112)
_BACKWARD = const(40)  # mm that a move backward costs for being one


class Gap:
    """lines_up: whether it is led before a door first. x, y: where the goal lies on the odometry's floor, 1/8 mm modulo 2**16, while `near`."""

    lines_up = False

    def __init__(self, avoid):
        self._decision = decision = avoid.decision
        self._cost_to_go = cost_to_go = decision.cost_to_go
        cost_to_go.goal = self
        # To a goal that lies behind it drives backward: it need not turn round first, as it had better where it only wants to get on.
        self._kept = cost_to_go.rim, decision.backward
        cost_to_go.rim = array("H", bytes(48))
        decision.backward = _BACKWARD
        self.near = self.searches = False
        self.align = 0
        self.x = self.y = 0

    def begin(self):
        """A new goal: no ground counts as visited."""
        self._cost_to_go.laid = 0
        self.near = False

    def end(self):
        """Another method takes over."""
        self._cost_to_go.goal = None
        self._cost_to_go.rim, self._decision.backward = self._kept

    def aim(self, dx, dy, last, odometry):
        """What is steered for lies dx, dy mm off, on the odometry's floor; last: it is the goal."""
        long, short = max(abs(dx), abs(dy)), min(abs(dx), abs(dy))
        length = max(long + (short * 3 >> 3), 1)
        cost_to_go = self._cost_to_go
        cost_to_go.ux = dx * 1024 // length
        cost_to_go.uy = dy * 1024 // length
        self.near = last and length < _ON_GRID
        self.x = (odometry.x >> 5) + 8 * dx & 0xFFFF
        self.y = (odometry.y >> 5) + 8 * dy & 0xFFFF

    def seed(self, grid, cost, closed, marks):
        """The exits of the cost to go have just been marked, and what they cost: where the goal lies on the grid, it is the only one."""
        if not self.near:
            return
        i = (self.x - grid[0] & 0xFFFF) // grid[2]
        j = (self.y - grid[1] & 0xFFFF) // grid[2]
        if i >= _N or j >= _N:
            return
        # Words of 32 bits, seen as pairs of 16
        half = i >> 4
        bit = 1 << (i & 15)
        found = False
        for row in range(j, _ROWS, _N):
            found = found or not closed[2 * row + half] & bit
        if not found:
            return
        fill(marks, 2 * _ROWS, 0)
        fill(cost, _STATES >> 1, 0xFFFF)  # so far the rim had been given costs, and nothing else
        for row in range(j, _ROWS, _N):
            if not closed[2 * row + half] & bit:
                cost[row * _N + i] = 0
                marks[2 * row + half] = bit
