"""The way on: what it costs the long body, from every pose round it, to leave the neighbourhood.

The envelope test knows what the body can do in the next half second; it does not know where to go. The field does: over
a grid of poses (28 x 28 places of 1/12 body length and a closed ring round them, 12 orientations of 15 degrees) the cost
of the cheapest way out is spread inwards from the rim. Poses in which the outline covers a point are closed; places the
robot has covered already are dear, dearer each time, so that it goes on rather than back and comes back only when nothing
else is left. Rim places in the direction the robot has been travelling are the cheapest exits, and those left nose first: a
long body would else as soon turn its nose into a corner and its rear into the way on.

The outline is the same seen from both ends; which of them is the nose, heading_branch.py says. The grid is coarse: the
outline is taken a little small, and the exact test of every move is the envelope's business.

The spreading is a label-correcting search (a queue of poses whose cost fell), cut into slices so that no call takes
long. Which poses are next to each other hangs on the axles: field_spread.py, field_spread_naws.py. While a field is being
made there is none to ask: there is room for one only.
Lengths on the floor are 1/8 mm modulo 2**16; costs are sixteenths of a cell.
"""

from array import array

import micropython
from micropython import const

from core.unload import unload
from planner import heading_branch

_POINTS = const(37)  # closed in one slice
_POSES = const(245)  # spread in one slice
_POSES_STRAIGHT = const(195)  # ... where the last axle stays straight
_N = const(30)
_TURNS = const(12)
_PLACES = const(900)
_STATES = const(10800)
_TRAIL_POINTS = const(120)  # one each cell's length
_TRAIL_GAP = const(10)  # those behind the centre that are still under the body


@micropython.viper
def _clear(cost: ptr16, rows: ptr32, tight: ptr32, seen: ptr32, weight: ptr8):
    i = 0
    while i < 276:
        seen[i] = 0
        i += 1
    i = 0
    while i < 10800:
        cost[i] = 32767
        i += 1
    i = 0
    while i < 360:
        rows[i] = 0
        tight[i] = 0
        i += 1
    i = 0
    while i < 900:
        weight[i] = 2
        i += 1


@micropython.viper
def _cover(weight: ptr8, tx: ptr16, ty: ptr16, job: ptr32, first: int, last: int):
    """Make the places within a radius of each point first..last-1 of the trail dearer, each time anew.

    job: x, y of the grid's corner, cell, radius (1/8 mm)
    """
    cell = job[2]
    radius = job[3]
    half = cell >> 1
    room = radius * radius
    size = cell * 30
    k = first % 120
    while first < last:
        x = (((tx[k] - job[0]) & 0xFFFF) ^ 0x8000) - 0x8000
        y = (((ty[k] - job[1]) & 0xFFFF) ^ 0x8000) - 0x8000
        first += 1
        k += 1
        if k == 120:
            k = 0
        if x <= 0 - radius or y <= 0 - radius or x >= size + radius or y >= size + radius:
            continue
        i0 = (x - radius) // cell
        i1 = (x + radius) // cell
        j = (y - radius) // cell
        j1 = (y + radius) // cell
        if i0 < 0:
            i0 = 0
        if j < 0:
            j = 0
        if i1 > 29:
            i1 = 29
        if j1 > 29:
            j1 = 29
        while j <= j1:
            dy = j * cell + half - y
            dy = room - dy * dy
            i = j * 30 + i0
            last_i = j * 30 + i1
            dx = i0 * cell + half - x
            while i <= last_i:
                if dx * dx <= dy and weight[i] < 40:
                    weight[i] = weight[i] + 1
                dx += cell
                i += 1
            j += 1


