"""The cost to go: what it costs the long body, from every pose round it, to leave the neighbourhood.

The collision check knows what the body can do in the next half second; it does not know where to go. This does: over a grid of poses (26 x 26 places
of 1/12 body length, 12 orientations of 15 degrees) the cost of the cheapest way out is propagated inwards from the rim. Poses in which the outline covers a
point are closed; places the robot has covered already are expensive, more each time, so that it goes on rather than back and comes back only when
nothing else is left. Rim places in the direction the robot has been travelling are the cheapest exits, and those left nose first: a long body would
else as soon turn its nose into a corner and its rear into the way out.

The outline is the same seen from both ends; which of them is the nose, heading_branch.py says. The grid is coarse: the outline is taken a little
small, and the exact test of every move is the collision check's business.

Costs are bytes, in units of a quarter of a cell, of a whole one where they are large (propagate.py).
A grid is made in slices, so that no call takes long: cost_grid.py, propagate.py. Meanwhile there is none to ask: there is room for one only.
Lengths on the floor are 1/8 mm modulo 2**16.
"""

import micropython
from micropython import const

from planner import heading_branch
from planner.cost_grid import close, cover, fill, seed
from planner.known_exits import forget_far, recall
from planner.propagate import propagate

_POINTS = const(20)  # closed in one slice
_WORK = const(880)  # propagated in one slice
_N = const(26)
_TURNS = const(12)
_ROWS = const(312)
_PLACES = const(676)
_STATES = const(8112)
_OUT = const(255)  # cost of what is closed or not reached
_TRAIL = const(120)  # points, one each cell's length
_TRAIL_GAP = const(10)  # those behind the centre that are still under the body
_KNEE = const(216)  # of costs: see propagate.py
# Fields of CostToGo.grid, see cost_grid.py
_GRID_X = const(0)
_GRID_Y = const(1)
_GRID_CELL = const(2)
_GRID_SIZE = const(5)


@micropython.viper
def sample(cell: int, poses: ptr32, n: int, cost: ptr8):
    """Cost at n poses, mm, put in the place of their x: trilinear between the grid's. 20000 where a pose is closed, or beyond the grid.

    poses: x, y from the grid's corner (1/8 mm) + 2**16, heading (0.1 deg), none negative.
    """
    shift = cost[_STATES]
    half = cell >> 1
    limit = cell * (_N - 1) - 1
    last = n * 3
    p = 0
    while p < last:
        x = poses[p] - 65536 - half
        y = poses[p + 1] - 65536 - half
        value = 20000
        # A body beyond the grid may meet what it knows nothing of; one cell is allowed for.
        if x >= 0 - cell and y >= 0 - cell and x <= limit + cell and y <= limit + cell:
            if x < 0:
                x = 0
            if y < 0:
                y = 0
            if x > limit:
                x = limit
            if y > limit:
                y = limit
            i = x // cell
            j = y // cell
            # Weights in sixteenths, rounded: a mirrored grid gives the mirrored cost.
            fx = (((x - i * cell) << 4) + half) // cell
            fy = (((y - j * cell) << 4) + half) // cell
            heading = poses[p + 2] % 1800
            t = heading // 150
            ft = (((heading - t * 150) << 4) + 75) // 150
            least = 32767
            total = 0
            closed = 0
            at = (t * _N + j) * _N + i
            a = 0
            while a < 8:
                # Two orientations, of each two rows, of each two places.
                w = 16 - fx
                if a & 1:
                    w = fx
                if a & 2:
                    w = w * fy
                else:
                    w = w * (16 - fy)
                if a & 4:
                    w = w * ft
                else:
                    w = w * (16 - ft)
                if w:
                    v = cost[at]
                    if v == _OUT:
                        closed += w
                    else:
                        if v > _KNEE:
                            v += (v - _KNEE) * 3
                        total += v * w
                        if v < least:
                            least = v
                a += 1
                at += 1
                if a & 1 == 0:
                    at += _N - 2
                    if a == 4:
                        at += _PLACES - 2 * _N
                        if t == _TURNS - 1:
                            at -= _STATES
            if least != 32767:
                total += (least + (48 >> shift)) * closed  # closed: a little more than the best pose round about
                value = ((total >> 4) * cell) >> (15 - shift)
        poses[p] = value
        p += 3


