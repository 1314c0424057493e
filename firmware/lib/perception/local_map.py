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

How old a point is counts in time and in travel, a byte each; no frame has to come for it, and none may be missed.
"""

from array import array
from time import ticks_diff

import micropython
from micropython import const

from core.trig import SIN, cos14, sin14

_SAME = const(320)  # 1/8 mm: as near to one another two beams have met the same
_SOON = const(40)  # 0.6 s
_STAND = const(8)  # revolutions without anything that comes, until it is taken to have gone or to stand
_LONES = const(24)  # words: x, y, _NOW of eight
_CAPACITY = const(320)
_CROWDED = const(270)
_HASH = const(512)
_PROBES = const(8)  # places in the index where a cell may be named, one after the other
_NONE = const(0xFFFF)
_HALF = const(0x8000)
_BODY_ZERO = const(8192)  # added to coordinates of the body frame, mm, so that they are never negative

# Bytes tell 256 times or travels apart. One slot in _SHARE is looked at on a frame for both, and held at the oldest: so none seems young again.
_SHARE = const(8)
_OLDEST = const(192)  # 3 s
_LONGEST_US = const(114_688)  # 7 units of time: what passes at most from frame to frame, where the lidar was silent; 8 frames of it fit above
_MOST_GONE = const(16)  # dropped on a frame: others are disproved again when the lidar comes round

# Odometry's step and the times are taken in 16 us, so that their products with displacements stay small.
_STEP = const(625)
_LATE_US = const(10_000)
_LATEST_US = const(60_000)

# Positions in the state buffer shared with the viper functions; none is ever negative.
_COUNT = const(0)
_NOW = const(1)  # 2**14 us, modulo 2**8
_TRAVEL = const(2)  # rolled, in units of 2**_UNIT mm, modulo 2**8
_FAR = const(3)  # half side of the square remembered, 1/8 mm
_CELL = const(4)  # floor cell, 1/8 mm
_REACH = const(5)  # longest range taken, quarter mm
_CLOSE = const(6)  # shortest, likewise
_COARSE = const(7)  # farther than this, 1/8 mm, a cell is four
_KEEP = const(8)  # such units rolled before an unseen point is given up
_UNIT = const(9)
_REVOLUTION = const(10)  # units of time that the lidar takes for one and a half
_DOZEN = const(11)  # and for a dozen
_MIRRORED = const(12)  # 1 where bearings fall from point to point
_X = const(13)  # the lidar at the frame's last point, 1/8 mm modulo 2**16
_Y = const(14)
_TIME = const(15)  # us modulo 2**22: _NOW with its fractions
_BLIND = const(16)  # square mm: so near the lidar sees nothing
_STATES = const(17)

_VOID = const(32767)  # stands for a beam that did not return, where that tells something


_SQUARES = array("i")  # of ranges a quarter apart, mm**2
_SHARES = array("H")  # of a frame's beams that pass within 20 mm of a point there, * 2**16
_range = 64
while _range < 8000:  # the memory of the longest body reaches 5300 mm
    _SQUARES.append(_range * _range)
    _SHARES.append((51 << 16) // _range + 1)
    _range += _range >> 2


@micropython.viper
def insert(
    state: ptr32, fx: ptr16, fy: ptr16, index: ptr16, bearings: ptr16, distances: ptr16, n: int, seen: ptr8, travel: ptr8,
    x: int, y: int, h: int, step_x: int, step_y: int, step_h: int,
):  # fmt: skip
    """Put the points of one frame on the floor, each from where the body was then: the scan rolls while the robot moves.

    x, y, h: the lidar and its heading at the first point, 1/8 mm and 0.01 deg; step_x, step_y, step_h: from point to point; all in 2**-13.
    """
    sine = ptr16(SIN)
    size = state[_CELL]
    reach = state[_REACH]
    close = state[_CLOSE]
    far8 = state[_FAR]
    now = state[_NOW]
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
            b = 900 - a
            if b < 0:
                a = 1800 - a
                b = 0 - b
                k += 2
            c = 0
            probes = 2  # the sine, then the cosine
            while probes:
                s = c
                c = sine[a >> 2]
                c = (c + ((sine[(a >> 2) + 1] - c) * (a & 3) >> 2)) >> 2
                a = b
                probes -= 1
            if k & 1:
                s = 0 - s
            if k == 1 or k == 2:
                c = 0 - c
            s = (d * s) >> 13
            c = (d * c) >> 13
            if s <= far8 and c <= far8 and s + far8 >= 0 and c + far8 >= 0:
                px = ((x >> 13) + s) & 0xFFFF
                py = ((y >> 13) + c) & 0xFFFF
                # The cell: its corner, and its place in the index. The square remembered is 105 cells wide: 8 bits tell rows and columns apart.
                k = 0
                if s > coarse or c > coarse or s + coarse < 0 or c + coarse < 0:
                    k = 1
                side = size << k
                cx = px // side
                cy = py // side
                at = (((((cx << k) & 255) << 8) + ((cy << k) & 255)) * 157 >> 5) & (_HASH - 1)
                cx = cx * side
                cy = cy * side
                probes = _PROBES
                free = at
                k = index[at]
                while probes:
                    if k == _NONE:
                        if index[free] != _NONE:
                            free = at
                    elif (fx[k] - cx) & 0xFFFF < side and (fy[k] - cy) & 0xFFFF < side:
                        break
                    at = (at + 1) & (_HASH - 1)
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
                    seen[k] = now
                    travel[k] = rolled
                elif count < _CAPACITY:
                    if index[free] == _NONE:
                        index[free] = count
                    fx[count] = px
                    fy[count] = py
                    seen[count] = now
                    travel[count] = rolled
                    count += 1
        x += step_x
        y += step_y
        h += step_h
        i += 1
    state[_COUNT] = count


@micropython.viper
def clear_seen_past(
    distances: ptr16, n: int, state: ptr32, along: ptr16, across: ptr16, seen: ptr8, gone: ptr16,
    s0: int, c0: int, s1: int, c1: int, pa: int, qa: int, flip: int,
) -> int:  # fmt: skip
    """Find the points that the frame disproves: their numbers to gone[:_MOST_GONE]. Returns how many.

    along, across: the coordinates of the points along the way the sector looks (x or y, whichever comes nearer) and across it; pa, qa: the
    lidar's; flip: 0xFFFF where it looks to smaller ones, else 0. s0, c0 (* 2**10): inside the sector's first edge is where p s0 + q c0 >= 0, for
    p along and q across from the lidar; s1, c1: likewise inside the last.

    A point in the frame's sector is disproved when all beams that could have met it go more than a cell past it: all, for the tip of a corner is
    seen by few, and the body turns about it. One whose surface is now in a neighbour cell goes when the lidar has come round for it in vain. One
    behind something nearer, or inside the blind disc, is kept until the robot has rolled `keep` mm. No return, _VOID, disproves what is stale.

            first beam    last beam
                  \\ u   v //            along: the coordinate in which the sector points; its sign settles half of the points
                   \\  P //              u, v: how far P lies inside either edge; their ratio names the beam that looks at it
                    \\ | //   across
                     lidar ---->        P goes when the beams beside that one all end behind it
    """
    squares = ptr32(_SQUARES)
    shares = ptr16(_SHARES)
    now = state[_NOW]
    margin = (state[_CELL] >> 3) + 20
    count = state[_COUNT]
    found = 0
    pa -= _HALF
    qa -= _HALF
    # Coordinates relative to the body are taken with 2**15 added: it is cheaper to take their share off the products.
    first = (s0 + c0) << 15
    last = (s1 + c1) << 15
    k = 0
    while k < count:
        p = (along[k] - pa) & 0xFFFF
        if p ^ flip >= _HALF:
            # clockwise from the first beam and anticlockwise from the last: inside the sector
            q = (across[k] - qa) & 0xFFFF
            u = p * s0 + q * c0 - first
            v = -1
            if u >= 0:
                v = p * s1 + q * c1 - last
            if v >= 0:
                age = (now - seen[k]) & 0xFF
                u >>= 6
                v >>= 6
                if age and u + v:
                    i = u * (n - 1) // (u + v)
                    if state[_MIRRORED]:
                        i = n - 1 - i
                    # Nothing disproves it that is not farther than this in every beam, so most are done with the one in the middle.
                    beyond = 0 - margin
                    if age > state[_REVOLUTION]:
                        beyond = margin + 40
                    d = distances[i]
                    reach = (d >> 2) + beyond
                    if d and reach > 0:
                        rx = (p >> 3) - 4096
                        ry = (q >> 3) - 4096
                        r2 = rx * rx + ry * ry
                        if d == _VOID and (r2 < state[_BLIND] or age <= state[_DOZEN]):
                            reach = 0
                        if r2 < reach * reach:
                            disproved = 0
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
                            if clipped == 0 or age > state[_DOZEN]:
                                # Walls slope: the nearest beam and the farthest are mostly the first and the last.
                                lo = distances[j]
                                hi = distances[end - 1]
                                if hi < lo:
                                    lo = hi
                                    hi = distances[j]
                                past = (lo >> 2) - margin
                                if past > 0 and r2 < past * past:
                                    disproved = 1
                                    m = j + 1
                                    while m < end:
                                        # two a turn, the last one perhaps again
                                        if distances[m - 1] < lo or distances[m] < lo:
                                            lo = distances[m]
                                            if distances[m - 1] < lo:
                                                lo = distances[m - 1]
                                            past = (lo >> 2) - margin
                                            if past <= 0 or r2 >= past * past:
                                                disproved = 0
                                                m = end
                                        m += 2
                                if disproved == 0 and age > state[_REVOLUTION]:
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
                                        disproved = 1
                            if disproved and found < _MOST_GONE:
                                gone[found] = k
                                found += 1
        k += 1
    return found


@micropython.viper
def drop(state: ptr32, fx: ptr16, fy: ptr16, seen: ptr8, travel: ptr8, index: ptr16, gone: ptr16, found: int, due: int):
    """Take the points gone[:found] out of the memory (they rise), then of each _SHARE-th one up to `due` those too old or too far.

    From the last to the first: the last point of all moves to the place of one that goes, and is one that stays.
    """
    now = state[_NOW]
    far8 = state[_FAR]
    size = state[_CELL]
    x = state[_X] - _HALF
    y = state[_Y] - _HALF
    count = state[_COUNT]
    patience = (_CAPACITY - count) * 5 >> 1
    while found or due >= 0:
        if found:
            found -= 1
            k = gone[found]
        else:
            k = due
            due -= _SHARE
            if k >= count:
                continue
            age = (now - seen[k]) & 0xFF
            p = ((fx[k] - x) & 0xFFFF) - _HALF
            if p < 0:
                p = 0 - p
            q = ((fy[k] - y) & 0xFFFF) - _HALF
            if q < 0:
                q = 0 - q
            if p < q:
                p = q
            if p <= far8 and (state[_TRAVEL] - travel[k]) & 0xFF < state[_KEEP]:
                # Room runs out: the stalest goes, or there would be none for what is seen now. What the lidar is blind for goes last of all.
                q = patience
                if p <= state[_CLOSE] << 1:
                    q += _OLDEST - 2
                if count <= _CROWDED or age <= q:
                    if age > _OLDEST:
                        seen[k] = (now - _OLDEST) & 0xFF
                    continue
        count -= 1
        # In the index its name goes, and the last one takes on the place; which of both sizes of cell named them is not kept.
        point = k
        name = _NONE
        while True:
            mask = 255
            while mask >= 254:
                at = ((((fx[point] // size & mask) << 8) + (fy[point] // size & mask)) * 157 >> 5) & (_HASH - 1)
                probes = _PROBES
                while probes:
                    if index[at] == point:
                        index[at] = name
                        probes = 1
                        mask = 0
                    at = (at + 1) & (_HASH - 1)
                    probes -= 1
                mask -= 1
            if point == count:
                break
            point = count
            name = k
        fx[k] = fx[count]
        fy[k] = fy[count]
        seen[k] = seen[count]
        travel[k] = travel[count]
    state[_COUNT] = count


@micropython.viper
def view(reach: int, s: int, c: int, fx: ptr16, fy: ptr16, count: int, x: int, y: int, bx: ptr16, by: ptr16, every: int, shift: int) -> int:
    """Of the first `count` points each `every` one as seen from a pose (x, y, heading by sine and cosine * 2**14), those within reach: mm + 8192. Returns their number.

    shift: 14 where the points are in mm, 17 where they are in 1/8 mm; either modulo 2**16.
    """
    half = 1 << shift >> 1
    n = 0
    k = 0
    while k < count:
        px = (((fx[k] - x) & 0xFFFF) ^ _HALF) - _HALF
        py = (((fy[k] - y) & 0xFFFF) ^ _HALF) - _HALF
        qx = (px * c - py * s + half) >> shift
        qy = (px * s + py * c + half) >> shift
        if qx <= reach and qy <= reach and qx >= 0 - reach and qy >= 0 - reach:
            bx[n] = qx + _BODY_ZERO
            by[n] = qy + _BODY_ZERO
            n += 1
        k += every
    return n


class LocalMap:
    """The remembered points. `count` of them; `view()` gives them in the body frame.

    x, y: array('H') of their coordinates on the floor, 1/8 mm modulo 2**16; the first `count` count.
    state: array('i') whose places have names above, the count first
    keep: mm rolled before an unseen point is given up
    doubt: frames for which the robot is careful: a revolution after a lone reading in its lane; for more than that it stands, because something comes
    """

    def __init__(self, config):
        from perception.build import local_map

        local_map(self, config)

    @property
    def threatened(self):
        """Whether something that moves by itself has come near within the last frames."""
        return self.doubt > self._frames

    @property
    def count(self):
        return self.state[_COUNT]

    def frame(self, lidar, odometry):
        """Place one frame's points, measured while the body moved as odometry says, and drop those that it disproves.

        The pose is known for about now; the last point was measured a little before (it had to come down the wire) and the
        first a frame earlier. Over that time the motion of the last step is taken to go on.
        """
        n = lidar.n
        if n < 2:
            return
        state = self.state
        # The clock of the memory goes on, for as long as frames come.
        passed = ticks_diff(lidar.frame_us, self._frame_us)
        self._frame_us = lidar.frame_us
        if not 0 <= passed <= _LONGEST_US:
            passed = _LONGEST_US
        state[_TIME] = time = (state[_TIME] + passed) & 0x3FFFFF
        state[_NOW] = time >> 14
        if lidar.period_us != self._period_us:
            self._period_us = lidar.period_us
            revolution = self._frames * lidar.period_us
            state[_REVOLUTION] = revolution * 3 >> 15
            state[_DOZEN] = min(revolution * 12 >> 14, _OLDEST - 1)
        state[_TRAVEL] = (odometry.travel256 >> (8 + state[_UNIT])) & 0xFF
        # The times since the last point and from the first to it, in 16 us.
        late = ticks_diff(odometry.now_us, lidar.frame_us)
        if not -_LATEST_US <= late <= _LATEST_US:
            late = _LATE_US
        late >>= 4
        span = lidar.period_us >> 4
        heading = odometry.heading
        s = sin14(heading // 100)
        c = sin14(heading // 100 + 900)
        # Displacement on the floor in one step of odometry, 1/256 mm; far below 2**14.
        dx = (odometry.step_x * c + odometry.step_y * s) >> 14
        dy = (odometry.step_y * c - odometry.step_x * s) >> 14
        turned = odometry.step_heading * span // _STEP
        # From the body's centre to the lidar on the floor; at the first point it was turned by so much less, 18 / 2**20 of a radian a unit.
        lidar_x = (self._lidar_x * c + self._lidar_y * s) >> 11
        lidar_y = (self._lidar_y * c - self._lidar_x * s) >> 11
        x = odometry.x - dx * late // _STEP
        y = odometry.y - dy * late // _STEP
        state[_X] = x1 = ((x >> 5) + lidar_x) & 0xFFFF
        state[_Y] = y1 = ((y >> 5) + lidar_y) & 0xFFFF
        arc = turned * 18 >> 4
        x = (((x - dx * span // _STEP) >> 5) + lidar_x - (lidar_y * arc >> 16)) & 0xFFFF
        y = (((y - dy * span // _STEP) >> 5) + lidar_y + (lidar_x * arc >> 16)) & 0xFFFF
        first = (heading - odometry.step_heading * late // _STEP - turned) // 10 % 36000
        turned //= 10
        # Steps from point to point in 2**-13, and n of these units to start with: so rounding down hits what a division would give.
        insert(
            state, self.x, self.y, self._index, lidar.bearings, lidar.distances, n, self._seen, self._travel,
            (x << 13) + n, (y << 13) + n, ((first + 5) << 13) + n,
            ((((x1 - x) & 0xFFFF ^ _HALF) - _HALF) << 13) // n, ((((y1 - y) & 0xFFFF ^ _HALF) - _HALF) << 13) // n, (turned << 13) // n,
        )  # fmt: skip
        if self.doubt:
            self.doubt -= 1
        if lidar.intruder:
            self.doubt = self._frames * (1 + _STAND)
        if lidar.lone:
            self._weigh(lidar, lidar.lone - 1, heading, odometry.step_y)
        # Nothing returned is evidence where most does, or where the robot has been told so.
        if self._open or lidar.returned << 1 > n:
            distances = lidar.distances
            for k in range(n):
                if not distances[k]:
                    distances[k] = _VOID
        self._clear(lidar, n, (first + turned) // 10)

    def _weigh(self, lidar, at, heading, ahead):
        """A beam has met alone what was not known. If one met the same not long ago, it is there; until then the robot is careful."""
        state = self.state
        y, d = self._one
        b = lidar.bearings[at]
        d[0] = far = lidar.lone_range
        right = far * sin14(b) >> 16
        front = far * sin14(b + 900) >> 16
        if abs(right) < self._lane and 0 < (front if ahead > 0 else -front) < self._ahead and ahead:
            self.doubt = max(self.doubt, self._frames)
        b = heading // 100 + b
        now = state[_TIME] >> 14
        px = state[_X] + (far * sin14(b) >> 13) & 0xFFFF
        py = state[_Y] + (far * sin14(b + 900) >> 13) & 0xFFFF
        lone = self._lones
        for k in range(0, _LONES, 3):
            if lone[k] + _SAME - px & 0xFFFF <= 2 * _SAME and lone[k + 1] + _SAME - py & 0xFFFF <= 2 * _SAME and 2 < now - lone[k + 2] & 0xFF < _SOON:
                y[0] = b % 3600
                insert(
                    state, self.x, self.y, self._index, y, d, 1, self._seen, self._travel,
                    (state[_X] << 13) + 1, (state[_Y] << 13) + 1, 1, 0, 0, 0,
                )  # fmt: skip
                break
        k = self._next_lone
        lone[k] = px
        lone[k + 1] = py
        lone[k + 2] = now
        self._next_lone = (k + 3) % _LONES

    def _clear(self, lidar, n, heading):
        """Drop what the frame sees past, and what is too old or too far. heading: at the last point, 0.1 deg."""
        state = self.state
        first = heading + lidar.bearings[0]
        last = heading + lidar.bearings[n - 1]
        s0 = sin14(first) >> 4
        c0 = sin14(first + 900) >> 4
        s1 = sin14(last) >> 4
        c1 = sin14(last + 900) >> 4
        mirrored = s1 * c0 < c1 * s0
        if mirrored:
            s0, s1 = s1, s0
            c0, c1 = c1, c0
        state[_MIRRORED] = mirrored
        seen = self._seen
        gone = self._gone
        s = s0 + s1
        c = c0 + c1
        if s * s > c * c:
            s = 0xFFFF if s < 0 else 0
            found = clear_seen_past(lidar.distances, n, state, self.x, self.y, seen, gone, c0, -s0, -c1, s1, state[_X], state[_Y], s)
        else:
            c = 0xFFFF if c < 0 else 0
            found = clear_seen_past(lidar.distances, n, state, self.y, self.x, seen, gone, -s0, c0, s1, -c1, state[_Y], state[_X], c)
        self._due = due = (self._due + 1) & (_SHARE - 1)
        due += (state[_COUNT] - 1 - due) & -_SHARE  # the last of its kind
        drop(state, self.x, self.y, seen, self._travel, self._index, gone, found, due)

    def view(self, x, y, heading, bx, by, reach):
        """Fill bx, by (array 'H', mm + 8192, body frame) with the points within reach mm; returns their number.

        x, y, heading: the body, 1/8 mm and 0.1 deg.
        """
        return view(reach, sin14(heading), cos14(heading), self.x, self.y, self.state[_COUNT], x & 0xFFFF, y & 0xFFFF, bx, by, 1, 17)
