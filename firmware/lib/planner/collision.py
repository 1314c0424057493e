"""How far the body goes along each candidate steering before a point stops it: the tests that run in the loop.

A point at distance d from the turning centre is met when the ring of radius d, followed against the turn, leads from the point into the
body's outline. Where that happens depends on d alone and stands in the tables of envelope.py; a test is one squared distance, and for the
few points inside the ring, and not beyond where the body is stopped already, an arc tangent and a look-up. With the centre at
infinity (straight and crab) the ring is a strip and the outline two slopes.

Coordinates: body frame, mm + 8192 (never negative). Lengths: travel of the fastest wheel, mm.
"""

from array import array
from math import atan, pi

import micropython
from micropython import const

from core.trig import SIN
from perception.windows import BAND_MM

# Fields of the job: what to test against what.
_NEAR = const(0)
_COUNT = const(1)
_FIRST = const(2)
_LAST = const(3)
_HALF_WIDTH = const(4)
_HALF_LENGTH = const(5)
_MARGIN = const(6)
_CAP = const(7)
_FLOOR = const(8)
_FIRST_STRIP = const(9)
_STRIDE = const(10)
_SOFT = const(11)
_BAND = const(12)
_JOB_FIELDS = const(13)


def _table(size, of):
    """array('H') of of(0), of(1), ..., rounded; filled in place, for a list in between would need four times the room."""
    table = array("H", bytes(2 * size))
    for i in range(size):
        table[i] = int(of(i) + 0.5)
    return table


# arc tangent of 0..1 in 1/512, unit 1/65536 turn
ATAN = _table(513, lambda i: atan(i / 512) * 32768 / pi)
del _table


@micropython.viper
def drop_behind(px: ptr16, py: ptr16, near: int, n: int, limit: int, left: int) -> int:
    """Bring the points more than limit mm behind the centre, or left mm to its left, to the end; returns how many remain before them.

    On a forward candidate every part of the body moves forward, so nothing behind its rear can be met; and on one that turns
    right the tail swings out to the left by less than a quarter of the body's length.
    """
    low = 8192 - limit
    side = 8192 - left
    i = near
    while i < n:
        y = py[i]
        if y < low or px[i] < side:
            n -= 1
            py[i] = py[n]
            py[n] = y
            x = px[i]
            px[i] = px[n]
            px[n] = x
        else:
            i += 1
    return n


@micropython.viper
def mirror(p: ptr16, n: int):
    """Change the sign of biased coordinates, in place."""
    i = 0
    while i < n:
        p[i] = 16384 - p[i]
        i += 1


@micropython.viper
def move(px: ptr16, py: ptr16, n: int, x: int, y: int, s: int, c: int, reach: int, qx: ptr16, qy: ptr16, every: int) -> int:
    """The points as seen from a pose (x, y mm, heading by sine and cosine * 2**14), those within reach mm; of each `every` one."""
    m = 0
    i = 0
    while i < n:
        dx = px[i] - 8192 - x
        dy = py[i] - 8192 - y
        u = (dx * c - dy * s + 8192) >> 14
        v = (dx * s + dy * c + 8192) >> 14
        if u < reach and v < reach and u > 0 - reach and v > 0 - reach:
            qx[m] = u + 8192
            qy[m] = v + 8192
            m += 1
        i += every
    return m


