"""What stands round the robot: lidar frames in, remembered points out.

The lidar does not see nearer than 0.2 m, and the walls a long body squeezes past
are nearer than that. So every point is kept in a frame fixed to the floor and
carried along by the robot's own motion until the lidar, looking straight at the
place, sees past it.

Points are thinned: one per floor cell (1/30 of the body length, twice that farther off
than a body length), each a running mean, leaning to the near side, of the samples that
fell into its cell. Thinning bounds the planner's work and the mean takes the range
noise out of a wall.

Coordinates on the floor are 1/8 mm, modulo 2**16 (8.192 m): differences of two
16-bit coordinates are right as long as the points lie within 4 m of each other.
"""

from array import array
from time import ticks_diff

import micropython
from micropython import const

from core.trig import SIN, cos14, sin14

_CAPACITY = const(320)
_CROWDED = const(270)
_HASH = const(512)
_PROBES = const(8)  # places in the index where a cell may be named, one after the other
_NONE = const(0xFFFF)
_SHARE = const(8)  # one slot in so many is looked at on a frame for what changes slowly: distance, travel, room
_HALF = const(0x8000)
_KEPT = const(240)  # most units of travel that a point is kept: a byte tells 256 apart, and a slot has its turn after a few

# Odometry's step and the times are taken in 16 us, so that their products with displacements stay small.
_STEP = const(625)
_LATE_US = const(10_000)
_LATEST_US = const(60_000)

# Positions in the state buffer shared with the viper functions.
_COUNT = const(0)
_FRAME = const(1)
_TRAVEL = const(2)  # rolled, in units of 2**_UNIT mm, modulo 2**8
_X0 = const(3)  # the lidar at the frame's first point and at its last: 1/8 mm modulo 2**16
_Y0 = const(4)
_X1 = const(5)
_Y1 = const(6)
_HEADING = const(7)  # at the first, 0.01 deg, 0..35999
_TURN = const(8)  # from the first to the last, 0.01 deg + 36000
_FAR = const(9)  # half side of the square remembered, 1/8 mm
_CELL = const(10)  # floor cell, 1/8 mm
_PER_CELL = const(11)  # 2**20 / cell
_REACH = const(12)  # longest range taken, quarter mm
_KEEP = const(13)  # such units rolled before an unseen point is given up
_UNIT = const(14)
_COARSE = const(15)  # farther than this, 1/8 mm, a cell is four
_LIDAR_X = const(16)  # the lidar right of the body's centre and ahead of it, mm + 4096
_LIDAR_Y = const(17)
_CLOSE = const(18)  # shortest range taken, quarter mm
_STATES = const(19)


