"""Trajectory envelopes: how far the whole body can go along one steering before it touches a point.

Turning about a fixed centre C, the body sweeps a ring sector: a point at distance d from C is met when the ring of
radius d, followed against the turn, leads from the point into the body's outline. Where that happens depends on d
alone, so for every candidate steering a table over d holds the angle(s) at which its ring enters the outline; a test
is then one squared distance, and for the few points inside the ring a square root, an arc tangent and a look-up.
With the centre at infinity (straight and crab) the ring is a strip and the outline two slopes.

Only forward candidates that turn right are tabulated. Left is the same test on points mirrored in x, backward on
points mirrored in y, so a mirrored course gives mirrored answers by construction.

Source: papers A section 4.2 and B section 3.2-3.3; the point rule (24) replaced by the whole swept body.
Coordinates: body frame, mm + 8192 (never negative). Lengths: travel of the fastest wheel, mm.
"""

from array import array
from math import atan, atan2, cos, pi, sin, sqrt, tan

import micropython
from micropython import const

BIAS = const(8192)
BINS = const(24)
LENGTHS = const(5)
_STRIDE = const(12)

# Fields of a candidate's constants.
_XC = const(0)
_YC = const(1)
_IN_SOFT = const(2)
_OUT_SOFT = const(3)
_IN = const(4)
_OUT = const(5)
_R_IN = const(6)
_BIN_SCALE = const(7)
_ANGLE_MAX = const(8)
_TURN_MM = const(9)
_REF = const(10)

# Fields of the job: what to test against what.
NEAR = const(0)
COUNT = const(1)
FIRST = const(2)
LAST = const(3)
HALF_WIDTH = const(4)
HALF_LENGTH = const(5)
MARGIN = const(6)
CAP = const(7)
FLOOR = const(8)
TESTS = const(9)
HITS = const(10)
FIRST_STRIP = const(11)
STRIDE = const(12)
SOFT = const(13)
BAND = const(14)
JOB_FIELDS = const(15)

RIGHT_ANGLES = (0, 6, 12, 20, 28, 37, 47, 60)
SAME_PHASE = ((25, 10), (45, 25), (45, 10), (-10, -25), (-25, -45), (-10, -45))
STRIPS = (0, 6, 12, 20, 32, 50, 70, 90)
FRONT_ONLY = (3, 6, 9, 12, 15, 18, 21, 25, 29, 33, 37, 41, 45, 50, 55, 60)


def _table(size, of):
    """array('H') of of(0), of(1), ..., rounded; filled in place, for a list in between would need four times the room."""
    table = array("H", bytes(2 * size))
    for i in range(size):
        table[i] = int(of(i) + 0.5)
    return table


# arc tangent of 0..1 in 1/1024, unit 1/65536 turn
ATAN = _table(1025, lambda i: atan(i / 1024) * 32768 / pi)
# square root of 0..255, * 256: only 64..255 are looked up
ROOT = _table(256, lambda i: sqrt(i + 0.5) * 256)


def hypot(x, y):
    return sqrt(x * x + y * y)


@micropython.viper
def sort_near(px: ptr16, py: ptr16, n: int, half_width: int, half_length: int, band: int) -> int:
    """Bring the points nearer than band mm to the outline to the front of px, py; returns how many."""
    near = 0
    i = 0
    while i < n:
        x = px[i]
        y = py[i]
        ax = x - 8192
        if ax < 0:
            ax = 0 - ax
        ay = y - 8192
        if ay < 0:
            ay = 0 - ay
        if ax - half_width < band and ay - half_length < band:
            px[i] = px[near]
            py[i] = py[near]
            px[near] = x
            py[near] = y
            near += 1
        i += 1
    return near


@micropython.viper
def drop_behind(px: ptr16, py: ptr16, near: int, n: int, limit: int) -> int:
    """Bring the points more than limit mm behind the centre to the end; returns how many are left before them.

    On a forward candidate every part of the body moves forward, so nothing behind its rear can be met.
    """
    low = 8192 - limit
    i = near
    while i < n:
        y = py[i]
        if y < low:
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
def move(px: ptr16, py: ptr16, n: int, x: int, y: int, s: int, c: int, reach: int, qx: ptr16, qy: ptr16) -> int:
    """The points as seen from a pose (x, y mm, heading by sine and cosine * 2**14), those within reach mm."""
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
        i += 1
    return m


