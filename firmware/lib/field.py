"""The way on: what it costs the long body, from every pose round it, to leave the neighbourhood.

The envelope test knows what the body can do in the next half second; it does not know where to go. The field does: over
a grid of poses (30 x 30 places of 1/12 body length, 12 orientations of 15 degrees) the cost of the cheapest way out is
spread inwards from the rim. Poses in which the outline covers a point are closed; places the robot has covered already
are dear, dearer each time, so that it goes on rather than back and comes back only when nothing else is left. Rim
places in the direction the robot has been travelling are the cheapest exits.

The body is the same seen from both ends, so half a turn of orientations is enough. The grid is coarse: the outline is
taken a little small, and the exact test of every move is the envelope's business.

The spreading is a label-correcting search (a queue of poses whose cost fell), cut into slices so that no call takes
long; the finished field is copied to bytes, relative to the robot's own cost, and used while the next one is made.
Lengths on the floor are 1/8 mm modulo 2**16; costs are sixteenths of a cell.
"""

from array import array

import micropython
from micropython import const

from once import forget

_POINTS = const(40)  # closed in one slice
_POSES = const(700)  # spread in one slice
_N = const(30)
_TURNS = const(12)
_PLACES = const(900)
_STATES = const(10800)
_QUEUE = const(2048)
_TRAIL = const(1)
_TRAIL_POINTS = const(120)


@micropython.viper
def _clear(cost: ptr16, rows: ptr32, tight: ptr32, seen: ptr32, weight: ptr8):
    i = 0
    while i < 270:
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
def _cover(weight: ptr8, x: int, y: int, radius: int, cell: int, value: int):
    """Make the places within the radius of (x, y) dearer by the value."""
    half = cell >> 1
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
    room = radius * radius
    while j <= j1:
        dy = j * cell + half - y
        i = i0
        while i <= i1:
            dx = i * cell + half - x
            if dx * dx + dy * dy <= room:
                w = weight[j * 30 + i]
                if w < 40:
                    weight[j * 30 + i] = w + value
            i += 1
        j += 1


@micropython.viper
def _close(closed: ptr32, tight: ptr32, seen: ptr32, fx: ptr16, fy: ptr16, first: int, last: int, gx: int, gy: int, shape: ptr32, cell: int) -> int:
    """Close the poses whose outline covers one of the points first..last-1: one mask of 30 bits per row and orientation.

    Of the points in one patch of 2/3 cell the first serves for all. tight: the same for the full outline. Returns how many served.
    """
    size = cell * 30
    half = cell >> 1
    inverse = 4194304 // cell  # 2**22 / cell
    served = 0
    reach = shape[84]
    k = first
    while k < last:
        x = (((fx[k] - gx) & 0xFFFF) ^ 0x8000) - 0x8000
        y = (((fy[k] - gy) & 0xFFFF) ^ 0x8000) - 0x8000
        k += 1
        if x <= 0 - reach or y <= 0 - reach or x >= size + reach or y >= size + reach:
            continue
        # patches: 90 columns (30 to a word) and 90 rows reach one third of the grid beyond it on each side
        i = ((x + (size >> 1)) * 3 * (inverse >> 1)) >> 22
        j = ((y + (size >> 1)) * 3 * (inverse >> 1)) >> 22
        if i >= 0 and j >= 0 and i < 90 and j < 90:
            m = 1 << (i % 30)
            i = j * 3 + i // 30
            if seen[i] & m:
                continue
            seen[i] = seen[i] | m
        served += 1
        t = 0
        while t < 12:
            b = t * 7
            a1 = shape[b] - 65536
            a2 = shape[b + 1] - 65536
            b1 = shape[b + 2]
            b2 = shape[b + 3]
            c1 = shape[b + 4]
            c2 = shape[b + 5]
            tall = shape[b + 6]
            j = ((y - tall - half) * inverse >> 22) + 1
            j1 = (y + tall - half) * inverse >> 22
            if j < 0:
                j = 0
            if j1 > 29:
                j1 = 29
            row = t * 30 + j
            dy = j * cell + half - y
            left = x - half
            while j <= j1:
                m = left + (a1 * dy >> 10)
                n = left + (a2 * dy >> 10)
                lo = m - c1
                if n - c2 > lo:
                    lo = n - c2
                hi = m + c1
                if n + c2 < hi:
                    hi = n + c2
                i0 = (lo * inverse >> 22) + 1
                i1 = hi * inverse >> 22
                if i0 < 0:
                    i0 = 0
                if i1 > 29:
                    i1 = 29
                if i0 <= i1:
                    tight[row] = tight[row] | ((1 << (i1 + 1)) - (1 << i0))
                    lo = m - b1
                    if n - b2 > lo:
                        lo = n - b2
                    hi = m + b1
                    if n + b2 < hi:
                        hi = n + b2
                    i0 = (lo * inverse >> 22) + 1
                    i1 = hi * inverse >> 22
                    if i0 < 0:
                        i0 = 0
                    if i1 > 29:
                        i1 = 29
                    if i0 <= i1:
                        closed[row] = closed[row] | ((1 << (i1 + 1)) - (1 << i0))
                j += 1
                row += 1
                dy += cell
            t += 1
    return served