_SQUARES = array("i")  # of ranges a quarter apart, mm**2
_SHARES = array("H")  # of a frame's beams that pass within 20 mm of a point there, * 2**16
_range = 64
while _range < 8000:  # the memory of the longest body reaches 5300 mm
    _SQUARES.append(_range * _range)
    _SHARES.append((51 << 16) // _range + 1)
    _range += _range >> 2


@micropython.viper
def _locate(state: ptr32, x: int, y: int, heading: int, step_x: int, step_y: int, turn: int, travel: int, late: int, span: int):
    """Begin a frame: where the lidar was at its first and last point.

    x, y, heading: as of now, 1/256 mm and 0.001 deg. step_x, step_y, turn: its motion in 10 ms, in the body frame.
    travel: rolled until now, 1/256 mm. late, span: time since the last point, and from the first to it, 16 us.
    """
    state[_FRAME] = (state[_FRAME] + 1) & 0xFFFF
    state[_TRAVEL] = (travel >> (8 + state[_UNIT])) & 0xFF
    s = int(sin14(heading // 100))
    c = int(sin14(heading // 100 + 900))
    # Displacement on the floor in one step, 1/256 mm; far below 2**14.
    wx = (step_x * c + step_y * s) >> 14
    wy = (step_y * c - step_x * s) >> 14
    x -= wx * late // _STEP
    y -= wy * late // _STEP
    turned = turn * span // _STEP
    # From the body's centre to the lidar on the floor; at the first point it was turned by so much less, 18 / 2**20 of a radian a unit.
    px = state[_LIDAR_X] - 4096
    py = state[_LIDAR_Y] - 4096
    lx = (px * c + py * s) >> 11
    ly = (py * c - px * s) >> 11
    state[_X1] = ((x >> 5) + lx) & 0xFFFF
    state[_Y1] = ((y >> 5) + ly) & 0xFFFF
    state[_X0] = (((x - wx * span // _STEP) >> 5) + lx - (ly * turned * 18 >> 20)) & 0xFFFF
    state[_Y0] = (((y - wy * span // _STEP) >> 5) + ly + (lx * turned * 18 >> 20)) & 0xFFFF
    first = (heading - turn * late // _STEP - turned) // 10
    while first < 0:
        first += 36000
    while first >= 36000:
        first -= 36000
    state[_HEADING] = first
    state[_TURN] = turned // 10 + 36000


@micropython.viper
def insert(bearings: ptr16, distances: ptr16, n: int, state: ptr32, fx: ptr16, fy: ptr16, cell: ptr16, frame: ptr16, travel: ptr8, index: ptr16):
    """Put the points of one frame on the floor, each from where the body was then: the scan rolls while the robot moves."""
    sine = ptr16(SIN)
    # The body's pose from point to point in 2**-13 of its units, n of them more: so rounding down hits what a division would give.
    x = (state[_X0] << 13) + n
    y = (state[_Y0] << 13) + n
    h = ((state[_HEADING] + 5) << 13) + n
    step_x = (((((state[_X1] - state[_X0]) & 0xFFFF) ^ _HALF) - _HALF) << 13) // n
    step_y = (((((state[_Y1] - state[_Y0]) & 0xFFFF) ^ _HALF) - _HALF) << 13) // n
    step_h = ((state[_TURN] - 36000) << 13) // n
    size = state[_CELL]
    per = state[_PER_CELL]
    reach = state[_REACH]
    close = state[_CLOSE]
    far8 = state[_FAR]
    stamp = state[_FRAME]
    rolled = state[_TRAVEL]
    coarse = state[_COARSE]
    count = state[_COUNT]
    i = 0
    while i < n:
        d = distances[i]
        if d <= reach and d >= close:
            a = h >> 13
            if a < 0:
                a += 36000
            a = ((a * 26215) >> 18) + bearings[i]  # a // 10
            while a >= 3600:
                a -= 3600
            # sine and cosine scaled 2**14 from the quarter-wave table, written out: a call would cost more than all the rest
            k = 0
            if a >= 1800:
                a -= 1800
                k = 1
            if a <= 900:
                s = sine[a] >> 2
                c = sine[900 - a] >> 2
            else:
                s = sine[1800 - a] >> 2
                c = 0 - (sine[a - 900] >> 2)
            if k:
                s = 0 - s
                c = 0 - c
            s = (d * s) >> 13
            c = (d * c) >> 13
            if s <= far8 and c <= far8 and s + far8 >= 0 and c + far8 >= 0:
                px = ((x >> 13) + s) & 0xFFFF
                py = ((y >> 13) + c) & 0xFFFF
                # px // size and py // size: the product falls short by one at most
                cx = ((px >> 2) * per) >> 18
                if (cx + 1) * size <= px:
                    cx += 1
                cy = ((py >> 2) * per) >> 18
                if (cy + 1) * size <= py:
                    cy += 1
                # The square remembered is 105 cells wide: rows and columns are told apart by 8 bits.
                k = 255
                if s > coarse or c > coarse or s + coarse < 0 or c + coarse < 0:
                    k = 254
                key = ((cx & k) << 8) + (cy & k)
                at = (key * 157 >> 5) & 511
                probes = _PROBES
                free = at
                k = index[at]
                while probes:
                    if k == _NONE:
                        if index[free] != _NONE:
                            free = at
                    elif cell[k] == key:
                        break
                    at = (at + 1) & 511
                    k = index[at]
                    probes -= 1
                if probes:
                    ex = (((px - fx[k]) & 0xFFFF) ^ _HALF) - _HALF
                    ey = (((py - fy[k]) & 0xFFFF) ^ _HALF) - _HALF
                    # A sample nearer than the mean pulls four times as hard as a farther one: the tip of a corner
                    # would vanish in a plain mean, and the body turns about corners.
                    if ex * s + ey * c < 0:
                        ex = (ex + 2) >> 2
                        ey = (ey + 2) >> 2
                    else:
                        ex = (ex + 8) >> 4
                        ey = (ey + 8) >> 4
                    fx[k] = (fx[k] + ex) & 0xFFFF
                    fy[k] = (fy[k] + ey) & 0xFFFF
                    frame[k] = stamp
                    travel[k] = rolled
                elif count < _CAPACITY:
                    if index[free] == _NONE:
                        index[free] = count
                    cell[count] = key
                    fx[count] = px
                    fy[count] = py
                    frame[count] = stamp
                    travel[count] = rolled
                    count += 1
        x += step_x
        y += step_y
        h += step_h
        i += 1
    state[_COUNT] = count


@micropython.viper
def clear_seen_past(bearings: ptr16, distances: ptr16, n: int, state: ptr32, fx: ptr16, fy: ptr16, cell: ptr16, frame: ptr16, travel: ptr8, index: ptr16):
    """Drop what the frame disproves, what is too old and what is too far.

    A point in the frame's sector is disproved when all beams that could have met it go more than a
    cell past it: all, for the tip of a corner is seen by few, and the body turns about it. One whose
    surface is now in a neighbour cell goes after a revolution and a half. One behind something
    nearer, or inside the blind disc, is kept until the robot has rolled `keep` mm: drift, not time,
    is what makes memory wrong.
    """
    sine = ptr16(SIN)
    squares = ptr32(_SQUARES)
    shares = ptr16(_SHARES)
    s0 = 0
    c0 = 0
    s1 = 0
    c1 = 0
    k = 0
    while k < 2:
        a = (state[_HEADING] + state[_TURN] - 36000) // 10 + bearings[k * (n - 1)]
        while a >= 3600:
            a -= 3600
        while a < 0:
            a += 3600
        # directions of the first and of the last beam, scaled 2**10
        s0 = s1
        c0 = c1
        if a < 1800:
            if a <= 900:
                s1 = sine[a] >> 6
                c1 = sine[900 - a] >> 6
            else:
                s1 = sine[1800 - a] >> 6
                c1 = 0 - (sine[a - 900] >> 6)
        else:
            if a <= 2700:
                s1 = 0 - (sine[a - 1800] >> 6)
                c1 = 0 - (sine[2700 - a] >> 6)
            else:
                s1 = 0 - (sine[3600 - a] >> 6)
                c1 = sine[a - 2700] >> 6
        k += 1
    mirrored = 0
    if s1 * c0 < c1 * s0:
        mirrored = 1
        k = s0
        s0 = s1
        s1 = k
        k = c0
        c0 = c1
        c1 = k
    count = state[_COUNT]
    stamp = state[_FRAME]
    far8 = state[_FAR]
    margin = (state[_CELL] >> 3) + 20
    patience = (_CAPACITY - count) * 4
    # The coordinate along which the sector lies comes first: its sign settles half of the points.
    along = fy
    across = fx
    pa = state[_Y1] - _HALF
    qa = state[_X1] - _HALF
    flip = 0
    if c0 + c1 < 0:
        flip = 0xFFFF
    s0 = 0 - s0
    c1 = 0 - c1
    if (s1 - s0) * (s1 - s0) > (c0 - c1) * (c0 - c1):
        along = fx
        across = fy
        k = pa
        pa = qa
        qa = k
        flip = 0
        if s1 - s0 < 0:
            flip = 0xFFFF
        k = s0
        s0 = c0
        c0 = k
        k = s1
        s1 = c1
        c1 = k
    # Coordinates relative to the body are taken with 2**15 added: it is cheaper to take their share off the products.
    first = (s0 + c0) << 15
    last = (s1 + c1) << 15
    due = stamp & (_SHARE - 1)
    k = 0
    while k < count:
        p = (along[k] - pa) & 0xFFFF
        gone = 0
        if p ^ flip >= _HALF:
            # clockwise from the first beam and anticlockwise from the last: inside the sector
            q = (across[k] - qa) & 0xFFFF
            u = p * s0 + q * c0 - first
            v = -1
            if u >= 0:
                v = p * s1 + q * c1 - last
            if v >= 0:
                age = (stamp - frame[k]) & 0xFFFF
                u >>= 6
                v >>= 6
                if age and u + v:
                    i = u * (n - 1) // (u + v)
                    if mirrored:
                        i = n - 1 - i
                    # Nothing disproves it that is not farther than this in every beam, so most are done with the one in the middle.
                    beyond = 0 - margin
                    if age > 24:
                        beyond = margin + 40
                    d = distances[i]
                    reach = (d >> 2) + beyond
                    if d and reach > 0:
                        rx = (p >> 3) - 4096
                        ry = (q >> 3) - 4096
                        r2 = rx * rx + ry * ry
                        if r2 < reach * reach:
                            # The beams that could have met it: those within 20 mm of it, many where it is near.
                            m = 0
                            if r2 > squares[9]:
                                m = 10
                            elif r2 > squares[5]:
                                m = 6
                            while squares[m] < r2:
                                m += 1
                            side = (n * shares[m] >> 16) + 1
                            j = i - side
                            end = i + side + 1
                            clipped = 0
                            if j < 0:
                                j = 0
                                clipped = 1
                            if end > n:
                                end = n
                                clipped = 1
                            if clipped == 0 or age > 200:
                                # Walls slope: the nearest beam and the farthest are mostly the first and the last.
                                lo = distances[j]
                                hi = distances[end - 1]
                                if hi < lo:
                                    lo = hi
                                    hi = distances[j]
                                past = (lo >> 2) - margin
                                if past > 0 and r2 < past * past:
                                    gone = 1
                                    m = j + 1
                                    while m < end:
                                        # two a turn, the last one perhaps again
                                        if distances[m - 1] < lo or distances[m] < lo:
                                            lo = distances[m]
                                            if distances[m - 1] < lo:
                                                lo = distances[m - 1]
                                            past = (lo >> 2) - margin
                                            if past <= 0 or r2 >= past * past:
                                                gone = 0
                                                m = end
                                        m += 2
                                if gone == 0 and age > 24:
                                    # one surface, and it is not where the point is
                                    while j < end and hi - lo < 160:
                                        d = distances[j]
                                        if d < lo:
                                            lo = d
                                        elif d > hi:
                                            hi = d
                                        j += 1
                                    near = (hi >> 2) + margin
                                    if lo and hi - lo < 160 and r2 < near * near:
                                        gone = 1
        if k == due:
            due += _SHARE
            p -= _HALF
            if p < 0:
                p = 0 - p
            q = ((across[k] - qa) & 0xFFFF) - _HALF
            if q < 0:
                q = 0 - q
            if p < q:
                p = q
            if p > far8 or (state[_TRAVEL] - travel[k]) & 0xFF >= state[_KEEP]:
                gone = 1
            elif count > _CROWDED and p > far8 * 3 >> 3 and (stamp - frame[k]) & 0xFFFF > patience:
                # Room runs out: what is out of sight and farther than two thirds of a body length goes first, or there would be none
                # for what comes.
                gone = 1
        if gone:
            at = (cell[k] * 157 >> 5) & 511
            j = 0
            while j < _PROBES:
                if index[at] == k:
                    index[at] = _NONE
                    j = _PROBES
                at = (at + 1) & 511
                j += 1
            # The last slot moves here.
            count -= 1
            at = (cell[count] * 157 >> 5) & 511
            j = 0
            while j < _PROBES:
                if index[at] == count:
                    index[at] = k
                    j = _PROBES
                at = (at + 1) & 511
                j += 1
            fx[k] = fx[count]
            fy[k] = fy[count]
            cell[k] = cell[count]
            frame[k] = frame[count]
            travel[k] = travel[count]
        else:
            k += 1
    state[_COUNT] = count


@micropython.viper
def _view(state: ptr32, fx: ptr16, fy: ptr16, x: int, y: int, s: int, c: int, reach: int, bx: ptr16, by: ptr16) -> int:
    """Body-frame view of the points within reach: mm + 8192. Returns their number."""
    count = state[0]
    n = 0
    k = 0
    while k < count:
        px = (((fx[k] - x) & 0xFFFF) ^ 0x8000) - 0x8000
        py = (((fy[k] - y) & 0xFFFF) ^ 0x8000) - 0x8000
        # 1/8 mm * 2**14 -> mm, rounded
        qx = (px * c - py * s + 65536) >> 17
        qy = (px * s + py * c + 65536) >> 17
        if qx <= reach and qy <= reach and qx >= 0 - reach and qy >= 0 - reach:
            bx[n] = qx + 8192
            by[n] = qy + 8192
            n += 1
        k += 1
    return n


class LocalMap:
    """The remembered points. `count` of them; `view()` gives them in the body frame."""

    def __init__(self, config):
        length = config.robot_length
        far8 = min(length * 14, 30000)  # 1.75 body lengths to each side
        size = length * 8 // 30
        self.keep = 6 * length  # mm rolled before an unseen point is given up: lining up at a corner takes many short moves
        self._fx = array("H", bytes(2 * _CAPACITY))
        self._fy = array("H", bytes(2 * _CAPACITY))
        self._cell = array("H", bytes(2 * _CAPACITY))
        self._frame = array("H", bytes(2 * _CAPACITY))
        self._travel = bytearray(_CAPACITY)
        self._index = array("H", b"\xff\xff" * _HASH)
        self._state = state = array("i", [0] * _STATES)
        state[_FAR] = far8
        state[_CELL] = size
        state[_PER_CELL] = (1 << 20) // size
        state[_REACH] = min(far8 * 7 // 10, 4 * config.lidar_far, 32000)
        state[_CLOSE] = 4 * config.lidar_near
        while self.keep >> state[_UNIT] > _KEPT:
            state[_UNIT] += 1
        state[_KEEP] = self.keep >> state[_UNIT]
        state[_COARSE] = length * 8
        state[_LIDAR_X] = config.lidar_x + 4096
        state[_LIDAR_Y] = config.lidar_y + 4096

    @property
    def count(self):
        return self._state[_COUNT]

    def frame(self, lidar, odometry):
        """Place one frame's points, measured while the body moved as odometry says.

        The pose is known for about now; the last point was measured a little before (it had to come down the wire) and the
        first a frame earlier. Over that time the motion of the last step is taken to go on.
        """
        n = lidar.n
        if n < 2:
            return
        late = ticks_diff(odometry.now_us, lidar.frame_us)
        if not -_LATEST_US <= late <= _LATEST_US:
            late = _LATE_US
        state = self._state
        _locate(
            state,
            odometry.x,
            odometry.y,
            odometry.heading,
            odometry.step_x,
            odometry.step_y,
            odometry.step_heading,
            odometry.travel256,
            late >> 4,
            lidar.period_us >> 4,
        )
        bearings = lidar.bearings
        distances = lidar.distances
        fx = self._fx
        fy = self._fy
        cell = self._cell
        frame = self._frame
        travel = self._travel
        index = self._index
        insert(bearings, distances, n, state, fx, fy, cell, frame, travel, index)
        clear_seen_past(bearings, distances, n, state, fx, fy, cell, frame, travel, index)

    def view(self, x, y, heading, bx, by, reach):
        """Fill bx, by (array 'H', mm + 8192, body frame) with the points within reach mm; returns their number.

        x, y, heading: the body, 1/8 mm and 0.1 deg.
        """
        return _view(self._state, self._fx, self._fy, x & 0xFFFF, y & 0xFFFF, sin14(heading), cos14(heading), reach, bx, by)