@micropython.viper
def sweep_arcs(px: ptr16, py: ptr16, job: ptr32, consts: ptr32, table: ptr16, free: ptr16, soft: ptr16, blocker: ptr16):
    """Free length of the arc candidates job[FIRST]..job[LAST]-1 against the points.

    free: mm until a point comes within the margin (a point already nearer may come 2 mm nearer);
    soft: the same with the wider, soft margin; blocker: index of the point that ends it, 65535 none.
    A candidate found to be shorter than job[FLOOR] is given up at once.
    """
    atan = ptr16(ATAN)
    root = ptr16(ROOT)
    near = job[0]
    n = job[1]
    k = job[2]
    last = job[3]
    half_width = job[4]
    half_length = job[5]
    margin = job[6]
    cap = job[7]
    floor = job[8]
    stride = job[12]
    soft_margin = job[13]
    band = job[14] << 3
    tests = job[9]
    hits = job[10]
    while k < last:
        base = k * 12
        xc = consts[base]
        yc = consts[base + 1]
        in_soft = consts[base + 2]
        out_soft = consts[base + 3]
        r2_in = consts[base + 4]
        r2_out = consts[base + 5]
        r_in = consts[base + 6]
        scale = consts[base + 7]
        turn_mm = consts[base + 9]
        ref = consts[base + 10]
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
        tests += near
        limit = (length << 16) // turn_mm
        if limit > consts[base + 8]:
            limit = consts[base + 8]
        soft_limit = (soft_length << 16) // turn_mm
        if soft_limit > limit:
            soft_limit = limit
        bottom = (floor << 16) // turn_mm
        if limit >= bottom:
            row = k * 96
            i = 0
            while i < n:
                dx = px[i] - xc
                dy = py[i] - yc
                d2 = dx * dx + dy * dy
                if d2 > in_soft and d2 < out_soft:
                    hits += 1
                    ax = dx
                    if dx < 0:
                        ax = 0 - dx
                    ay = dy
                    if dy < 0:
                        ay = 0 - dy
                    if ax >= ay:
                        phi = atan[(ay << 10) // ax]
                    else:
                        phi = 16384 - atan[(ax << 10) // ay]
                    if dx < 0:
                        phi = 32768 - phi
                    if dy < 0:
                        phi = 65536 - phi
                    # square root by normalising to 64..255
                    v = d2
                    shift = 0
                    if v >= 1048576:
                        v = v >> 12
                        shift = 6
                    if v >= 16384:
                        v = v >> 6
                        shift += 3
                    if v >= 1024:
                        v = v >> 4
                        shift += 2
                    if v >= 256:
                        v = v >> 2
                        shift += 1
                    pos = d2 - r2_in
                    if pos < 0:
                        pos = 0
                    # d - r_in in 1/16 mm = (d2 - r2_in) / (d + r_in): the rough root hardly shows
                    pos = (pos << 4) // (((root[v] << shift) >> 8) + r_in)
                    pos = (pos * scale) >> 12  # bin in 1/256
                    if pos > 6143:
                        pos = 6143
                    j = row + ((pos >> 8) << 2)
                    pos = pos & 255
                    e = table[j]
                    h = e + (((table[j + 1] - e) * pos) >> 8) - phi
                    e = table[j + 2]
                    h2 = e + (((table[j + 3] - e) * pos) >> 8) - phi
                    h = h & 0xFFFF
                    h2 = h2 & 0xFFFF
                    if h2 < h:
                        h = h2
                    if h < soft_limit:
                        soft_limit = h
                    if h < limit and d2 > r2_in and d2 < r2_out:
                        limit = h
                        block = i
                        if limit < bottom:
                            i = n
                i += 1
            tests += n
        free[k] = (limit * turn_mm) >> 16
        soft[k] = (soft_limit * turn_mm) >> 16
        blocker[k] = block
        k += stride
    job[9] = tests
    job[10] = hits


@micropython.viper
def sweep_strips(px: ptr16, py: ptr16, job: ptr32, strips: ptr32, free: ptr16, soft: ptr16, blocker: ptr16):
    """As sweep_arcs, for straight and crab candidates; results follow those of the arcs (index job[FIRST]..)."""
    near = job[0]
    n = job[1]
    k = job[2]
    last = job[3]
    half_width = job[4]
    half_length = job[5]
    margin = job[6]
    first = job[11]
    stride = job[12]
    soft_margin = job[13]
    band = job[14] << 3
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
                l = ((x * s + y * c) >> 10) - corner_l
                if q < corner_q:
                    l += ((corner_q - q) * slope_front) >> 10
                else:
                    l += ((q - corner_q) * slope_side) >> 10
                if l >= 0:
                    if l < soft_length:
                        soft_length = l
                    if l < length and q < half and q > 0 - half:
                        length = l
                        block = i
            i += 1
        free[k] = length >> 4
        soft[k] = soft_length >> 4
        blocker[k] = block
        k += stride
    job[9] += n


class Envelopes:
    """Every candidate steering with its envelope.

    Candidates 0..arcs-1 turn right, arcs..count-1 go straight or crab to the right. `af`, `ar`: array 'h', 0.1 deg.
    `ends`, `turns`: for each candidate and each of LENGTHS travels (`lengths`, mm) where the body's centre comes to lie,
    x, y, mm + 8192, and how far it has turned clockwise, 0.1 deg.
    """

    def __init__(self, config):
        self.half_width = config.robot_width // 2
        self.half_length = config.robot_length // 2
        self.look_ahead = config.windows_look_ahead
        spacings = config.axles_spacings
        self.wheelbase = sum(spacings)
        self.first_axle = config.axles_first
        self.half_track = config.axles_track / 2
        all_wheels = config.mode == "AWS"
        pairs = []
        if all_wheels:
            for i, front in enumerate(RIGHT_ANGLES):
                for j, rear in enumerate(RIGHT_ANGLES):
                    if (i or j) and (j == 0 or -4 <= i - j <= 4) and self._beside(front, -rear):
                        pairs.append((front, -rear))
            pairs.extend(SAME_PHASE)
            strips = STRIPS
        else:
            for front in FRONT_ONLY:
                pairs.append((front, 0))
            strips = (0,)
        self.arcs = len(pairs)
        self.count = self.arcs + len(strips)
        self.af = array("h", [p[0] * 10 for p in pairs] + [a * 10 for a in strips])
        self.ar = array("h", [p[1] * 10 for p in pairs] + [a * 10 for a in strips])
        la = self.look_ahead
        self.lengths = array("H", [la // 14, la // 7, la * 2 // 7, la * 4 // 7, la])
        self.consts = array("i", [0] * (self.arcs * _STRIDE))
        self.table = bytearray(2 * self.arcs * BINS * 4)  # 16-bit words for the viper functions
        self.strips = array("i", [0] * (8 * len(strips)))
        self.ends = array("H", bytes(2 * self.count * LENGTHS * 2))
        self.turns = array("h", bytes(2 * self.count * LENGTHS))  # change of heading, 0.1 deg
        self.set_margin(config.avoid_margin, config.avoid_soft_margin)
        self._fill_ends()

    def _beside(self, front, rear):
        """A centre under the body is left to spinning: its rings enter the outline on every side."""
        r = self.wheelbase / (tan(front * pi / 180) - tan(rear * pi / 180))
        return r > self.half_width + 16

    def set_margin(self, margin, soft):
        """(Re)build every table for a margin and a soft margin, mm. Takes about half a second on the ESP32."""
        self.margin = margin
        self.soft = soft
        for k in range(self.arcs):
            self._fill_arc(k, margin, soft)
        for k in range(self.count - self.arcs):
            self._fill_strip(k, margin, soft)

    def centre(self, k):
        """Turning centre (x, y) of arc k in the body frame, mm. Spec section 3."""
        front = tan(self.af[k] * pi / 1800)
        rear = tan(self.ar[k] * pi / 1800)
        r = self.wheelbase / (front - rear)
        return r, self.first_axle - r * front

    def _reference(self, xc, yc):
        """Distance of the fastest wheel from the turning centre."""
        far = max(abs(self.first_axle - yc), abs(self.first_axle - self.wheelbase - yc))
        return hypot(xc + self.half_track, far)

    def _fill_arc(self, k, margin, soft):
        xc, yc = self.centre(k)
        r_in, r_out = self._ring(xc, yc, margin)
        s_in, s_out = self._ring(xc, yc, soft)
        ref = self._reference(xc, yc)
        c = self.consts
        b = k * _STRIDE
        c[b + _XC] = round(xc) + BIAS
        c[b + _YC] = round(yc) + BIAS
        c[b + _IN_SOFT] = int(s_in * s_in)
        c[b + _OUT_SOFT] = int(s_out * s_out) + 1
        c[b + _IN] = int(r_in * r_in)
        c[b + _OUT] = int(r_out * r_out) + 1
        c[b + _R_IN] = int(r_in)
        # bins: (d - r_in) in 1/16 mm * scale >> 12 = bin in 1/256
        scale = int(BINS * 65536 / (r_out - r_in))
        c[b + _BIN_SCALE] = scale
        c[b + _TURN_MM] = int(2 * pi * ref)
        c[b + _ANGLE_MAX] = min(int(self.look_ahead * 65536 / (2 * pi * ref)), 60000)
        c[b + _REF] = int(ref)
        hw = self.half_width + margin
        hl = self.half_length + margin
        width = 65536 / scale
        table = self.table
        for j in range(BINS):
            low = self._entries(xc, yc, hw, hl, int(r_in) + (j + 0.02) * width)
            high = self._entries(xc, yc, hw, hl, int(r_in) + (j + 0.98) * width)
            if not low:
                low = high
            if not high:
                high = low
            first = last = 0, 0
            if low:
                first = low[0], high[0]
                last = low[-1], high[-1]
                if len(low) != len(high):  # a second arc begins within the bin
                    both = low if len(low) > len(high) else high
                    first = both[0], both[0]
                    last = both[-1], both[-1]
            t = (k * BINS + j) * 8
            for value in first + last:
                table[t] = value & 0xFF
                table[t + 1] = value >> 8
                t += 2

    def _ring(self, xc, yc, margin):
        """Inner and outer radius of what the outline plus margin sweeps about (xc, yc), xc > 0."""
        hw = self.half_width + margin
        hl = self.half_length + margin
        dx = max(xc - hw, 0)
        dy = max(abs(yc) - hl, 0)
        return hypot(dx, dy), hypot(xc + hw, abs(yc) + hl)

    def _entries(self, xc, yc, hw, hl, d):
        """Angles (1/65536 turn, anticlockwise from +x about the centre) where the ring of radius d enters the outline."""
        found = []
        for edge in range(4):
            if edge == 0:  # right side, entered leftwards
                x = hw - xc
                q = d * d - x * x
                if q < 0:
                    continue
                y = sqrt(q)
            elif edge == 1:  # front, entered downwards
                y = hl - yc
                q = d * d - y * y
                if q < 0:
                    continue
                x = -sqrt(q)
            elif edge == 2:  # left side, entered rightwards
                x = -hw - xc
                q = d * d - x * x
                if q < 0:
                    continue
                y = -sqrt(q)
            else:  # rear, entered upwards
                y = -hl - yc
                q = d * d - y * y
                if q < 0:
                    continue
                x = sqrt(q)
            if -hw - 0.01 <= x + xc <= hw + 0.01 and -hl - 0.01 <= y + yc <= hl + 0.01:
                found.append(int(atan2(y, x) * 32768 / pi) & 0xFFFF)
        found.sort()
        return found

    def _fill_strip(self, k, margin, soft):
        a = self.af[self.arcs + k] * pi / 1800
        s = sin(a)
        c = cos(a)
        hw = self.half_width + margin
        hl = self.half_length + margin
        b = k * 8
        t = self.strips
        t[b] = round(s * 16384)
        t[b + 1] = round(c * 16384)
        t[b + 2] = int((hw * c + hl * s) * 16)
        t[b + 3] = int(((self.half_width + soft) * c + (self.half_length + soft) * s) * 16)
        t[b + 4] = int((hw * c - hl * s) * 16) + 131072
        t[b + 5] = int((hw * s + hl * c) * 16)
        t[b + 6] = min(int(s / c * 1024), 60000) if c > 0.01 else 60000
        t[b + 7] = min(int(c / s * 1024), 60000) if s > 0.01 else 60000

    def _fill_ends(self):
        for k in range(self.count):
            for i in range(LENGTHS):
                x, y, turn = self.end(k, self.lengths[i])
                t = (k * LENGTHS + i) * 2
                self.ends[t] = round(x) + BIAS
                self.ends[t + 1] = round(y) + BIAS
                self.turns[k * LENGTHS + i] = round(turn * 1800 / pi)

    def end(self, k, length):
        """Pose (x, y mm, clockwise turn in rad) of the body centre after `length` mm of travel on candidate k."""
        if k >= self.arcs:
            a = self.af[k] * pi / 1800
            return length * sin(a), length * cos(a), 0.0
        xc, yc = self.centre(k)
        turn = length / self._reference(xc, yc)
        s = sin(turn)
        c = cos(turn)
        return xc - xc * c - yc * s, yc + xc * s - yc * c, turn
