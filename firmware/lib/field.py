"""The way on: a coarse grid round the robot and, in every cell, the cost of leaving it.

The envelope test knows what the long body can do in the next half second; it does not know where to go. The field
does: from every cell on the rim of the grid (48 x 48 cells of 1/15 body length, the robot in the middle) the cost
of the way to it is spread inwards, round the obstacles grown by half the body's width. Rim cells in the direction
the robot has been travelling are the cheapest exits; ground the robot has covered already is dear, so it goes on
rather than back, and comes back only when there is nothing else.

The spreading is a label-correcting search (a queue of cells whose cost fell) with steps of 16 and 23 per cell, cut
into slices so that no call takes long. While it is under way the previous field stays in use.
"""

from array import array

import micropython
from micropython import const

N = const(48)
CELLS = const(N * N)
STEP = const(16)
_TRAIL = const(2)
_TRAIL_POINTS = const(160)


@micropython.viper
def _clear(weight: ptr8, cost: ptr16, queued: ptr8):
    i = 0
    while i < 2304:
        weight[i] = 2
        cost[i] = 60000
        queued[i] = 0
        i += 1


@micropython.viper
def _stamp(weight: ptr8, x: int, y: int, radius2: int, radius: int, cell: int, value: int, add: int):
    """Give cells whose centre is within the radius of (x, y) the value, or add to it. Units of 1/8 mm from the grid's corner."""
    half = cell >> 1
    i0 = (x - radius) // cell
    i1 = (x + radius) // cell
    j0 = (y - radius) // cell
    j1 = (y + radius) // cell
    if i0 < 0:
        i0 = 0
    if j0 < 0:
        j0 = 0
    if i1 > 47:
        i1 = 47
    if j1 > 47:
        j1 = 47
    j = j0
    while j <= j1:
        dy = j * cell + half - y
        room = radius2 - dy * dy
        i = i0
        while i <= i1:
            dx = i * cell + half - x
            if dx * dx <= room:
                w = weight[j * 48 + i]
                if add:
                    if w < 60:
                        weight[j * 48 + i] = w + value
                elif w < value:
                    weight[j * 48 + i] = value
            i += 1
        j += 1


@micropython.viper
def _obstacles(weight: ptr8, fx: ptr16, fy: ptr16, count: int, gx: int, gy: int, cell: int, hard: int, wide: int, k: int, last: int):
    """Grow the points k..last-1 into the weights."""
    size = cell * 48
    half = cell >> 1
    h2 = hard * hard
    w2 = wide * wide
    if last > count:
        last = count
    while k < last:
        x = (((fx[k] - gx) & 0xFFFF) ^ 0x8000) - 0x8000
        y = (((fy[k] - gy) & 0xFFFF) ^ 0x8000) - 0x8000
        if x > 0 - wide and y > 0 - wide and x < size + wide and y < size + wide:
            i0 = (x - wide) // cell
            i1 = (x + wide) // cell
            j = (y - wide) // cell
            j1 = (y + wide) // cell
            if i0 < 0:
                i0 = 0
            if j < 0:
                j = 0
            if i1 > 47:
                i1 = 47
            if j1 > 47:
                j1 = 47
            while j <= j1:
                dy = j * cell + half - y
                dy = dy * dy
                i = i0
                while i <= i1:
                    dx = i * cell + half - x
                    d2 = dx * dx + dy
                    if d2 <= w2:
                        at = j * 48 + i
                        if d2 <= h2:
                            weight[at] = 90
                        elif weight[at] < 3:
                            weight[at] = 3
                    i += 1
                j += 1
        k += 1


@micropython.viper
def _seed(cost: ptr16, queue: ptr16, queued: ptr8, ux: int, uy: int, state: ptr32):
    """Rim cells are exits; those in the direction (ux, uy) * 2**10 are the cheapest."""
    tail = 0
    i = 0
    while i < 48:
        side = 0
        while side < 4:
            if side == 0:
                at = i
                dx = i - 24
                dy = -24
            elif side == 1:
                at = 47 * 48 + i
                dx = i - 24
                dy = 24
            elif side == 2:
                at = i * 48
                dx = -24
                dy = i - 24
            else:
                at = i * 48 + 47
                dx = 24
                dy = i - 24
            # 24 cells ahead 0, to the side 24 * 48, behind twice that: 3 times the way itself
            c = ((36 << 10) - dx * ux - dy * uy) * 48 >> 10
            if c < 0:
                c = 0
            if c < cost[at]:
                cost[at] = c
                if queued[at] == 0:
                    queued[at] = 1
                    queue[tail] = at
                    tail += 1
            side += 1
        i += 1
    state[0] = 0
    state[1] = tail