@micropython.viper
def _seed(cost: ptr16, rows: ptr32, queue: ptr16, ux: int, uy: int, state: ptr32):
    """Open poses on the rim are exits; those in the direction (ux, uy) * 2**10 are the cheapest.

    The rim is the last row and column but one: the outermost are closed, which spares _spread() to look where the grid ends.
    """
    tail = 0
    t = 0
    while t < 360:
        rows[t] = rows[t] | 0x20000001
        t += 30
        rows[t - 30] = 0x3FFFFFFF
        rows[t - 1] = 0x3FFFFFFF
        i = t - 29
        while i < t - 1:
            rows[i] = rows[i] | 0x20000001
            i += 1
    t = 0
    while t < 12:
        side = 0
        while side < 4:
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
                    c = ((23 << 10) - (x - 15) * ux - (y - 15) * uy) * 24 >> 10
                    if c < 0:
                        c = 0
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
def _spread(cost: ptr16, rows: ptr32, tight: ptr32, weight: ptr8, queue: ptr16, steps: ptr16, state: ptr32, budget: int) -> int:
    """Go on spreading for at most `budget` poses; returns 1 when the queue is empty. Bit 15 of a cost: the pose is queued."""
    head = state[0]
    tail = state[1]
    limit = state[2]
    done = 0
    turn_cost = steps[96]
    while budget > 0:
        if head == tail:
            done = 1
            budget = 0
        else:
            at = queue[head]
            here = cost[at] & 0x7FFF
            if here > limit:
                # All within the limit are done: raise it, and bring those within it to the front.
                i = head
                limit = here
                while i != tail:
                    c = cost[queue[i]] & 0x7FFF
                    if c < limit:
                        limit = c
                    i = (i + 1) & 2047
                limit += 96
                i = head
                j = (tail - 1) & 2047
                while i != j:
                    at = queue[i]
                    if (cost[at] & 0x7FFF) <= limit:
                        i = (i + 1) & 2047
                    else:
                        queue[i] = queue[j]
                        queue[j] = at
                        j = (j - 1) & 2047
                budget -= ((tail - head) & 2047) >> 3
                at = queue[head]
                here = cost[at] & 0x7FFF
            head = (head + 1) & 2047
            cost[at] = here
            row = at // 30
            i = at - row * 30 - 1
            t = row // 30
            w = weight[at - t * 900]
            step = t * 8
            # Neighbours row by row; the costs of opposite ways are the same, so they serve in either order.
            to = at - 31
            row -= 1
            r = 0
            while r < 3:
                m = (rows[row] >> i) & 7
                if r == 1:
                    m = m | 2
                if m != 7:
                    dear = (tight[row] >> i) & 7
                    d = 0
                    while d < 3:
                        if m & 1 == 0:
                            c = steps[step] * w >> 1
                            if dear & 1:
                                c = c << 2
                            c += here
                            old = cost[to]
                            if c < (old & 0x7FFF):
                                if old & 0x8000:
                                    cost[to] = c | 0x8000
                                else:
                                    following = (tail + 1) & 2047
                                    if following != head:
                                        cost[to] = c | 0x8000
                                        if c <= limit:
                                            head = (head - 1) & 2047
                                            queue[head] = to
                                        else:
                                            queue[tail] = to
                                            tail = following
                        if r != 1 or d != 1:
                            step += 1
                        m = m >> 1
                        dear = dear >> 1
                        to += 1
                        d += 1
                    to += 27
                else:
                    to += 30
                    step += 3
                    if r == 1:
                        step -= 1
                row += 1
                r += 1
            # The two next orientations.
            i += 1
            r = 0
            while r < 2:
                to = at + 900
                row = row - 2 + 30
                if r:
                    to = at - 900
                    row = at // 30 - 30
                if to >= 10800:
                    to -= 10800
                    row -= 360
                elif to < 0:
                    to += 10800
                    row += 360
                if (rows[row] >> i) & 1 == 0:
                    c = turn_cost
                    if (tight[row] >> i) & 1:
                        c = c << 2
                    c += here
                    old = cost[to]
                    if c < (old & 0x7FFF):
                        if old & 0x8000:
                            cost[to] = c | 0x8000
                        else:
                            following = (tail + 1) & 2047
                            if following != head:
                                cost[to] = c | 0x8000
                                if c <= limit:
                                    head = (head - 1) & 2047
                                    queue[head] = to
                                else:
                                    queue[tail] = to
                                    tail = following
                r += 1
            budget -= 1
    state[0] = head
    state[1] = tail
    state[2] = limit
    return done


