"""What stands round the robot: lidar frames in, remembered points out.

The lidar does not see nearer than 0.2 m, and the walls a long body squeezes past
are nearer than that. So every point is kept in a frame fixed to the floor and
carried along by the robot's own motion until the lidar, looking straight at the
place, sees past it.

Points are thinned: one per floor cell (1/30 of the body length), each a running mean,
leaning to the near side, of the samples that fell into its cell. Thinning bounds the
planner's work and the mean takes the range noise out of a wall.

Coordinates on the floor are 1/8 mm, modulo 2**16 (8.192 m): differences of two
16-bit coordinates are right as long as the points lie within 4 m of each other.
"""

from array import array
from time import ticks_diff

import micropython
from micropython import const

from trig import SIN, sin14, cos14

_STEP_US = const(10_000)  # of Odometry
_CAPACITY = const(320)
_HASH = const(512)

# Positions in the state buffer shared with the viper functions.
_COUNT = const(0)
_FAR = const(1)  # half side of the square remembered, 1/8 mm
_CELL = const(2)  # floor cell, 1/8 mm
_REACH = const(3)  # longest range taken, quarter mm
_FRAME = const(4)
_TRAVEL = const(5)


@micropython.viper
def _place(bearings: ptr16, distances: ptr16, n: int, pose: ptr32, state: ptr32,
           fx: ptr16, fy: ptr16, cell: ptr16, frame: ptr16, travel: ptr16, index: ptr16, sine: ptr32):
    """Put the points of one frame on the floor.

    pose: x0, y0, x1, y1 (1/8 mm mod 2**16), heading0 (0.01 deg, 0..35999), turn + 36000 over
    the frame: the body at the frame's first and last point (the scan rolls while the robot moves).
    """
    x0 = pose[0]
    y0 = pose[1]
    dx = (((pose[2] - x0) & 0xFFFF) ^ 0x8000) - 0x8000
    dy = (((pose[3] - y0) & 0xFFFF) ^ 0x8000) - 0x8000
    h0 = pose[4]
    turn = pose[5] - 36000
    size = state[2]
    reach = state[3]  # quarter mm
    far8 = state[1]
    stamp = state[4]
    rolled = state[5]
    count = state[0]
    near8 = state[6]
    i = 0
    while i < n:
        d = distances[i]
        if d != 0 and d <= reach:
            a = (h0 + 5 + turn * i // n) // 10 + bearings[i]
            while a >= 3600:
                a -= 3600
            while a < 0:
                a += 3600
            # sine and cosine scaled 2**14 from the quarter-wave table
            if a < 1800:
                if a <= 900:
                    s = sine[a] >> 16
                    c = sine[900 - a] >> 16
                else:
                    s = sine[1800 - a] >> 16
                    c = 0 - (sine[a - 900] >> 16)
            else:
                if a <= 2700:
                    s = 0 - (sine[a - 1800] >> 16)
                    c = 0 - (sine[2700 - a] >> 16)
                else:
                    s = 0 - (sine[3600 - a] >> 16)
                    c = sine[a - 2700] >> 16
            s = (d * s) >> 13
            c = (d * c) >> 13
            if s > far8 or c > far8 or s < 0 - far8 or c < 0 - far8:
                i += 1
                continue
            px = (x0 + dx * i // n + s) & 0xFFFF
            py = (y0 + dy * i // n + c) & 0xFFFF
            # Far off a cell is four: even rows and columns name it.
            k = 255
            if s > near8 or c > near8 or s < 0 - near8 or c < 0 - near8:
                k = 254
            key = ((px // size & k) << 8) + (py // size & k)
            h = (key * 157 >> 5) & 511
            k = index[h]
            free = h
            probes = 8
            while probes > 0 and (k == 0xFFFF or cell[k] != key):
                if index[free] != 0xFFFF:
                    free = h
                h = (h + 1) & 511
                k = index[h]
                probes -= 1
            if probes > 0:
                ex = (((px - fx[k]) & 0xFFFF) ^ 0x8000) - 0x8000
                ey = (((py - fy[k]) & 0xFFFF) ^ 0x8000) - 0x8000
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
            elif count < 320:
                if index[free] != 0xFFFF:
                    free = h
                k = count
                count += 1
                if index[free] == 0xFFFF:
                    index[free] = k
                cell[k] = key
                fx[k] = px
                fy[k] = py
                frame[k] = stamp
                travel[k] = rolled
        i += 1
    state[0] = count


@micropython.viper
def _forget(bearings: ptr16, distances: ptr16, n: int, pose: ptr32, state: ptr32, fx: ptr16, fy: ptr16,
            cell: ptr16, frame: ptr16, travel: ptr16, index: ptr16, sine: ptr32, keep: int):
    """Drop what the frame disproves, what is too old and what is too far.

    A point in the frame's sector is disproved when all beams that could have met it go more than a
    cell past it: all, for the tip of a corner is seen by few, and the body turns about it. One whose
    surface is now in a neighbour cell goes after a revolution and a half. One behind something
    nearer, or inside the blind disc, is kept until the robot has rolled `keep` mm: drift, not time,
    is what makes memory wrong.
    """
    x = pose[2]
    y = pose[3]
    h = (pose[4] + pose[5] - 36000) // 10
    a0 = h + bearings[0]
    a1 = h + bearings[n - 1]
    k = 0
    s0 = 0
    c0 = 0
    s1 = 0
    c1 = 0
    while k < 2:
        a = a0
        if k == 1:
            a = a1
        while a >= 3600:
            a -= 3600
        while a < 0:
            a += 3600
        s = 0
        c = 0
        if a < 1800:
            if a <= 900:
                s = sine[a] >> 20
                c = sine[900 - a] >> 20
            else:
                s = sine[1800 - a] >> 20
                c = 0 - (sine[a - 900] >> 20)
        else:
            if a <= 2700:
                s = 0 - (sine[a - 1800] >> 20)
                c = 0 - (sine[2700 - a] >> 20)
            else:
                s = 0 - (sine[3600 - a] >> 20)
                c = sine[a - 2700] >> 20
        if k == 0:
            s0 = s
            c0 = c
        else:
            s1 = s
            c1 = c
        k += 1
    count = state[0]
    stamp = state[4]
    rolled = state[5]
    size = state[2]
    far8 = state[1]
    near8 = far8 * 3 >> 3  # two thirds of a body length
    patience = (320 - count) * 4
    k = 0
    while k < count:
        px = (((fx[k] - x) & 0xFFFF) ^ 0x8000) - 0x8000
        py = (((fy[k] - y) & 0xFFFF) ^ 0x8000) - 0x8000
        gone = 0
        if px > far8 or py > far8 or px < 0 - far8 or py < 0 - far8:
            gone = 1
        elif ((rolled - travel[k]) & 0xFFFF) > keep:
            gone = 1
        elif count > 250 and ((stamp - frame[k]) & 0xFFFF) > patience and (px > near8 or py > near8 or px < 0 - near8 or py < 0 - near8):
            # Room runs out: what is out of sight and out of reach goes first, or there would be none for what comes.
            gone = 1
        elif frame[k] != stamp:
            # clockwise from the first beam and anticlockwise from the last: inside the sector
            u = (px * c0 - py * s0) >> 6
            v = (py * s1 - px * c1) >> 6
            if u >= 0 and v >= 0 and (u + v) > 0 and (px * (s0 + s1) + py * (c0 + c1)) > 0:
                r2 = (px >> 3) * (px >> 3) + (py >> 3) * (py >> 3)
                # The beams that could have met it: those within 20 mm of it, many where it is near.
                r = 64
                while r * r < r2:
                    r += r >> 2
                side = 51 * n // r + 1
                i = u * (n - 1) // (u + v)
                age = (stamp - frame[k]) & 0xFFFF
                j = i - side
                last = i + side + 1
                clipped = 0
                if j < 0:
                    j = 0
                    clipped = 1
                if last > n:
                    last = n
                    clipped = 1
                lo = 0x7FFF
                hi = 0
                while j < last:
                    d = distances[j]
                    if d < lo:
                        lo = d
                    if d > hi:
                        hi = d
                    j += 1
                if lo > 0 and (clipped == 0 or age > 200):
                    past = (lo >> 2) - (size >> 3) - 20
                    if past > 0 and r2 < past * past:
                        gone = 1
                    elif age > 24 and hi < lo + 160:
                        # one surface, and it is not where the point is
                        near = (hi >> 2) + (size >> 3) + 20
                        if r2 < near * near:
                            gone = 1
        if gone:
            h = (cell[k] * 157 >> 5) & 511
            j = 0
            while j < 9:
                if index[h] == k:
                    index[h] = 0xFFFF
                    j = 9
                h = (h + 1) & 511
                j += 1
            count -= 1
            h = (cell[count] * 157 >> 5) & 511
            j = 0
            while j < 9:
                if index[h] == count:
                    index[h] = k
                    j = 9
                h = (h + 1) & 511
                j += 1
            fx[k] = fx[count]
            fy[k] = fy[count]
            cell[k] = cell[count]
            frame[k] = frame[count]
            travel[k] = travel[count]
        else:
            k += 1
    state[0] = count


@micropython.viper
def _view(state: ptr32, fx: ptr16, fy: ptr16, x: int, y: int, s: int, c: int, reach: int,
          bx: ptr16, by: ptr16) -> int:
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


class Surroundings:
    """The remembered points. `count` of them; `view()` gives them in the body frame."""

    def __init__(self, config):
        length = config.robot_length
        far8 = min(length * 14, 30000)  # 1.75 body lengths to each side
        self.keep = 6 * length  # mm rolled before an unseen point is given up: lining up at a corner takes many short moves
        self._fx = array("H", bytes(2 * _CAPACITY))
        self._fy = array("H", bytes(2 * _CAPACITY))
        self._cell = array("H", bytes(2 * _CAPACITY))
        self._frame = array("H", bytes(2 * _CAPACITY))
        self._travel = array("H", bytes(2 * _CAPACITY))
        self._index = array("H", b"\xff\xff" * _HASH)
        self._pose = array("i", [0] * 6)
        self._state = array("i", [0, far8, length * 8 // 30, min(far8 * 7 // 10, 32000), 0, 0, length * 8])

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
        if late < -60_000 or late > 60_000:
            late = 10_000
        late >>= 4
        span = lidar.period_us >> 4
        step = _STEP_US >> 4
        # Displacement on the floor in one step, 1/256 mm; far below 2**14.
        a = odometry.heading // 100
        s = sin14(a)
        c = cos14(a)
        wx = (odometry.step_x * c + odometry.step_y * s) >> 14
        wy = (odometry.step_y * c - odometry.step_x * s) >> 14
        turn = odometry.step_heading
        x1 = odometry.x - wx * late // step
        y1 = odometry.y - wy * late // step
        h1 = odometry.heading - turn * late // step
        x0 = x1 - wx * span // step
        y0 = y1 - wy * span // step
        turned = turn * span // step
        h0 = (h1 - turned) // 10
        while h0 < 0:
            h0 += 36000
        while h0 >= 36000:
            h0 -= 36000
        pose = self._pose
        pose[0] = (x0 >> 5) & 0xFFFF
        pose[1] = (y0 >> 5) & 0xFFFF
        pose[2] = (x1 >> 5) & 0xFFFF
        pose[3] = (y1 >> 5) & 0xFFFF
        pose[4] = h0
        pose[5] = turned // 10 + 36000
        state = self._state
        state[_FRAME] = (state[_FRAME] + 1) & 0xFFFF
        state[_TRAVEL] = odometry.travel & 0xFFFF
        _place(lidar.bearings, lidar.distances, n, pose, state, self._fx, self._fy, self._cell,
               self._frame, self._travel, self._index, SIN)
        _forget(lidar.bearings, lidar.distances, n, pose, state, self._fx, self._fy, self._cell,
                self._frame, self._travel, self._index, SIN, self.keep)

    def view(self, odometry, bx, by, reach):
        """Fill bx, by (array 'H', mm + 8192, body frame) with the points within reach mm; returns their number."""
        a = (odometry.heading + 50) // 100
        return _view(self._state, self._fx, self._fy, (odometry.x >> 5) & 0xFFFF, (odometry.y >> 5) & 0xFFFF,
                     sin14(a), cos14(a), reach, bx, by)