@micropython.viper
def _spread(cost: ptr16, weight: ptr8, queue: ptr16, queued: ptr8, state: ptr32, budget: int) -> int:
    """Go on spreading for at most `budget` cells; returns 1 when the queue is empty."""
    head = state[0]
    tail = state[1]
    done = 0
    while budget > 0:
        if head == tail:
            done = 1
            budget = 0
        else:
            at = queue[head]
            head += 1
            if head == 2304:
                head = 0
            queued[at] = 0
            here = cost[at]
            w = weight[at]
            straight = here + 8 * w
            slant = here + ((23 * w) >> 1)
            j = at // 48
            i = at - j * 48
            b = 0 - 1
            while b <= 1:
                jj = j + b
                if jj >= 0 and jj < 48:
                    a = 0 - 1
                    while a <= 1:
                        ii = i + a
                        if ii >= 0 and ii < 48:
                            to = jj * 48 + ii
                            c = slant
                            if a == 0 or b == 0:
                                c = straight
                            if c < cost[to]:
                                cost[to] = c
                                if queued[to] == 0:
                                    queued[to] = 1
                                    queue[tail] = to
                                    tail += 1
                                    if tail == 2304:
                                        tail = 0
                        a += 1
                b += 1
            budget -= 1
    state[0] = head
    state[1] = tail
    return done


@micropython.viper
def _sample(cost: ptr16, x: int, y: int, cell: int) -> int:
    """Cost at (x, y) 1/8 mm from the grid's corner, bilinear between cell centres."""
    half = cell >> 1
    x -= half
    y -= half
    limit = cell * 47 - 1
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
    fx = ((x - i * cell) << 8) // cell
    fy = ((y - j * cell) << 8) // cell
    at = j * 48 + i
    low = cost[at] * (256 - fx) + cost[at + 1] * fx
    high = cost[at + 48] * (256 - fx) + cost[at + 49] * fx
    return ((low >> 8) * (256 - fy) + (high >> 8) * fy) >> 8


@micropython.viper
def score_ends(cost: ptr16, ends: ptr16, free: ptr16, lengths: ptr16, score: ptr16, job: ptr32):
    """What each travel of each candidate is worth: score[5 k + i] = travel + mean cost-to-leave of the two end discs, mm.

    65535 where the travel is longer than the candidate's free length.
    job: x, y of the body in the grid (1/8 mm), sine, cosine (2**14, + 2**14), flip x, flip y (0/1), cell, first, last,
    stride, mm per cost unit * 256
    """
    x0 = job[0]
    y0 = job[1]
    s = job[2] - 16384
    c = job[3] - 16384
    flip_x = job[4]
    flip_y = job[5]
    cell = job[6]
    k = job[7]
    last = job[8]
    stride = job[9]
    unit = job[10]
    half = cell >> 1
    limit = cell * 47 - 1
    while k < last:
        i = 0
        while i < 5:
            value = 65535
            if lengths[i] <= free[k]:
                t = (k * 5 + i) * 4
                total = 0
                e = 0
                while e < 4:
                    px = ends[t + e] - 8192
                    py = ends[t + e + 1] - 8192
                    if flip_x:
                        px = 0 - px
                    if flip_y:
                        py = 0 - py
                    x = x0 + ((px * c + py * s) >> 11) - half
                    y = y0 + ((py * c - px * s) >> 11) - half
                    if x < 0:
                        x = 0
                    if y < 0:
                        y = 0
                    if x > limit:
                        x = limit
                    if y > limit:
                        y = limit
                    ix = x // cell
                    iy = y // cell
                    fx = ((x - ix * cell) << 8) // cell
                    fy = ((y - iy * cell) << 8) // cell
                    at = iy * 48 + ix
                    low = cost[at] * (256 - fx) + cost[at + 1] * fx
                    high = cost[at + 48] * (256 - fx) + cost[at + 49] * fx
                    total += ((low >> 8) * (256 - fy) + (high >> 8) * fy) >> 8
                    e += 2
                value = lengths[i] + ((total * unit) >> 9)
                if value > 65534:
                    value = 65534
            score[k * 5 + i] = value
            i += 1
        k += stride