@micropython.viper
def _sample(cost: ptr16, x: int, y: int, heading: int, cell: int) -> int:
    """Cost at a pose, mm: trilinear between grid poses. x, y from the grid's corner (1/8 mm), heading in 0.1 deg, any int."""
    half = cell >> 1
    x -= half
    y -= half
    limit = cell * 28 - 1
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
    fx = ((x - i * cell) << 4) // cell
    fy = ((y - j * cell) << 4) // cell
    heading = heading % 1800
    t = heading // 150
    ft = ((heading - t * 150) << 4) // 150
    least = 32767
    a = 0
    while a < 8:
        tt = t + (a >> 2)
        if tt == 12:
            tt = 0
        v = cost[(tt * 30 + j + ((a >> 1) & 1)) * 30 + i + (a & 1)]
        if v < least:
            least = v
        a += 1
    if least == 32767:
        return 20000
    total = 0
    a = 0
    while a < 8:
        tt = t + (a >> 2)
        if tt == 12:
            tt = 0
        v = cost[(tt * 30 + j + ((a >> 1) & 1)) * 30 + i + (a & 1)]
        if v == 32767:
            v = least + 48  # closed: a little dearer than the best pose round about
        wt = 16 - ft
        if a >> 2:
            wt = ft
        if (a >> 1) & 1:
            wt = wt * fy
        else:
            wt = wt * (16 - fy)
        if a & 1:
            wt = wt * fx
        else:
            wt = wt * (16 - fx)
        total += v * wt
        a += 1
    return ((total >> 8) * cell) >> 11  # a cost unit is cell / 128 mm


