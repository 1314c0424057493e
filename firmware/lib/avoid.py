"""The decision: from what stands round the robot to (AF, AR, V), and why.

One step of look-ahead: every candidate envelope (envelope.py) is tested against the points, and each travel it allows is
worth its length plus the cost-to-leave (field.py) of the two ends of the body where it ends. When no single move gets
on well, the best of all moves, backward ones included, are each followed by a second set: two moves are planned, and
driven one after the other as long as the points agree.

The work is cut into slices, one a call of `work()`; the guard that stops the robot for something new runs on every frame.
Source: papers A section 4 and B section 3, with the corrections of the feasibility study in the README.
"""

from array import array

import micropython
from micropython import const

import reasons
from envelope import LENGTHS, Envelopes
from field import Field, score_ends
from surroundings import Surroundings
from sweep import BAND_MM, Sweep, drop_behind, mirror, move, sort_near
from trig import cos14, sin14
from windows import NO_ZONE, RED, Windows

_POINTS = const(320)
_NODES = const(6)
_FINE = const(6)  # more lengths tried of the first move of the best pair
_NOTHING = const(65535)
_NO_POINT = const(32767)
_LEFT_SIDE = const(1000)
_SLICE = const(1800)  # candidate tests in one slice
_OVERHEAD = const(76)  # what is done once for a candidate, its five ends valued above all, in tests
_PATIENCE = const(5)  # times backing up on the same ground

# Stages of a decision.
_IDLE = const(0)
_RIGHT = const(1)
_LEFT = const(2)
_CHOOSE = const(3)
_BACK_RIGHT = const(4)
_BACK_LEFT = const(5)
_NODE_PICK = const(6)
_EXPAND = const(7)
_SETTLE = const(8)
_FIELD = const(9)


@micropython.viper
def _weigh(score: ptr16, free: ptr16, soft: ptr16, af: ptr16, ar: ptr16, lengths: ptr16, job: ptr32):
    """Add what steering, change of steering, a closed way and narrow passing cost.

    job: first, last, stride, sign (2 forward right, 0 forward left, 3, 1 backward), AF now + 1800, AR now + 1800, look-ahead,
    steering weight, change weight (1/1024 mm per 0.1 deg), extra (mm)
    """
    k = job[0]
    last = job[1]
    stride = job[2]
    variant = job[3]
    af0 = job[4] - 1800
    ar0 = job[5] - 1800
    room = job[6]
    w_steer = job[7]
    w_change = job[8]
    extra = job[9]
    while k < last:
        a = (af[k] ^ 0x8000) - 0x8000
        r = (ar[k] ^ 0x8000) - 0x8000
        cost = a
        if a < 0:
            cost = 0 - a
        if r < 0:
            cost -= r
        else:
            cost += r
        cost = cost * w_steer
        if variant == 1:
            a = 0 - a
            r = 0 - r
        elif variant == 2:
            t = a
            a = 0 - r
            r = 0 - t
        elif variant == 3:
            t = a
            a = r
            r = t
        d = a - af0
        if d < 0:
            d = 0 - d
        e = r - ar0
        if e < 0:
            e = 0 - e
        cost = ((cost + (d + e) * w_change) >> 10) + extra
        # A way that closes soon, or narrowly passed, is dear whatever part of it is driven: the rest comes next.
        f = free[k]
        if f < room:
            cost += (room - f) >> 1
        f = soft[k]
        if f < room:
            cost += (room - f) >> 2
        i = 0
        while i < 5:
            v = score[k * 5 + i]
            if v < 65000:
                score[k * 5 + i] = v + cost
            i += 1
        k += stride


@micropython.viper
def _best(score: ptr16, first: int, last: int, stride: int) -> int:
    """Index 5 k + i of the lowest score."""
    best = 65534
    pick = 65535
    k = first
    while k < last:
        i = 0
        while i < 5:
            v = score[k * 5 + i]
            if v < best:
                best = v
                pick = k * 5 + i
            i += 1
        k += stride
    return pick