@micropython.viper
def _sweep_arcs(px: ptr16, py: ptr16, job: ptr32, consts: ptr32, table: ptr16, seconds: ptr16, free: ptr16, soft: ptr16, blocker: ptr16):
    """Free length of the arc candidates job[_FIRST]..job[_LAST]-1 against the points.

    free: mm until a point comes within the margin (a point already nearer may come 2 mm nearer);
    soft: the same with the wider, soft margin; blocker: index of the point that ends it, 65535 none.
    A candidate found to be shorter than job[_FLOOR] is given up at once.
    """
    atan = ptr16(ATAN)
    sine = ptr16(SIN)
    last_block = 65535
    near = job[0]
    n = job[1]
    k = job[2]
    last = job[3]
    half_width = job[4]
    half_length = job[5]
    margin = job[6]
    cap = job[7]
    floor = job[8]
    stride = job[10]
    soft_margin = job[11]
    band = job[12] << 3
    while k < last:
        base = k * 13
        xc = consts[base]
        yc = consts[base + 1]
        in_soft = consts[base + 2]
        out_soft = consts[base + 3]
        r2_in = consts[base + 4]
        r2_out = consts[base + 5]
        shift = consts[base + 6]
        scale = consts[base + 7]
        turn_mm = consts[base + 9]
        ref = consts[base + 10]
        second = consts[base + 11]
        front = consts[base + 12]
        second_bin = (second >> 5) & 31
        second_bins = second & 31
        second = second >> 10
        length = cap
        soft_length = cap
        block = 65535
        # Points at the outline: how fast does the nearest side of the body come towards them?
        i = 0
        while i < near:
            x = px[i]
            y = py[i]
            ax = x - 8192
            rate = y - yc
            if ax < 0:
                ax = 0 - ax
                rate = 0 - rate
            ay = y - 8192
            rate_y = xc - x
            if ay < 0:
                ay = 0 - ay
                rate_y = 0 - rate_y
            gap = ax - half_width
            gap_y = ay - half_length
            # Off a corner on both sides the point is passed, or the table meets it.
            aside = 0
            if gap >= margin and gap_y >= margin:
                aside = 1
                if gap >= soft_margin and gap_y >= soft_margin:
                    rate = 0
                    rate_y = 0
            if gap_y > gap:
                gap = gap_y
                rate = rate_y
            if rate > 0:
                # 1/8 mm: what is nearer than the margin may come 2 mm nearer, what is nearer than half of it hardly at all
                allowed = (gap - margin) << 3
                if allowed < 16:
                    allowed = 16
                    if gap + gap < margin:
                        allowed = 3
                        if gap < 3:
                            allowed = 1
                if aside == 0 and allowed < band and allowed * ref < (length * rate) << 3:
                    length = (allowed * ref // rate) >> 3
                    block = i
                allowed = gap - soft_margin
                if allowed < 2:
                    allowed = 2
                if allowed * ref < soft_length * rate:
                    soft_length = allowed * ref // rate
            i += 1
        limit = (length << 16) // turn_mm
        if limit > consts[base + 8]:
            limit = consts[base + 8]
        soft_limit = (soft_length << 16) // turn_mm
        if soft_limit > limit:
            soft_limit = limit
        bottom = (floor << 16) // turn_mm
        if limit >= bottom:
            row = k * 48
            # What stopped the candidate before is likely to stop this one: it comes first, and what lies beyond need not be looked at.
            i = n - 1
            if last_block < i and last_block >= near:
                x = px[last_block]
                px[last_block] = px[i]
                px[i] = x
                x = py[last_block]
                py[last_block] = py[i]
                py[i] = x
            while i >= 0:
                # Ray from the centre along the body's front after `limit`, sine and cosine * 2**10; none where half a turn is too little.
                ray_s = 0
                ray_c = 0
                phi = front - limit
                if phi > 16384:
                    phi = (phi * 225) >> 12  # 0.1 deg
                    if phi <= 1800:
                        ray_c = 0 - (sine[phi - 900] >> 6)
                        ray_s = sine[1800 - phi] >> 6
                    else:
                        ray_c = 0 - (sine[2700 - phi] >> 6)
                        ray_s = 0 - (sine[phi - 1800] >> 6)
                while i >= 0:
                    dx = px[i] - xc
                    dy = py[i] - yc
                    d2 = dx * dx + dy * dy
                    if d2 <= in_soft:
                        i -= 1
                        continue
                    if d2 >= out_soft:
                        i -= 1
                        continue
                    if ray_c * dy >= ray_s * dx:
                        ax = dx
                        if dx < 0:
                            ax = 0 - dx
                        ay = dy
                        if dy < 0:
                            ay = 0 - dy
                        if ax >= ay:
                            phi = atan[((ay << 9) + (ax >> 1)) // ax]
                        else:
                            phi = 16384 - atan[((ax << 9) + (ay >> 1)) // ay]
                        if dx < 0:
                            phi = 32768 - phi
                        if dy < 0:
                            phi = 65536 - phi
                        # bins are even in the square of the distance: no root is needed
                        pos = d2 - r2_in
                        if pos < 0:
                            pos = 0
                        pos = ((pos >> shift) * scale) >> 12  # bin in 1/256
                        if pos > 6143:
                            pos = 6143
                        bin = pos >> 8
                        pos = pos & 255
                        j = row + bin + bin
                        e = table[j]
                        h = (e + (((table[j + 1] - e) * pos) >> 8) - phi) & 0xFFFF
                        bin -= second_bin
                        if bin >= 0 and bin < second_bins:
                            # the ring enters the outline a second time
                            j = second + bin + bin
                            e = seconds[j]
                            e = (e + (((seconds[j + 1] - e) * pos) >> 8) - phi) & 0xFFFF
                            if e < h:
                                h = e
                        if h < soft_limit:
                            soft_limit = h
                        if h < limit and d2 > r2_in and d2 < r2_out:
                            limit = h
                            block = i
                            if limit < bottom:
                                i = 0
                            break
                    i -= 1
                i -= 1
            last_block = block
        free[k] = (limit * turn_mm) >> 16
        soft[k] = (soft_limit * turn_mm) >> 16
        blocker[k] = block
        k += stride


@micropython.viper
def _sweep_strips(px: ptr16, py: ptr16, job: ptr32, strips: ptr32, free: ptr16, soft: ptr16, blocker: ptr16):
    """As _sweep_arcs, for straight and crab candidates; results follow those of the arcs (index job[_FIRST]..)."""
    near = job[0]
    n = job[1]
    k = job[2]
    last = job[3]
    half_width = job[4]
    half_length = job[5]
    margin = job[6]
    first = job[9]
    stride = job[10]
    soft_margin = job[11]
    band = job[12] << 3
    while k < last:
        base = (k - first) * 8
        s = strips[base]
        c = strips[base + 1]
        half = strips[base + 2]  # half width of the strip, 1/16 mm
        half_soft = strips[base + 3]
        corner_q = strips[base + 4] - 131072  # of the leading corner, 1/16 mm
        corner_l = strips[base + 5]
        slope_front = strips[base + 6]  # 1/1024
        slope_side = strips[base + 7]
        length = job[7]
        soft_length = length
        block = 65535
        i = 0
        while i < near:
            ax = px[i] - 8192
            rate = s
            if ax < 0:
                ax = 0 - ax
                rate = 0 - rate
            ay = py[i] - 8192
            rate_y = c
            if ay < 0:
                ay = 0 - ay
                rate_y = 0 - c
            gap = ax - half_width
            gap_y = ay - half_length
            if gap >= soft_margin and gap_y >= soft_margin:
                rate = 0
                rate_y = 0
            if gap_y > gap:
                gap = gap_y
                rate = rate_y
            if rate > 0:
                # 1/8 mm: what is nearer than the margin may come 2 mm nearer, what is nearer than half of it hardly at all
                allowed = (gap - margin) << 3
                if allowed < 16:
                    allowed = 16
                    if gap + gap < margin:
                        allowed = 3
                        if gap < 3:
                            allowed = 1
                if allowed < band and (allowed << 14) < length * rate:
                    length = (allowed << 14) // rate
                    block = i
                allowed = gap - soft_margin
                if allowed < 2:
                    allowed = 2
                if (allowed << 14) < soft_length * rate:
                    soft_length = (allowed << 14) // rate
            i += 1
        length = length << 4
        soft_length = soft_length << 4
        i = 0
        while i < n:
            x = px[i] - 8192
            y = py[i] - 8192
            q = (x * c - y * s) >> 10  # 1/16 mm
            if q < half_soft and q > 0 - half_soft:
                reach = ((x * s + y * c) >> 10) - corner_l
                if q < corner_q:
                    reach += ((corner_q - q) * slope_front) >> 10
                else:
                    reach += ((q - corner_q) * slope_side) >> 10
                if reach >= 0:
                    if reach < soft_length:
                        soft_length = reach
                    if reach < length and q < half and q > 0 - half:
                        length = reach
                        block = i
            i += 1
        free[k] = length >> 4
        soft[k] = soft_length >> 4
        blocker[k] = block
        k += stride


class CollisionCheck:
    """The tests of the candidates of some Candidates."""

    def __init__(self, candidates):
        self._candidates = candidates
        self._job = array("i", [0] * _JOB_FIELDS)

    def prepare(self, n, near, stride, floor):
        """What several check() have in common: n points, those near the outline first (`near` of them, see perception/windows.py); of the arcs each
        stride-th, given up early if shorter than floor mm."""
        env = self._candidates
        job = self._job
        job[_NEAR] = near
        job[_COUNT] = n
        job[_HALF_WIDTH] = env.half_width
        job[_HALF_LENGTH] = env.half_length
        job[_MARGIN] = env.margin
        job[_CAP] = env.look_ahead
        job[_FLOOR] = floor
        job[_STRIDE] = stride
        job[_SOFT] = env.soft
        job[_BAND] = BAND_MM
        job[_FIRST_STRIP] = env.arcs

    def check(self, px, py, first, last, free, soft, block):
        """Free length, soft free length and blocking point of the candidates first..last-1, as prepared. px, py: the points."""
        env = self._candidates
        job = self._job
        arcs = env.arcs
        if first < arcs:
            job[_FIRST] = first
            job[_LAST] = last if last < arcs else arcs
            _sweep_arcs(px, py, job, env.consts, env.table, env.seconds, free, soft, block)
        if last > arcs:
            job[_FIRST] = first if first > arcs else arcs
            job[_LAST] = last
            job[_STRIDE] = 1
            _sweep_strips(px, py, job, env.strips, free, soft, block)