@micropython.viper
def score_ends(cost, ends: ptr16, turns: ptr16, free: ptr16, lengths: ptr16, score: ptr16, job: ptr32):
    """What each travel of each candidate is worth: score[5 k + i] = travel + cost of the pose where it ends, mm.

    65535 where the travel is longer than the candidate's free length. job: x, y of the body in the grid (1/8 mm), sine,
    cosine (2**14, + 2**14), flip x, flip y (0/1), cell, first, last, stride, heading (0.1 deg)
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
    heading = job[10]
    while k < last:
        i = 0
        while i < 5:
            value = 65535
            at = k * 5 + i
            if lengths[i] <= free[k]:
                px = ends[2 * at] - 8192
                py = ends[2 * at + 1] - 8192
                turn = (turns[at] ^ 0x8000) - 0x8000
                if flip_x:
                    px = 0 - px
                    turn = 0 - turn
                if flip_y:
                    py = 0 - py
                    turn = 0 - turn
                value = lengths[i] + int(_sample(cost, x0 + ((px * c + py * s) >> 11), y0 + ((py * c - px * s) >> 11), heading + turn, cell))
                if value > 65534:
                    value = 65534
            score[at] = value
            i += 1
        k += stride


class Field:
    """Cost of leaving, by pose. `ready` once a first field exists; `work()` renews it slice by slice."""

    def __init__(self, config):
        length = config.robot_length
        width = config.robot_width
        self.cell = length * 8 // 12  # 1/8 mm
        import field_tables

        self._shape = field_tables.shape(width, length, config.avoid_margin, self.cell)
        self._steps = field_tables.steps(length, self.cell)
        forget("field_tables")
        self._trail_radius = width * 4 + self.cell // 2
        self._weight = bytearray(_PLACES)
        self._closed = array("i", [0] * (_N * _TURNS))
        self._tight = array("i", [0] * (_N * _TURNS))
        # 16-bit words, but only the viper functions look inside; array('H') could not be made without a second copy
        self._queue = bytearray(2 * _QUEUE)
        self.cost = bytearray(2 * _STATES)
        self._state = array("i", [0, 0, 0])
        self._tx = array("H", bytes(2 * _TRAIL_POINTS))
        self._ty = array("H", bytes(2 * _TRAIL_POINTS))
        self._trail = 0  # points laid so far
        self._trail_step = length // 12
        self._trail_gap = 10  # points behind the centre that are still under the body
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
        stage = self._stage
        if stage == 0:
            half = self.cell * (_N // 2)
            self._next_x = ((odometry.x >> 5) - half) & 0xFFFF
            self._next_y = ((odometry.y >> 5) - half) & 0xFFFF
            _clear(self.cost, self._closed, self._tight, self._queue, self._weight)
            self._stage = 1
        elif stage == 1:
            self._mark_trail()
            self._k = 0
            self._stage = 2
        elif stage == 2:
            last = self._k + _POINTS
            if last > points.count:
                last = points.count
            _close(self._closed, self._tight, self._queue, points._fx, points._fy, self._k, last, self._next_x, self._next_y, self._shape, self.cell)
            self._k = last
            if last >= points.count:
                _seed(self.cost, self._closed, self._queue, self.ux, self.uy, self._state)
                self._stage = 3
        elif stage == 3:
            if _spread(self.cost, self._closed, self._tight, self._weight, self._queue, self._steps, self._state, _POSES):
                self._stage = 4
        else:
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
        cell = self.cell
        size = cell * _N
        i = first
        while i < last:
            k = i % _TRAIL_POINTS
            x = ((self._tx[k] - self._next_x) & 0xFFFF ^ 0x8000) - 0x8000
            y = ((self._ty[k] - self._next_y) & 0xFFFF ^ 0x8000) - 0x8000
            if -r < x < size + r and -r < y < size + r:
                _cover(self._weight, x, y, r, cell, _TRAIL)
            i += 1

    def at(self, x, y, heading):
        """Cost of a pose on the floor (1/8 mm mod 2**16, 0.1 deg), mm, relative to others of this field."""
        u = ((x - self.corner_x) & 0xFFFF ^ 0x8000) - 0x8000
        v = ((y - self.corner_y) & 0xFFFF ^ 0x8000) - 0x8000
        return _sample(self.cost, u, v, heading, self.cell)
