"""How far the body goes along each candidate steering before a point stops it: the tests that run in the loop.

A point at distance d from the turning centre is met when the ring of radius d, followed against the turn, leads from the point into the
body's outline. Where that happens depends on d alone and stands in the tables of candidates.py; a test is one squared distance, and for the
few points inside the ring, and not beyond where the body is stopped already, an arc tangent and a look-up. With the centre at
infinity (straight and crab) the ring is a strip and the outline two slopes.

Coordinates: body frame, mm + 8192 (never negative). Lengths: travel of the fastest wheel, mm.
"""

import micropython
from micropython import const

from core.trig import SIN

# Fields of the job: what to test against what, in mm.
_NEAR = const(0)  # points near the outline, which come first
_COUNT = const(1)  # all points
_FIRST = const(2)  # candidates
_LAST = const(3)
_STRIDE = const(4)
_FLOOR = const(5)
_ARC = const(6)  # 1 for arcs, 0 for strips
_LENGTH = const(7)  # what _stop_at_outline() finds
_SOFT_LENGTH = const(8)
_HALF_WIDTH = const(9)
_HALF_LENGTH = const(10)
_MARGIN = const(11)
_SOFT = const(12)  # behind the margin
_LOOK_AHEAD = const(13)
_ARCS = const(14)
_BAND = const(15)  # how far beyond the margin the near points are looked at one by one, 1/8 mm

_INNER = const(16)  # square mm, what _rings() finds: two each
_OUTER = const(18)

# Fields of an arc's constants, 16-bit words: candidate_tables.py
_ARC_STRIDE = const(8)
_XC = const(0)
_YC = const(1)
_TURN_MM = const(2)
_REF = const(4)
_FRONT = const(5)
_SECOND = const(6)
_SECOND_BINS = const(7)

_BINS = const(16)
_FARTHEST = const(60000)  # turn, of 65536
_NONE = const(65535)


@micropython.viper
def drop_behind(n: int, px: ptr16, py: ptr16, near: int, limit: int, left: int) -> int:
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
    while n > 0:
        n -= 1
        p[n] = 16384 - p[n]