@micropython.viper
def _close(closed: ptr32, tight: ptr32, stamps: ptr16, seen: ptr32, fx: ptr16, fy: ptr16, first: int, last: int, job: ptr32) -> int:
    """Close the poses whose outline covers one of the points first..last-1: one mask of 30 bits per row and orientation.

    Points are taken to half a cell: the stamp of the half cell says which poses about it are closed. tight: the same for the full outline.
    job: x, y of the grid's corner, cell (1/8 mm), rows of a stamp to each side, most points that count. Returns the first point not looked at.
    """
    edge = job[2] << 3  # eight cells round the grid
    across = edge * 46 >> 3
    inverse = 4194304 // job[2]  # 2**22 / cell
    reach = job[3]
    high = reach + reach + 1
    most = job[4]
    while first < last and most > 0:
        x = (((fx[first] - job[0] + edge) & 0xFFFF) ^ 0x8000) - 0x8000
        y = (((fy[first] - job[1] + edge) & 0xFFFF) ^ 0x8000) - 0x8000
        first += 1
        if x < 0 or y < 0 or x >= across or y >= across:
            continue
        x = x * inverse >> 21  # half cells
        y = y * inverse >> 21
        m = 1 << (x & 31)
        i = y * 3 + (x >> 5)
        if seen[i] & m:
            continue
        seen[i] = seen[i] | m
        # bit 8 of a stamp is the point's own column
        s = (((y & 1) << 1) + (x & 1)) * 24 * high
        x = x >> 1
        left = 0
        right = 16 - x
        if x > 16:
            left = x - 16
            right = 0
        y = (y >> 1) - 8 - reach
        top = y + high
        lost = 0
        if y < 0:
            lost = 0 - y
            y = 0
        if top > 30:
            top = 30
        if y >= top:
            continue
        most -= 1
        t = 0
        while t < 360:
            i = s + lost + lost
            row = t + y
            end = t + top
            while row < end:
                m = stamps[i]
                if m:
                    tight[row] = tight[row] | (((m << left) >> right) & 0x3FFFFFFF)
                    m = stamps[i + 1]
                    closed[row] = closed[row] | (((m << left) >> right) & 0x3FFFFFFF)
                i += 2
                row += 1
            s += high + high
            t += 30
    return first


@micropython.viper
def _seed(cost: ptr16, rows: ptr32, queue: ptr16, ux: int, uy: int, state: ptr32, inward: ptr16):
    """Open poses on the rim are exits; those in the direction (ux, uy) * 2**10 are the cheapest.

    inward: what each of 24 headings of the nose adds on the far rim (field_steps.inward()). state[3]: of heading_branch.tell().
    The rim is the last row and column but one: the outermost are closed, which spares _spread() to look where the grid ends.
    """
    tail = 0
    t = 0
    while t < 360:
        t += 30
        rows[t - 30] = 0x3FFFFFFF
        rows[t - 1] = 0x3FFFFFFF
        i = t - 29
        while i < t - 1:
            rows[i] = rows[i] | 0x20000001
            i += 1
    sense = state[3]
    t = 0
    while t < 12:
        side = 0
        while side < 4:
            # Heading of the nose as the far rim sees it, whichever side this is.
            h = t + 12 * (sense >> t & 1)
            if side == 0:
                h += 12
            elif side == 2:
                h += 6
            elif side == 3:
                h += 18
            if h >= 24:
                h -= 24
            more = inward[h]
            i = 1
            while i < 29:
                x = i
                y = i
                if side == 0:
                    y = 1
                elif side == 1:
                    y = 28
                elif side == 2:
                    x = 1
                else:
                    x = 28
                at = (t * 30 + y) * 30 + x
                if ((rows[t * 30 + y] >> x) & 1) == 0 and cost[at] == 32767:
                    # 14 cells ahead least, behind 3 times the way there more
                    c = ((46 << 10) - (x + x - 29) * ux - (y + y - 29) * uy) * 12 >> 10
                    if c < 0:
                        c = 0
                    c += more
                    cost[at] = c | 0x8000
                    queue[tail] = at
                    tail += 1
                i += 1
            side += 1
        t += 1
    state[0] = 0
    state[1] = tail
    state[2] = 0