@micropython.viper
def _suppress(score: ptr16, ends: ptr16, turns: ptr16, count: int, at: int, radius: int, reach: int):
    """Take out the travels that end within radius of where travel `at` ends; a turn counts as the way of the body's ends."""
    x0 = ends[at * 2]
    y0 = ends[at * 2 + 1]
    a0 = turns[at] ^ 0x8000
    i = 0
    last = count * 5
    while i < last:
        if score[i] < 65535:
            d = ends[i * 2] - x0
            if d < 0:
                d = 0 - d
            e = ends[i * 2 + 1] - y0
            if e < 0:
                e = 0 - e
            d += e
            e = (turns[i] ^ 0x8000) - a0
            if e < 0:
                e = 0 - e
            if d + (e * reach >> 9) < radius:
                score[i] = 65535
        i += 1


class Avoid:
    """Decides where to go. See docs/architecture.md for the attributes of a decision."""

    def __init__(self, config):
        self.config = config
        self.points = Surroundings(config)
        self.field = Field(config)
        self.envelopes = Envelopes(config)
        self.windows = Windows(config, _POINTS)
        env = self.envelopes
        self.points_x = array("h", bytes(2 * _POINTS))  # body frame, mm: for whoever looks on
        self.points_y = array("h", bytes(2 * _POINTS))
        self.points_window = self.windows.window
        self.points_count = 0
        size = 2 * _POINTS
        self._x = array("H", bytes(size))
        self._y = array("H", bytes(size))
        self._nx = self.points_x  # points as seen from a node: those for others are made anew at the end of the decision
        self._ny = self.points_y
        count = env.count
        self.free_of = tuple(array("H", bytes(2 * count)) for _ in range(4))
        self.soft_of = tuple(array("H", bytes(2 * count)) for _ in range(4))
        self._block = array("H", bytes(2 * count))  # of what was swept last
        self._score = tuple(array("H", b"\xff" * (2 * count * LENGTHS)) for _ in range(4))
        self._free2 = array("H", bytes(2 * count))
        self._soft2 = array("H", bytes(2 * count))
        self._score2 = self._score[0]  # done with by then
        self._sweep = Sweep(env)
        self._ends_job = array("i", [0] * 11)
        self._weigh_job = array("i", [0] * 10)
        nodes = _NODES + _FINE
        self._node_variant = bytearray(nodes)
        self._node_k = bytearray(nodes)
        self._node_length = array("H", bytes(2 * nodes))
        self._node_score = array("i", bytes(4 * nodes))
        self._nodes = 0
        self._node = 0
        self._n = 0
        self._near = 0
        self._coarse = 0
        self._end_x = self._end_y = 0
        self._n2 = self._near2 = self._left2 = 0  # the same, as seen from the end of a first move
        self._stage = _FIELD
        self._next = 0  # of what a stage has cut into slices
        self._field_x = 0
        self._field_y = 0
        self._field_heading = 0
        self._field_frame = 0
        self._renewing = False
        self._decided_travel = 0
        self._decided_frame = 0
        self._travel256 = 0
        self._anchor_x = 0
        self._anchor_y = 0
        self._anchor_heading = 0
        self._reversals = 0
        # The steering being driven: candidate and how it is mirrored (bit 0 left, bit 1 backward).
        self._k = 0
        self._variant = 0
        # The plan: first move until travel _until, then a second.
        self._plan = 0  # 0 none, 1 in the first move, 2 in the second
        self._until = 0
        self._second_k = 0
        self._second_variant = 0
        self._second_length = 0
        self._best_value = 65535
        self._best_node = 0
        self._limit = 0
        self._ready = 0
        self._watched = 0
        self._urgent = 0
        self._at_x = self._at_y = self._at_heading = 0
        self._guarded = -1  # frame on which the present steering was looked at last
        self._followed = -1  # frame on which the plan was
        self.reset_decision()
        self.decisions = 0
        self.configure()

    def configure(self):
        """Take over parameters that may have been tuned.

        Margins and look-ahead are in the tables, which takes about half a second on the ESP32: the robot must stand then (Settings.tune sees to
        that). MemoryError, with the old tables whole, if there is no room for the code that makes them.
        """
        c = self.config
        if self.envelopes.outdated(c):
            self.envelopes.refill(c)
            self.field.refill(c)
            self.v = 90
            self.why = reasons.LOOKING
            self._plan = 0
            self._stage = _FIELD
            self._renewing = False
            self._next = 0
        self.cruise = c.drive_cruise
        self.look_ahead = self.envelopes.look_ahead
        self._swing = self.envelopes.half_width + self.envelopes.soft + self.envelopes.half_length // 2
        self.full_speed = c.motors_full_speed
        self._steer_weight = c.avoid_steering_weight * self.look_ahead * 1024 // (100 * 1200)
        self._change_weight = c.avoid_change_weight * self.look_ahead * 1024 // (100 * 1200)
        self.windows.configure(c)
        self._changes = c.changes

    def reset_decision(self):
        self.af = 0
        self.ar = 0
        self.v = 90
        self.mode = 0
        self.window = 0
        self.zone = NO_ZONE
        self.free = 0
        self.block_x = _NO_POINT
        self.block_y = _NO_POINT
        self.why = reasons.WAITING

    # ---- lidar frames

    def frame(self, lidar, odometry):
        """Take in one measurement frame."""
        self.points.frame(lidar, odometry)
        self.field.follow(odometry)
        self._ready += 1

    def guard(self, odometry, speed):
        """Look at every frame: True, and v = 90, when the way being driven is no longer free as far as it takes to stop at `speed` mm/s."""
        self._look(odometry)
        free = self._current_free()
        self._guarded = self._ready
        self.free = free
        # What rolls out in the motors' time constant, and a little.
        if free >= speed // 9:
            return False
        self.v = 90
        self.why = reasons.BLOCKED
        self._plan = 0
        self._stage = _IDLE
        self._tell()
        return True

    def watch(self, odometry, why, af, ar, v):
        """Somebody else decides: keep the points and windows up to date, and say why."""
        self._look(odometry)
        self._plan = 0
        self._stage = _FIELD
        self.af = af
        self.ar = ar
        self.v = v
        self.why = why
        self.free = 0
        self.block_x = _NO_POINT
        self.block_y = _NO_POINT
        self._watched += 1
        if self._watched >= 8:
            self._watched = 0
            self._tell()

    def _look(self, odometry):
        """The points as the body sees them now, those near the outline first, and the window of each."""
        env = self.envelopes
        n = self.points.view(odometry, self._x, self._y, self.look_ahead + env.half_length)
        self._urgent = self.windows.sort(self._x, self._y, n, env.soft + BAND_MM)
        self._near = self.windows.near
        self._n = n

    def _current_free(self):
        k = self._k
        v = self._variant
        self._run(v, k, k + 1, 1, 0)
        return self.free_of[v][k]

    def _run_some(self, variant):
        """Sweep and value the next candidates of one variant, as many as a slice allows. True when all are done."""
        env = self.envelopes
        first = self._next
        if variant & 2 and first < env.astern_first:
            first = env.astern_first
        elif variant < 2 and env.ahead_end <= first < env.arcs:
            first = env.arcs
        last = first + _SLICE // (self._n + _OVERHEAD) + 1
        if variant < 2 and first < env.ahead_end:
            last = min(last, env.ahead_end)
        last = min(last, env.count)
        self._run(variant, first, last, 1, env.lengths[0])
        self._worth(variant, self.free_of[variant], self.soft_of[variant], self._score[variant], first, last, 1, self.af, self.ar, 150 if variant & 2 else 0)
        self._next = last
        if last < env.count:
            return False
        self._next = 0
        return True

    def _run(self, variant, first, last, stride, floor):
        """Sweep candidates first..last-1 in one variant."""
        n = self._n
        if variant & 1:
            mirror(self._x, n)
        if variant & 2:
            mirror(self._y, n)
        env = self.envelopes
        left = n
        if last - first > 2:
            left = drop_behind(self._x, self._y, self._near, n, env.half_length + env.soft, self._swing)
        self._sweep.run(self._x, self._y, left, self._near, first, last, stride, floor, self.free_of[variant],
                       self.soft_of[variant], self._block)
        if variant & 1:
            mirror(self._x, n)
        if variant & 2:
            mirror(self._y, n)

    # ---- worth

    def _stand_here(self, odometry):
        """The pose from which the decision that begins now looks at everything."""
        self._at_x = odometry.x >> 5
        self._at_y = odometry.y >> 5
        self._at_heading = (odometry.heading + 50) // 100
        self._grid(0, 0, 0)

    def _grid(self, x, y, heading):
        """Set the score job to a body pose: x, y (mm) and heading (0.1 deg) relative to the pose of the decision."""
        field = self.field
        job = self._ends_job
        a = self._at_heading
        s = sin14(a)
        c = cos14(a)
        wx = self._at_x + ((x * c + y * s) >> 11)
        wy = self._at_y + ((y * c - x * s) >> 11)
        a += heading
        job[0] = ((wx - field.corner_x) & 0xFFFF ^ 0x8000) - 0x8000
        job[1] = ((wy - field.corner_y) & 0xFFFF ^ 0x8000) - 0x8000
        job[2] = sin14(a) + 16384
        job[3] = cos14(a) + 16384
        job[6] = field.cell
        job[10] = a

    def _worth(self, variant, free, soft, score, first, last, stride, af, ar, extra):
        env = self.envelopes
        job = self._ends_job
        job[4] = variant & 1
        job[5] = variant >> 1
        job[7] = first
        job[8] = last
        job[9] = stride
        score_ends(self.field.cost, env.ends, env.turns, free, env.lengths, score, job)
        job = self._weigh_job
        job[0] = first
        job[1] = last
        job[2] = stride
        job[3] = variant
        job[4] = af + 1800
        job[5] = ar + 1800
        job[6] = self.look_ahead * 3 // 7
        job[7] = self._steer_weight
        job[8] = self._change_weight
        job[9] = extra
        _weigh(score, free, soft, env.af, env.ar, env.lengths, job)

    # ---- the decision, slice by slice

    def work(self, odometry):
        """One slice. Returns True when a decision has just been made (af, ar, v and the rest hold it)."""
        if self.config.changes != self._changes:
            self.configure()
        stage = self._stage
        if stage == _FIELD:
            if self._renew_field(odometry):
                self._stage = _IDLE
            return False
        if stage == _IDLE:
            if self._resting(odometry):
                # A plan near its end: the next decision will want a field that fits.
                if self._plan and self._left(odometry) < self.look_ahead >> 2 and (self._renewing or not self._field_fits(odometry)):
                    self._renew_field(odometry)
                return False
            if self._plan == 0 and (self._ready < 20 or self._renewing or not self._field_fits(odometry)):
                self._stage = _FIELD
                return False
            if self._guarded != self._ready:
                self._look(odometry)
                if self._plan:
                    self.free = self._current_free()
                self._guarded = self._ready
            if self._plan:
                if self._follow(odometry):
                    return self._publish()
                return False
            self._stand_here(odometry)
            self._stage = _RIGHT
            self._next = 0
            return False
        env = self.envelopes
        if stage == _RIGHT or stage == _LEFT:
            if self._run_some(stage - _RIGHT):
                self._stage = stage + 1
            return False
        if stage == _CHOOSE:
            if self._choose_one():
                self._stage = _IDLE
                self._decided_travel = odometry.travel256
                self._decided_frame = self._ready
                self.free = self._current_free()
                return self._publish()
            # This takes longer. With little way left the robot stands meanwhile.
            self._stage = _BACK_RIGHT
            if self.v != 90 and self.free < env.lengths[2]:
                self.v = 90
                self.why = reasons.LOOKING
                self._plan = 0
                self._tell()
                return True
            return False
        if stage == _BACK_RIGHT or stage == _BACK_LEFT:
            if self._run_some(stage - _BACK_RIGHT + 2):
                self._stage = stage + 1
                self._nodes = 0
            return False
        if stage == _NODE_PICK:
            if self._pick_node():
                self._stage = _EXPAND if self._nodes else _SETTLE
            return False
        if stage == _EXPAND:
            if self._expand():
                self._node += 1
                if self._node == self._nodes:
                    self._refine()
                if self._node >= self._nodes:
                    self._next = 0
                    self._stage = _SETTLE
            return False
        self._stage = _IDLE
        self._travel256 = odometry.travel256
        self._settle(odometry)
        self._count_reversals(odometry, self._variant > 1)
        # Anew for this one: sorting for other candidates has moved the points about.
        room = self._current_free()
        if self._limit > 0:
            self.free = room
        return self._publish()

    def _resting(self, odometry):
        """Whether there is nothing to decide: a plan that has been looked at on this frame, or a single move that is still fresh.

        The guard watches both, and a few millimetres on nothing has changed.
        """
        if self._plan:
            return self._followed == self._ready and self._left(odometry) > 4
        if self.v == 90:
            return False
        rolled = (odometry.travel256 - self._decided_travel) & 0x3FFFFFF
        return rolled < self.look_ahead * 5 and self._ready - self._decided_frame < 8

    def _renew_field(self, odometry):
        """One slice of the next field; True after the last. It cannot be asked before."""
        if not self._renewing:
            self._renewing = True
            self._field_x = odometry.x
            self._field_y = odometry.y
            self._field_heading = odometry.heading
            self._field_frame = self._ready
        if self.field.work(odometry, self.points):
            self._renewing = False
        return not self._renewing

    def _field_fits(self, odometry):
        """Whether the field in use still fits: the robot has hardly moved since and it is not old."""
        if not self.field.ready:
            return False
        dx = (odometry.x - self._field_x) >> 8
        dy = (odometry.y - self._field_y) >> 8
        turned = (odometry.heading - self._field_heading) % 360000
        if turned > 180000:
            turned = 360000 - turned
        near = self.look_ahead // 10
        return dx * dx + dy * dy < near * near and turned < 8000 and self._ready - self._field_frame < 40

    def _left(self, odometry):
        """What is left of the move of the plan that is being driven, mm."""
        return (((self._until - odometry.travel256) & 0x3FFFFFF ^ 0x2000000) - 0x2000000) >> 8

    def _against(self, variant, at):
        """What it costs, mm, that the nose does not point where the way leads on, after travel `at` from the pose of the score job.

        The cost of leaving should fall ahead of the nose; how much it does not is counted.
        """
        env = self.envelopes
        field = self.field
        job = self._ends_job
        x = env.ends[2 * at] - 8192
        y = env.ends[2 * at + 1] - 8192
        turn = env.turns[at]
        if variant & 1:
            x = -x
            turn = -turn
        if variant & 2:
            y = -y
            turn = -turn
        s = job[2] - 16384
        c = job[3] - 16384
        x, y = job[0] + field.corner_x + ((x * c + y * s) >> 11), job[1] + field.corner_y + ((y * c - x * s) >> 11)
        heading = job[10] + turn
        ahead = env.half_length >> 1
        x1 = x + (ahead * sin14(heading) >> 11)
        y1 = y + (ahead * cos14(heading) >> 11)
        loss = field.at(x1, y1, heading) - field.at(x, y, heading) + (ahead >> 1)
        if loss < 0:
            return 0
        return loss if loss < 2 * ahead else 2 * ahead

    def _choose_one(self):
        """Take the best single move if it gets on well."""
        score0 = self._score[0]
        score1 = self._score[1]
        count = self.envelopes.count
        a = _best(score0, 0, count, 1)
        b = _best(score1, 0, count, 1)
        value_a = score0[a] if a != _NOTHING else 65535
        value_b = score1[b] if b != _NOTHING else 65535
        here = self.field.at(self._at_x, self._at_y, self._at_heading)
        variant = 0
        # Which of the two sides, is told by where the nose points afterwards: the field knows no front from rear.
        against_a = self._against(0, a) if a != _NOTHING else 0
        against_b = self._against(1, b) if b != _NOTHING else 0
        if value_b + against_b < value_a + against_a or (value_b + against_b == value_a + against_a and self._variant == 1):
            variant = 1
            a = b
            value_a = value_b
        if a == _NOTHING or value_a > here + 130:
            return False
        k = a // LENGTHS
        if self.free_of[variant][k] < self.config.avoid_accept:
            return False
        self._plan = 0
        self._take(variant, k)
        self._limit = self.look_ahead
        if k == self.envelopes.arcs:
            self.why = reasons.ON
        elif k > self.envelopes.arcs:
            self.why = reasons.CRAB
        else:
            self.why = reasons.BEND
        return True

    def _take(self, variant, k):
        self._variant = variant
        self._k = k
        env = self.envelopes
        a = env.af[k]
        r = env.ar[k]
        if variant == 1:
            a, r = -a, -r
        elif variant == 2:
            a, r = -r, -a
        elif variant == 3:
            a, r = r, a
        self.af = a
        self.ar = r
        self.free = self.free_of[variant][k]

    def _pick_node(self):
        """Add the best move to the nodes, and take out those that end like it. True when they are enough, or there is none."""
        env = self.envelopes
        n = self._nodes
        best = 65535
        variant = 0
        at = 0
        for v in (0, 1, 2, 3):
            a = _best(self._score[v], 0, env.count, 1)
            if a != _NOTHING and self._score[v][a] < best:
                best = self._score[v][a]
                variant = v
                at = a
        if best < 65535:
            self._node_variant[n] = variant
            self._node_k[n] = at // LENGTHS
            self._node_length[n] = env.lengths[at % LENGTHS]
            self._node_score[n] = best
            _suppress(self._score[variant], env.ends, env.turns, env.count, at, env.look_ahead // 12, env.half_length)
            n += 1
            self._nodes = n
            if n < _NODES:
                return False
        self._coarse = n
        self._node = 0
        self._best_value = 65535
        self._best_node = 0
        return True

    def _refine(self):
        """More lengths of the best pair's first move: whether a long body gets round a corner depends on where its turn begins, to the centimetre."""
        if self._best_value == 65535 or self._nodes > self._coarse:
            return
        best = self._best_node
        v = self._node_variant[best]
        k = self._node_k[best]
        length = self._node_length[best]
        free = self.free_of[v][k]
        n = self._nodes
        unit = self.envelopes.half_length // 25
        for d in (-3, -2, -1, 1, 2, 3):
            other = length + d * unit
            if 2 * unit < other <= free:
                self._node_variant[n] = v
                self._node_k[n] = k
                self._node_length[n] = other
                self._node_score[n] = self._node_score[best] + other - length
                n += 1
        self._nodes = n
        # To the side of the best pair only.
        self._next = self._second_variant * _LEFT_SIDE

    def _end(self, k, length):
        """Where the body's centre comes to lie after `length` mm on candidate k: _end_x, _end_y (mm), and how far it turns, 0.1 deg."""
        env = self.envelopes
        if k >= env.arcs:
            b = (k - env.arcs) * 8
            self._end_x = env.strips[b] * length >> 14
            self._end_y = env.strips[b + 1] * length >> 14
            return 0
        b = k * 13
        c = env.consts
        xc = c[b] - 8192
        yc = c[b + 1] - 8192
        turn = length * 36000 // c[b + 9]
        s = sin14((turn + 5) // 10)
        o = cos14((turn + 5) // 10)
        self._end_x = xc - ((xc * o + yc * s) >> 14)
        self._end_y = yc + ((xc * s - yc * o) >> 14)
        return (turn + 5) // 10

    def _expand(self):
        """Second moves from where a node ends, right and left, a slice of candidates at a time. True after the last.

        Every other point and candidate does: the second move is looked at again, with all of them, before it is driven.
        """
        env = self.envelopes
        v = self._node_variant[self._node]
        k = self._node_k[self._node]
        second = 1 if self._next >= _LEFT_SIDE else 0
        first = self._next - second * _LEFT_SIDE
        fine = self._node >= self._coarse
        if first == 0:
            if fine or not second:
                turn = self._end(k, self._node_length[self._node])
                x = self._end_x
                y = self._end_y
                if v & 1:
                    x = -x
                    turn = -turn
                if v & 2:
                    y = -y
                    turn = -turn
                self.points_count = -1  # for now there are none for others
                n = move(self._x, self._y, self._n, x, y, sin14(turn), cos14(turn), env.lengths[3] + env.half_length, self._nx, self._ny, 2)
                self._near2 = sort_near(self._nx, self._ny, n, env.half_width, env.half_length, env.soft + BAND_MM)
                self._n2 = n
                self._grid(x, y, turn)
                if not fine:
                    # The second move's score replaces the cost of the pose where the first ends.
                    job = self._ends_job
                    self._node_score[self._node] -= self.field.at(job[0] + self.field.corner_x, job[1] + self.field.corner_y, job[10])
            if second:
                mirror(self._nx, self._n2)
            self._left2 = drop_behind(self._nx, self._ny, self._near2, self._n2, env.half_length + env.soft, self._swing)
        n = self._left2
        a = env.af[k]
        r = env.ar[k]
        if v == 1:
            a, r = -a, -r
        elif v == 2:
            a, r = -r, -a
        elif v == 3:
            a, r = r, a
        if env.ahead_end <= first < env.arcs:
            first = env.arcs
        stride = 2 if first < env.arcs else 1
        last = min(first + stride * (_SLICE // (n + _OVERHEAD) + 1), env.ahead_end if stride == 2 else env.count)
        self._sweep.run(self._nx, self._ny, n, self._near2, first, last, stride, env.lengths[1], self._free2, self._soft2, self._block)
        self._worth(second, self._free2, self._soft2, self._score2, first, last, stride, a, r, 60)
        b = _best(self._score2, first, last, stride)
        if b != _NOTHING:
            value = self._node_score[self._node] + self._score2[b] + self._against(second, b)
            if value < self._best_value:
                self._best_value = value
                self._best_node = self._node
                self._second_variant = second
                self._second_k = b // LENGTHS
                self._second_length = env.lengths[b % LENGTHS]
        if last < env.count:
            self._next = second * _LEFT_SIDE + last
            return False
        if fine:
            self._next = second * _LEFT_SIDE
            return True
        self._next = 0 if second else _LEFT_SIDE
        return second == 1

    def _settle(self, odometry):
        """Drive the best pair of moves, or the least bad single one, or stand."""
        env = self.envelopes
        if self._reversals >= _PATIENCE and self._leave():
            return
        if self._best_value < 65535:
            v = self._node_variant[self._best_node]
            self._take(v, self._node_k[self._best_node])
            length = self._node_length[self._best_node]
            self._plan = 1
            self._until = odometry.travel256 + (length << 8)
            self._limit = length
            self.why = reasons.TURNED if v & 2 else reasons.LOOKING
            return
        if self._nodes:
            v = self._node_variant[0]
            self._take(v, self._node_k[0])
            self._plan = 1
            self._second_k = -1
            self._limit = self._node_length[0]
            self._until = odometry.travel256 + (self._limit << 8)
            self.why = reasons.BACK if v & 2 else reasons.BEND
            return
        self._plan = 0
        # Nothing of the shortest travel: whatever gives most way, if any.
        best = 0
        for v in (0, 1, 2, 3):
            free = self.free_of[v]
            for k in range(env.count):
                if free[k] > best:
                    best = free[k]
                    self._variant = v
                    self._k = k
        if best >= 12:
            self._take(self._variant, self._k)
            self._limit = best - 6
            self.why = reasons.CENTRE
        else:
            self._limit = 0
            self.free = 0
            self.why = reasons.BOXED

    def _leave(self):
        """To and fro on the same ground has led nowhere: go back or on as far as anything goes, and look from there."""
        env = self.envelopes
        best = env.lengths[2]
        found = False
        for v in (2, 3, 0, 1):
            free = self.free_of[v]
            for k in range(env.count):
                if free[k] > best:
                    best = free[k]
                    self._variant = v
                    self._k = k
                    found = True
        if not found:
            return False
        self._take(self._variant, self._k)
        self._second_k = -1
        self._plan = 1
        self._limit = min(best - env.lengths[0], env.lengths[3])
        self._until = self._travel256 + (self._limit << 8)
        self._reversals = 0
        self.why = reasons.AGAIN
        return True

    def _count_reversals(self, odometry, back):
        """How often the robot has backed up since it last got anywhere: a third of its length on, or 15 degrees round."""
        dx = (odometry.x - self._anchor_x) >> 8
        dy = (odometry.y - self._anchor_y) >> 8
        turned = (odometry.heading - self._anchor_heading) % 360000
        if turned > 180000:
            turned = 360000 - turned
        third = self.envelopes.half_length * 2 // 3
        if turned > 15000 or dx * dx + dy * dy > third * third:
            self._anchor_x = odometry.x
            self._anchor_y = odometry.y
            self._anchor_heading = odometry.heading
            self._reversals = 0
        if back:
            self._reversals += 1

    def _follow(self, odometry):
        """Go on with the plan if the points still allow it. Returns False when it is over."""
        left = self._left(odometry)
        self._followed = self._ready
        env = self.envelopes
        if left <= 4:
            if self._plan == 1 and self._second_k >= 0:
                v = self._second_variant
                k = self._second_k
                self._run(v, k, k + 1, 1, 0)
                if self.free_of[v][k] >= min(self._second_length, env.lengths[1]):
                    self._take(v, k)
                    self._plan = 2
                    self._until = odometry.travel256 + (self._second_length << 8)
                    self._limit = self._second_length
                    self.why = reasons.PLAN
                    return True
            self._plan = 0
            return False
        if self.free < min(left, 2 * env.lengths[0]) - 10:
            self._plan = 0
            return False
        self._limit = left
        return True

    def _publish(self):
        """Speed, mode and blocking point of the chosen steering."""
        env = self.envelopes
        v = self._variant
        k = self._k
        room = self.free
        if self._limit < room:
            room = self._limit
        cruise = self.cruise - 90
        # Stop within the free way: it takes about speed / 10 mm.
        speed = (60 + room * 3) * 90 // self.full_speed
        if speed > cruise:
            speed = cruise
        if self.soft_of[v][k] < env.lengths[1] and speed > cruise * 4 // 5:
            speed = cruise * 4 // 5
        if 0 < self._urgent <= RED and speed > cruise // 2:
            speed = cruise // 2
        if speed < 4:
            speed = 4
        if self._limit <= 0 or room <= 0:
            speed = 0
        self.v = 90 - speed if v & 2 else 90 + speed
        b = self._block[k]
        if b == 65535:
            self.block_x = _NO_POINT
            self.block_y = _NO_POINT
        else:
            self.block_x = self._x[b] - 8192
            self.block_y = self._y[b] - 8192
        self._tell()
        return True

    def _tell(self):
        """Count the decision and lay out what belongs to it for those who look on."""
        w = self._urgent
        self.window = w
        self.zone = self.windows.zone()
        self.mode = _mode(self.af, self.ar)
        self.decisions += 1
        n = self._n
        _unbias(self._x, self.points_x, n)
        _unbias(self._y, self.points_y, n)
        self.points_count = n

@micropython.viper
def _unbias(p: ptr16, q: ptr16, n: int):
    i = 0
    while i < n:
        q[i] = (p[i] - 8192) & 0xFFFF
        i += 1


def _mode(af, ar):
    """Steering mode of spec section 3."""
    if af == ar:
        return 7 if af == 0 else 5
    if af == 0:
        return 2
    if ar == 0:
        return 3
    if af == 900 and ar == -900 or af == -900 and ar == 900:
        return 4
    return 1 if af * ar < 0 else 6