class Field:
    """Cost-to-leave round the robot. `ready` once a first field exists; `work()` renews it slice by slice."""

    def __init__(self, config):
        length = config.robot_length
        self.cell = length * 8 // 15  # 1/8 mm
        self.unit = self.cell * 256 // (8 * STEP)  # mm per cost unit, * 256
        self._hard = config.robot_width * 4  # half the width, 1/8 mm
        self._wide = self._hard + self.cell * 3 // 2
        self._trail_radius = config.robot_width * 4 + self.cell // 2
        self._weight = bytearray(CELLS)
        self._queued = bytearray(CELLS)
        self._queue = array("H", bytes(2 * CELLS))
        self._next = array("H", bytes(2 * CELLS))
        self.cost = array("H", bytes(2 * CELLS))
        self._state = array("i", [0, 0])
        self._tx = array("H", bytes(2 * _TRAIL_POINTS))
        self._ty = array("H", bytes(2 * _TRAIL_POINTS))
        self._trail = 0  # points laid so far
        self._trail_step = length // 12
        self._trail_gap = 10  # points behind the centre that are still under the body: 10/12 of its length
        self._last_travel = 0
        self._drift = length * 5 // 2  # mm over which the sense of direction forgets
        self.ux = 0  # direction of travel over the last few lengths, * 2**10
        self.uy = 1024
        self._stage = 0
        self._k = 0
        self.corner_x = 0  # of the field in use, 1/8 mm mod 2**16
        self.corner_y = 0
        self._next_x = 0
        self._next_y = 0
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
        step = self._trail_step
        if self._trail and dx * dx + dy * dy < step * step:
            return
        i = self._trail % _TRAIL_POINTS
        self._tx[i] = (x >> 5) & 0xFFFF
        self._ty[i] = (y >> 5) & 0xFFFF
        self._trail += 1
        self._px = x
        self._py = y
        # First-order low pass over the way travelled.
        d = self._drift
        self.ux += (dx * 1024 - self.ux * step) // d
        self.uy += (dy * 1024 - self.uy * step) // d

    def work(self, odometry, points):
        """One slice of the next field. Returns True when a new field has just come into use."""
        if self._stage == 0:
            half = self.cell * (N // 2)
            self._next_x = ((odometry.x >> 5) - half) & 0xFFFF
            self._next_y = ((odometry.y >> 5) - half) & 0xFFFF
            _clear(self._weight, self._next, self._queued)
            self._mark_trail()
            self._k = 0
            self._stage = 1
        elif self._stage == 1:
            last = self._k + 128
            _obstacles(self._weight, points._fx, points._fy, points.count, self._next_x, self._next_y, self.cell,
                       self._hard, self._wide, self._k, last)
            self._k = last
            if last >= points.count:
                _seed(self._next, self._queue, self._queued, self.ux, self.uy, self._state)
                self._stage = 2
        elif _spread(self._next, self._weight, self._queue, self._queued, self._state, 800):
            self.cost, self._next = self._next, self.cost
            self.corner_x = self._next_x
            self.corner_y = self._next_y
            self._stage = 0
            self.ready = True
            self.builds += 1
            return True
        return False

    def _mark_trail(self):
        """Ground covered makes dear ground, dearer each time; not what the body still stands on."""
        last = self._trail - self._trail_gap
        first = self._trail - _TRAIL_POINTS
        if first < 0:
            first = 0
        r = self._trail_radius
        r2 = r * r
        cell = self.cell
        size = cell * N
        i = first
        while i < last:
            k = i % _TRAIL_POINTS
            x = ((self._tx[k] - self._next_x) & 0xFFFF ^ 0x8000) - 0x8000
            y = ((self._ty[k] - self._next_y) & 0xFFFF ^ 0x8000) - 0x8000
            if -r < x < size + r and -r < y < size + r:
                _stamp(self._weight, x, y, r2, r, cell, _TRAIL, 1)
            i += 1

    def at(self, x, y):
        """Cost-to-leave at a floor position (1/8 mm mod 2**16), mm."""
        u = ((x - self.corner_x) & 0xFFFF ^ 0x8000) - 0x8000
        v = ((y - self.corner_y) & 0xFFFF ^ 0x8000) - 0x8000
        return (_sample(self.cost, u, v, self.cell) * self.unit) >> 8