@micropython.viper
def sample(cost: ptr16, poses: ptr32, n: int, cell: int):
    """Cost at n poses, mm, put in the place of their x: trilinear between the grid's. 20000 where a pose is closed, or beyond the grid.

    poses: x, y from the grid's corner (1/8 mm) + 2**16, heading (0.1 deg), none negative.
    """
    half = cell >> 1
    limit = cell * 28 - 1
    last = n * 3
    p = 0
    while p < last:
        x = poses[p] - 65536 - half
        y = poses[p + 1] - 65536 - half
        value = 20000
        # A body beyond the grid may meet what the field knows nothing of.
        if x >= 0 and y >= 0 and x <= limit + cell and y <= limit + cell:
            if x < cell:
                x = cell
            if y < cell:
                y = cell
            if x > limit:
                x = limit
            if y > limit:
                y = limit
            i = x // cell
            j = y // cell
            # Weights in sixteenths, rounded: a mirrored field gives the mirrored cost.
            fx = (((x - i * cell) << 4) + half) // cell
            fy = (((y - j * cell) << 4) + half) // cell
            heading = poses[p + 2] % 1800
            t = heading // 150
            ft = (((heading - t * 150) << 4) + 75) // 150
            least = 32767
            total = 0
            closed = 0
            at = (t * 30 + j) * 30 + i
            gx = 16 - fx
            a = 0
            while a < 4:
                # Two orientations, of each two rows, of each two places.
                wt = 16 - fy
                if a & 1:
                    wt = fy
                if a & 2:
                    wt = wt * ft
                else:
                    wt = wt * (16 - ft)
                if wt:
                    if gx:
                        v = cost[at]
                        if v == 32767:
                            closed += wt * gx
                        else:
                            total += v * wt * gx
                            if v < least:
                                least = v
                    if fx:
                        v = cost[at + 1]
                        if v == 32767:
                            closed += wt * fx
                        else:
                            total += v * wt * fx
                            if v < least:
                                least = v
                a += 1
                at += 30
                if a == 2:
                    at += 840
                    if t == 11:
                        at -= 10800
            if least != 32767:
                total += (least + 48) * closed  # closed: a little dearer than the best pose round about
                value = ((total >> 8) * cell) >> 11  # a cost unit is cell / 128 mm
        poses[p] = value
        p += 3