@micropython.viper
def move(reach: int, s: int, c: int, px: ptr16, py: ptr16, n: int, x: int, y: int, qx: ptr16, qy: ptr16, every: int) -> int:
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
def _stop_at_outline(px: ptr16, py: ptr16, job: ptr32, a: int, b: int, ref: int) -> int:
    """How far a candidate may be driven for the points near the outline, which the tables are too coarse for: job[_LENGTH], job[_SOFT_LENGTH].

    The side of the outline that is nearest to a point comes towards it at a rate: for an arc the point's distance from the centre (a, b), for a strip its
    direction's part (a, b); `ref` mm of travel bring it nearer by that. Returns the index of the point that stops it, 65535 if none does.
    """
    near = job[_NEAR]
    arc = job[_ARC]
    margin = job[_MARGIN]
    soft_margin = job[_SOFT]
    length = job[_LENGTH]
    soft_length = job[_SOFT_LENGTH]
    block = _NONE
    i = 0
    while i < near:
        ax = px[i] - 8192
        ay = py[i] - 8192
        rate = a
        rate_y = b
        if arc:
            rate = ay + 8192 - b
            rate_y = a - ax - 8192
        if ax < 0:
            ax = 0 - ax
            rate = 0 - rate
        if ay < 0:
            ay = 0 - ay
            rate_y = 0 - rate_y
        gap = ax - job[_HALF_WIDTH]
        gap_y = ay - job[_HALF_LENGTH]
        # Off a corner on both sides the point is passed, or the table meets it.
        aside = 0
        if gap >= margin and gap_y >= margin:
            aside = arc
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
            if aside == 0 and allowed < job[_BAND]:
                allowed = allowed * ref
                if allowed < (length * rate) << 3 * arc:
                    length = (allowed // rate) >> 3 * arc
                    block = i
            allowed = gap - soft_margin
            if allowed < 2:
                allowed = 2
            allowed = allowed * ref
            if allowed < soft_length * rate:
                soft_length = allowed // rate
        i += 1
    job[_LENGTH] = length
    job[_SOFT_LENGTH] = soft_length
    return block


@micropython.viper
def _rings(job: ptr32, x: int, y: int):
    """Squares of the radii between which the outline passes when the body turns about x > 0, y (mm): job[_INNER], job[_OUTER], of two each.

    The first of the two with the margin round the outline, the second with the soft margin.
    """
    if y < 0:
        y = 0 - y
    i = 0
    while i < 2:
        across = job[_MARGIN + i] + job[_HALF_WIDTH]
        along = job[_MARGIN + i] + job[_HALF_LENGTH]
        job[_OUTER + i] = (x + across) * (x + across) + (y + along) * (y + along) + 1
        across = x - across
        if across < 0:
            across = 0
        along = y - along
        if along < 0:
            along = 0
        job[_INNER + i] = across * across + along * along
        i += 1


@micropython.viper
def _sweep_arcs(consts: ptr16, jobs, points_x, points_y, table: ptr16, seconds: ptr16, free: ptr16, soft: ptr16, blocker: ptr16):
    """Free length of the arc candidates job[_FIRST]..job[_LAST]-1 against the points.

    free: mm until a point comes within the margin (a point already nearer may come 2 mm nearer);
    soft: the same with the wider, soft margin; blocker: index of the point that ends it, 65535 none.
    A candidate found to be shorter than job[_FLOOR] is given up at once.

    Angles are 1/65536 turn. `limit` is how far the body may turn; it shrinks point by point. A point is left out as soon as it is known not to matter: outside the
    ring; or beyond the ray from the centre along the body's front when it has turned by `limit`; else its bin of the table says at which angle its ring enters the outline.

    All in one function: a call takes about 1200 instructions (host/bench/costs.py), several times what a point takes here, and each point would need it.
    """
    px = ptr16(points_x)
    py = ptr16(points_y)
    job = ptr32(jobs)
    slopes = ptr8(table)
    sine = ptr16(SIN)
    last_block = _NONE
    near = job[_NEAR]
    n = job[_COUNT]
    k = job[_FIRST]
    while k < job[_LAST]:
        base = k * _ARC_STRIDE
        xc = consts[base + _XC]
        yc = consts[base + _YC]
        turn_mm = consts[base + _TURN_MM] | consts[base + _TURN_MM + 1] << 16
        front = consts[base + _FRONT]
        second = consts[base + _SECOND]
        second_bins = consts[base + _SECOND_BINS]
        slope_shift = second_bins >> 10
        second_bin = second_bins >> 5 & 31
        second_bins = second_bins & 31
        _rings(jobs, xc - 8192, yc - 8192)
        r2_in = job[_INNER]
        in_soft = job[_INNER + 1]
        r2_out = job[_OUTER]
        out_soft = job[_OUTER + 1]
        # Bins are even in the square of the distance: (d2 - r2_in >> shift) * scale >> 12 = bin in 1/256, with both factors below 2**15.
        shift = 0
        while r2_out - r2_in >> shift >= 32768:
            shift += 1
        scale = (_BINS << 20) // (r2_out - r2_in >> shift)
        length = job[_LOOK_AHEAD]
        soft_length = length
        block = _NONE
        if near:
            job[_LENGTH] = length
            job[_SOFT_LENGTH] = length
            block = int(_stop_at_outline(points_x, points_y, jobs, xc, yc, int(consts[base + _REF])))
            length = job[_LENGTH]
            soft_length = job[_SOFT_LENGTH]
        limit = (length << 16) // turn_mm
        if limit > _FARTHEST:
            limit = _FARTHEST
        soft_limit = (soft_length << 16) // turn_mm
        if soft_limit > limit:
            soft_limit = limit
        bottom = (job[_FLOOR] << 16) // turn_mm
        if limit >= bottom:
            row = k * (3 * _BINS >> 1)
            slope = k * (3 * _BINS) + 2 * _BINS
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
                    phi = ((phi * 225) >> 12) - 900  # 0.1 deg
                    ax = 0
                    if phi > 900:
                        phi = 1800 - phi
                        ax = 1
                    ray_c = sine[phi >> 2]
                    ray_c = 0 - ((ray_c + ((sine[(phi >> 2) + 1] - ray_c) * (phi & 3) >> 2)) >> 6)
                    phi = 900 - phi
                    ray_s = sine[phi >> 2]
                    ray_s = (ray_s + ((sine[(phi >> 2) + 1] - ray_s) * (phi & 3) >> 2)) >> 6
                    if ax:
                        ray_s = 0 - ray_s
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
                        # Arc tangent: a polynomial in the ratio of the shorter side to the longer one, * 2**12; off by 1/65536 turn at most.
                        if ax >= ay:
                            e = ((ay << 12) + (ax >> 1)) // ax
                        else:
                            e = ((ax << 12) + (ay >> 1)) // ay
                        h = e * e >> 12
                        phi = (e * (10422 - (h * (3350 - (h * (1526 - (h * 407 >> 12)) >> 12)) >> 12)) + 2048) >> 12
                        if ax < ay:
                            phi = 16384 - phi
                        if dx < 0:
                            phi = 32768 - phi
                        if dy < 0:
                            phi = 65536 - phi
                        pos = d2 - r2_in
                        if pos < 0:
                            pos = 0
                        pos = ((pos >> shift) * scale) >> 12  # bin in 1/256
                        if pos > _BINS * 256 - 1:
                            pos = _BINS * 256 - 1
                        bin = pos >> 8
                        pos = pos & 255
                        e = ((slopes[slope + bin] ^ 128) - 128) << slope_shift
                        h = (table[row + bin] + ((e * pos) >> 8) - phi) & 0xFFFF
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
        k += job[_STRIDE]


@micropython.viper
def _sweep_strips(strips: ptr32, jobs, points_x, points_y, free: ptr16, soft: ptr16, blocker: ptr16):
    """As _sweep_arcs, for straight and crab candidates; results follow those of the arcs (index job[_FIRST]..)."""
    px = ptr16(points_x)
    py = ptr16(points_y)
    job = ptr32(jobs)
    n = job[_COUNT]
    k = job[_FIRST]
    while k < job[_LAST]:
        base = (k - job[_ARCS]) * 8
        s = strips[base]
        c = strips[base + 1]
        half = strips[base + 2]  # half width of the strip, 1/16 mm
        half_soft = strips[base + 3]
        corner_q = strips[base + 4] - 131072  # of the leading corner, 1/16 mm
        corner_l = strips[base + 5]
        slope_front = strips[base + 6]  # 1/1024
        slope_side = strips[base + 7]
        length = job[_LOOK_AHEAD]
        soft_length = length
        block = _NONE
        if job[_NEAR]:
            job[_LENGTH] = length
            job[_SOFT_LENGTH] = length
            block = int(_stop_at_outline(points_x, points_y, jobs, s, c, 16384))
            length = job[_LENGTH]
            soft_length = job[_SOFT_LENGTH]
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
        k += 1


class CollisionCheck:
    """The tests of the candidates of some Candidates: prepare() for the points, then check() candidates."""

    def __init__(self, candidates):
        from planner.parts import collision

        collision(self, candidates)

    def prepare(self, n, near, stride, floor):
        """What several check() have in common: n points, those near the outline first (`near` of them, see perception/windows.py); each stride-th of the arcs is
        tested, and those shorter than floor mm are given up early."""
        job = self._job
        job[_NEAR] = near
        job[_COUNT] = n
        job[_STRIDE] = stride
        job[_FLOOR] = floor

    def check(self, px, py, first, last, free, soft, block):
        """Free length, soft free length (mm) and blocking point of the candidates first..last-1 against the points px, py, as prepared."""
        candidates = self._candidates
        job = self._job
        arcs = candidates.arcs
        if first < arcs:
            job[_FIRST] = first
            job[_LAST] = last if last < arcs else arcs
            job[_ARC] = 1
            _sweep_arcs(candidates.consts, job, px, py, candidates.table, candidates.seconds, free, soft, block)
        if last > arcs:
            job[_FIRST] = first if first > arcs else arcs
            job[_LAST] = last
            job[_ARC] = 0
            _sweep_strips(candidates.strips, job, px, py, free, soft, block)
