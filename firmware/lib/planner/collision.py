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
_NEVER = const(15000)  # a half angle of more than 61 degrees, of which the tangent times 2**13 is this


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
def _stop_at_outline(px: ptr16, py: ptr16, job: ptr32, a: int, b: int, ref: int) -> int:
    """How far a candidate may be driven for the points near the outline, for which the tables are too coarse: job[_LENGTH], job[_SOFT_LENGTH].

    (a, b): of an arc the centre, of a strip its direction; ref: travel for a radian, of a strip the length of (a, b). Returns the index of the point that stops it,
    65535 if none does. A point may come up to the margin; one that is nearer than that, 2 mm nearer, and one nearer than half of it hardly at all.

    The side that a point faces comes nearer to it, in a turn w about the centre, by rate sin w + bend (1 - cos w). With t = tan(w / 2), here * 2**13, it has come
    nearer by d when (2 bend - d) t^2 + 2 rate t = d; of the two roots this is the first at which it comes nearer, for d < 0 the one at which it comes back. The point is
    met when it is within both sides that it faces. The one that it is farther from comes first; then the other, if it is not, or will not be then, within that.
    """
    job[_LENGTH] = job[_SOFT_LENGTH] = job[_LOOK_AHEAD]
    block = _NONE
    i = 0
    while i < job[_NEAR]:
        x = px[i] - 8192
        y = py[i] - 8192
        bend = 0
        bend_y = 0
        rate = a
        rate_y = b
        if job[_ARC]:
            bend = px[i] - a
            bend_y = py[i] - b
            rate = bend_y
            rate_y = 0 - bend
        if x < 0:
            x = 0 - x
            rate = 0 - rate
            bend = 0 - bend
        if y < 0:
            y = 0 - y
            rate_y = 0 - rate_y
            bend_y = 0 - bend_y
        deep = job[_HALF_LENGTH]
        x = (x - job[_HALF_WIDTH]) << 3  # 1/8 mm
        y = (y - deep) << 3
        if y > x:
            deep = job[_HALF_WIDTH]
            h = x
            x = y
            y = h
            h = rate
            rate = rate_y
            rate_y = h
            h = bend
            bend = bend_y
            bend_y = h
        k = 0
        while k < 2:
            margin = job[_MARGIN + k] << 3
            d = x - margin
            if d < 16:
                d = 16
                if x + x < margin:
                    d = 1
            # What the length allows is not enough to come so near: rate w + bend w^2 / 2 at most.
            length = job[_LENGTH + k]
            most = (length << 12) // ref + 1
            e = bend
            if bend < 0:
                e = 0
            t = 0
            if (rate + (e * most >> 13)) * most >> 9 < d:
                t = _NEVER
            h = rate
            e = bend
            other = 0
            while t < _NEVER:
                root = ((e << 4) - d) * d >> 6
                n = h
                if h < 0:
                    n = 0 - h
                n += 32  # the root is less
                if root > 0:
                    n += root >> 7
                root += h * h + 1
                if root <= 0 or (h < 0 and e << 4 <= d):
                    t = _NEVER
                    break
                r = n + 1
                while n < r:
                    r = n
                    n = (r + root // r) >> 1
                if h < 0:
                    r = ((r - h) << 13) // ((e << 4) - d) << 3
                else:
                    r = (d << 10) // (h + r)
                if r > t:
                    t = r
                if other:
                    break
                other = 1
                d += y - x
                h = rate_y
                e = bend_y
                if d <= 0:
                    r = ((h + (e * t >> 13)) * t << 1) // (1024 + (t * t >> 16))
                    if r >= d:
                        if r > d + (deep << 4) + margin + margin:
                            t = _NEVER  # past, on the other side
                        break
                    if d < -2000:
                        d = -2000
            # The travel: 2 arc tangents, a little less.
            if t < _NEVER:
                t = ((t * ref >> 12) << 10) // (1024 + ((t * t >> 13) * 307 >> 13))
                if t < length:
                    job[_LENGTH + k] = t
                    if k == 0:
                        block = i
            k += 1
        i += 1
    return block


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
        # Squares of the radii between which the outline passes, first with the soft margin round it, then with the margin; xc > 0.
        r2_in = r2_out = 0
        i = 2
        while i > 0:
            i -= 1
            in_soft = r2_in
            out_soft = r2_out
            ax = xc - 8192
            ay = yc - 8192
            if ay < 0:
                ay = 0 - ay
            x = job[_MARGIN + i] + job[_HALF_WIDTH]
            y = job[_MARGIN + i] + job[_HALF_LENGTH]
            r2_out = (ax + x) * (ax + x) + (ay + y) * (ay + y) + 1
            ax -= x
            if ax < 0:
                ax = 0
            ay -= y
            if ay < 0:
                ay = 0
            r2_in = ax * ax + ay * ay
        # Bins are even in the square of the distance: (d2 - r2_in >> shift) * scale >> 12 = bin in 1/256, with both factors below 2**15.
        shift = 0
        while r2_out - r2_in >> shift >= 32768:
            shift += 1
        scale = (_BINS << 20) // (r2_out - r2_in >> shift)
        length = job[_LOOK_AHEAD]
        soft_length = length
        block = _NONE
        if near:
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
            while i >= near:
                # Ray from the centre along the body's front after `limit`, sine and cosine * 2**10; none where half a turn is too little.
                ray_s = 0
                ray_c = 0
                phi = front - limit
                if phi > 16384:
                    phi = ((phi * 225) >> 14) - 225  # 0.4 deg, as the table's steps: rounded down, which leaves in a point too many
                    ax = 225 - phi
                    if phi > 225:
                        phi = 450 - phi
                        ax = 0 - ax
                    ray_c = 0 - (sine[phi] >> 6)
                    ray_s = sine[225 - phi] >> 6
                    if ax < 0:
                        ray_s = 0 - ray_s
                while i >= near:
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
                                i = near
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
            block = int(_stop_at_outline(points_x, points_y, jobs, s >> 1, c >> 1, 8192))
            length = job[_LENGTH]
            soft_length = job[_SOFT_LENGTH]
        length = length << 4
        soft_length = soft_length << 4
        i = job[_NEAR]
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