class CostToGo:
    """Cost of leaving, by pose. `step()` renews it slice by slice; of use when `builds`, the grids made so far, are more than one.

    grid: array('i') of cost_grid.py; first the corner's x and y (1/8 mm modulo 2**16) and the size of a cell (1/8 mm) of the one in use.
    goal: goal.gap.Gap or None; rim: array('H'), what leaving with each heading of the nose costs more; laid: points of the trail so far.
    scratch: array('H'), in use while a grid is being made only: others may have it at other times.
    """

    def __init__(self, config):
        from planner.parts import cost_to_go

        cost_to_go(self, config)

    def follow(self, odometry):
        """Lay the trail and turn the sense of direction with the robot. Call once a frame."""
        x = odometry.x
        y = odometry.y
        if self.laid == 0:
            self._px = x
            self._py = y
        # The coordinates wrap, far out.
        dx = ((x - self._px & 0x1FFFFF ^ 0x100000) - 0x100000) >> 8
        dy = ((y - self._py & 0x1FFFFF ^ 0x100000) - 0x100000) >> 8
        step = self.grid[_GRID_CELL] >> 3
        if self.laid and dx * dx + dy * dy < step * step:
            return
        i = self.laid % _TRAIL
        self._trail[2 * i] = (x >> 5) & 0xFFFF
        self._trail[2 * i + 1] = (y >> 5) & 0xFFFF
        self.laid += 1
        self._px = x
        self._py = y
        # First-order low pass over the way travelled: 2.5 body lengths.
        d = self.grid[_GRID_CELL] * 15 >> 2
        self.ux += (dx * 1024 - self.ux * step) // d
        self.uy += (dy * 1024 - self.uy * step) // d

    def step(self, odometry, points):
        """One slice of the next grid. Returns True when a new one has just come into use."""
        stage = self._stage
        job = self.grid
        if stage == 0:
            # Lay the grid round the robot; the one before says to which side the half turn of orientations leans.
            x = odometry.x >> 5
            y = odometry.y >> 5
            cell = job[_GRID_CELL]
            if self.builds:
                i = ((x - job[_GRID_X] + cell // 2 & 0xFFFF ^ 0x8000) - 0x8000) // cell
                j = ((y - job[_GRID_Y] + cell // 2 & 0xFFFF ^ 0x8000) - 0x8000) // cell
                self._lean = heading_branch.choose(self.cost, i, j, odometry.heading // 100)
                forget_far(self._known, x, y, job[_GRID_SIZE])
                self._old_x = job[_GRID_X]
                self._old_y = job[_GRID_Y]
            else:
                stage = 4
            job[_GRID_X] = x - cell * (_N // 2) & 0xFFFF
            job[_GRID_Y] = y - cell * (_N // 2) & 0xFFFF
        elif stage < 5:
            if self.goal is None:  # what led away from one goal may lead to the next
                recall(stage - 1, job, self._old_x, self._old_y, self.cost, self._known, self._exits)
        elif stage == 5:
            # Nothing closed, near or marked, nothing reached; a revisit cost of 2 halves everywhere.
            fill(self.cost, _STATES >> 1, 0xFFFF)
            fill(self.scratch, 3 * 2 * _ROWS, 0)
            fill(self._revisit, _PLACES >> 1, 0x0202)
        elif stage == 6:
            # Ground covered becomes expensive, more each time; not what the body still stands on.
            first = self.laid - _TRAIL
            cover(job, first if first > 0 else 0, self._revisit, self._trail, self.laid - _TRAIL_GAP)
            self._k = 0
        elif stage == 7:
            self._k = close(self._k, job, self._marks, self._closed, self._near, self.masks, points.x, points.y, points.count, _POINTS)
            if self._k < points.count:
                return False
        elif stage == 8:
            sense = heading_branch.apply(odometry.heading // 100, self._lean, self._closed)
            wave = self._wave
            seed(self.cost, self._closed, self._marks, self.ux, self.uy, sense, wave[5], self.rim, self._exits)
            if self.goal is not None:
                self.goal.seed(job, self.cost, self._closed, self._marks)
            wave[0] = wave[1] = wave[2] = 0
            wave[3] = _OUT
            wave[4] = sense if wave[9] else 0
        else:
            if not propagate(self._wave, self._marks, _WORK, self.cost, self._closed, self._near, self._revisit, self._primitives):
                return False
            self._stage = 0
            self.builds += 1
            # The very first one does not know to which side the way out leads.
            return self.builds > 1
        self._stage = stage + 1
        return False

    def at(self, x, y, heading):
        """Cost of a pose on the floor (1/8 mm mod 2**16, 0.1 deg), mm, relative to others of this grid."""
        grid = self.grid
        u = ((x - grid[_GRID_X]) & 0xFFFF ^ 0x8000) - 0x8000
        v = ((y - grid[_GRID_Y]) & 0xFFFF ^ 0x8000) - 0x8000
        pose = self._pose
        pose[0] = u + 65536
        pose[1] = v + 65536
        pose[2] = heading % 1800
        sample(grid[_GRID_CELL], pose, 1, self.cost)
        return pose[0]