class CostToGo:
    """Cost of leaving, by pose. `ready` once a first field exists; `step()` renews it slice by slice.

    scratch: room for LENGTH 16-bit words (queue.py), used while a cost to go is being made.
    """

    def __init__(self, config, scratch):
        from planner import tables

        self._masks, self._primitives, self._rim = tables.cost_to_go(config)
        tables = None
        unload("planner.tables")
        self.cell = config.robot_length * 8 // 12  # 1/8 mm
        self._straight = config.mode != "AWS"  # the last axle stays so
        if self._straight:
            from planner.propagate_naws import spread
        else:
            from planner.propagate import spread
        self._spread = spread
        self._weight = bytearray(_PLACES)
        self._closed = array("i", [0] * (_N * _TURNS))
        self._tight = array("i", [0] * (_N * _TURNS))
        self._queue = scratch  # 16-bit words
        self.cost = bytearray(2 * _STATES)
        self._state = array("i", [0, 0, 0, 0])  # of spread(); 3 as heading_branch.tell() sets it
        # of the field being made: x, y of the corner (1/8 mm mod 2**16), cell, then what _cover() and _close() have as 3 and 4
        self._job = array("i", [0, 0, self.cell, 0, _POINTS])
        self._radius = config.robot_width * 4 + self.cell // 2  # of what the trail makes dear
        self._tx = array("H", bytes(2 * _TRAIL_POINTS))
        self._ty = array("H", bytes(2 * _TRAIL_POINTS))
        self._trail = 0  # points laid so far
        self.ux = 0  # direction of travel over the last few lengths, * 2**10
        self.uy = 1024
        self._pose = array("i", (0, 0, 0))  # for at()
        self._stage = 0
        self._lean = 0
        self._k = 0
        self.corner_x = 0  # of the field in use, 1/8 mm mod 2**16
        self.corner_y = 0
        self.ready = False
        self.builds = 0
        self._px = 0
        self._py = 0

    def follow(self, odometry):
        """Lay the trail and turn the sense of direction with the robot. Call once a frame."""
        x = odometry.x
        y = odometry.y
        if self._trail == 0:
            self._px = x
            self._py = y
        dx = (x - self._px) >> 8
        dy = (y - self._py) >> 8
        step = self.cell >> 3
        if self._trail and dx * dx + dy * dy < step * step:
            return
        i = self._trail % _TRAIL_POINTS
        self._tx[i] = (x >> 5) & 0xFFFF
        self._ty[i] = (y >> 5) & 0xFFFF
        self._trail += 1
        self._px = x
        self._py = y
        # First-order low pass over the way travelled: 2.5 body lengths.
        d = self.cell * 15 >> 2
        self.ux += (dx * 1024 - self.ux * step) // d
        self.uy += (dy * 1024 - self.uy * step) // d

    def step(self, odometry, points):
        """One slice of the next field. Returns True when a new field has just come into use."""
        stage = self._stage
        if stage == 0:
            half = self.cell * (_N // 2)
            job = self._job
            if self.builds:
                middle = self.cell // 2
                x = ((odometry.x >> 5) - job[0] & 0xFFFF ^ 0x8000) - 0x8000
                y = ((odometry.y >> 5) - job[1] & 0xFFFF ^ 0x8000) - 0x8000
                self._lean = heading_branch.lean(self.cost, (x + middle) // self.cell, (y + middle) // self.cell, odometry.heading // 100)
            job[0] = ((odometry.x >> 5) - half) & 0xFFFF
            job[1] = ((odometry.y >> 5) - half) & 0xFFFF
            _clear(self.cost, self._closed, self._tight, self._queue, self._weight)
            self._stage = 1
        elif stage == 1:
            # Ground covered makes dear ground, dearer each time; not what the body still stands on.
            self._job[3] = self._radius
            first = self._trail - _TRAIL_POINTS
            _cover(self._weight, self._tx, self._ty, self._job, first if first > 0 else 0, self._trail - _TRAIL_GAP)
            self._job[3] = len(self._masks) // (16 * _TURNS)
            self._k = 0
            self._stage = 2
        elif stage == 2:
            self._k = _close(self._closed, self._tight, self._masks, self._queue, points.x, points.y, self._k, points.count, self._job)
            if self._k >= points.count:
                self._stage = 3
        elif stage == 3:
            heading_branch.tell(odometry.heading // 100, self._lean, self._state, self._closed)
            _seed(self.cost, self._closed, self._queue, self.ux, self.uy, self._state, self._rim)
            self._stage = 4
        elif stage == 4:
            if self._spread(
                self.cost, self._closed, self._tight, self._weight, self._queue, self._primitives, self._state, _POSES_STRAIGHT if self._straight else _POSES
            ):
                self.corner_x = self._job[0]
                self.corner_y = self._job[1]
                self._stage = 0
                self.builds += 1
                # The very first one does not know to which side the way leads on.
                self.ready = self.builds > 1
                return self.ready
        return False

    def at(self, x, y, heading):
        """Cost of a pose on the floor (1/8 mm mod 2**16, 0.1 deg), mm, relative to others of this field."""
        u = ((x - self.corner_x) & 0xFFFF ^ 0x8000) - 0x8000
        v = ((y - self.corner_y) & 0xFFFF ^ 0x8000) - 0x8000
        pose = self._pose
        pose[0] = u + 65536
        pose[1] = v + 65536
        pose[2] = heading % 1800
        sample(self.cost, pose, 1, self.cell)
        return pose[0]
