"""The decision: from what stands round the robot to (AF, AR, V), and why.

One step of look-ahead: each travel of every candidate envelope (envelope.py) is worth its length plus the cost of leaving (field.py)
from where it ends, if the points allow it. Those that promise most are tested first: as soon as the best is known, the others need not be.
When no single move gets on well, all are, and the best of all moves, backward ones included, are each followed by a second set: two moves are planned, and
driven one after the other as long as the points agree.

The work is cut into slices, one a call of `work()`; the guard that stops the robot for something new runs on every frame.
Source: papers A section 4 and B section 3; the cost of leaving and the second move are this project's own.
"""

from array import array

import micropython
from micropython import const

from perception.local_map import LocalMap
from perception.windows import NO_ZONE, RED, Windows
from planner import reasons
from planner.candidates import LENGTHS, Candidates
from planner.collision import BAND_MM, CollisionCheck, drop_behind, mirror, sort_near
from planner.cost_to_go import CostToGo
from planner.move_cost import NOTHING, MoveCost, best, in_a_slice
from planner.two_step import TwoStep
from steering import mode_of

_POINTS = const(320)
_NO_POINT = const(32767)
_PATIENCE = const(5)  # times backing up on the same ground
_BACKWARD = const(150)  # mm that a move backward costs for being one
_BACKWARD_NAWS = const(300)  # ... where the robot drives worse that way

# Stages of a decision.
_IDLE = const(0)
_PROMISE = const(1)
_BEST = const(2)
_PROMISE_OTHER = const(3)  # to the other side
_BEST_OTHER = const(4)
_CHOOSE = const(5)
_RIGHT = const(6)
_LEFT = const(7)
_CHOOSE_OF_ALL = const(8)
_BACK_RIGHT = const(9)
_BACK_LEFT = const(10)
_PICK = const(11)
_EXPAND = const(12)
_SETTLE = const(13)
_FIELD = const(14)

# How far the robot may have gone since the field was made: parts of the look-ahead
_FIT = const(6)
_FRESH = const(10)

_SINGLE = (reasons.ON, reasons.BEND, reasons.CRAB)


class Avoid:
    """Decides where to go. See docs/architecture.md for the attributes of a decision."""

    def __init__(self, config):
        self.config = config
        self.points = LocalMap(config)
        self.field = CostToGo(config)
        self.candidates = Candidates(config)
        self.windows = Windows(config, _POINTS)
        env = self.candidates
        self.points_x = array("h", bytes(2 * _POINTS))  # body frame, mm: for whoever looks on
        self.points_y = array("h", bytes(2 * _POINTS))
        self.points_window = self.windows.window
        self.points_count = 0
        size = 2 * _POINTS
        self._x = array("H", bytes(size))
        self._y = array("H", bytes(size))
        count = env.count
        self.free_of = tuple(array("H", bytes(2 * count)) for _ in range(4))
        # Of what was swept last: how far it is from being narrow, the point that ends it
        self._soft = array("H", bytes(2 * count))
        self._block = array("H", bytes(2 * count))
        self._swept = bytearray(count)  # which candidates were, to the side that is being looked through
        self._least = NOTHING  # score of the best single move known
        self._score = tuple(array("H", b"\xff" * (2 * count * LENGTHS)) for _ in range(4))
        self._sweep = CollisionCheck(env)
        self._worth = MoveCost(config, self.field, env)
        self._pairs = TwoStep(env, self._worth, self._sweep, self._soft, self._block)
        self._n = 0
        self._near = 0
        self._backward = _BACKWARD if config.mode == "AWS" else _BACKWARD_NAWS
        self._here = 0  # cost of leaving where the decision began
        self._stage = _FIELD
        self._next = 0  # of what a stage has cut into slices
        self._field_x = 0
        self._field_y = 0
        self._field_heading = 0
        self._field_frame = 0
        self._renewing = False
        self._decided_travel = 0
        self._decided_frame = 0
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
        self._limit = 0
        self._ready = 0
        self._guarded = -1  # frame on which the present steering was looked at last
        self._followed = -1  # frame on which the plan was
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
        self.decisions = 0
        self.configure()

    def configure(self):
        """Take over parameters that may have been tuned.

        Margins and look-ahead are in the tables: they count from the next start.
        """
        c = self.config
        self.look_ahead = self.candidates.look_ahead
        self._swing = self.candidates.half_width + self.candidates.soft + self.candidates.half_length // 2
        self._worth.configure(c)
        self.windows.configure(c)
        self._changes = c.changes

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
        if self._ready & 7 == 0:
            self._tell()

    def _look(self, odometry):
        """The points as the body sees them now, those near the outline first, and the window of each."""
        env = self.candidates
        n = self.points.view(odometry.x >> 5, odometry.y >> 5, (odometry.heading + 50) // 100, self._x, self._y, self.look_ahead + env.half_length)
        self.windows.sort(self._x, self._y, n, env.soft + BAND_MM)
        self._near = self.windows.near
        self._n = n

    def _look_again(self):
        """The points as seen from where the decision began, in the order of the memory: which of them serve for a pair of moves must not hang on the side."""
        env = self.candidates
        worth = self._worth
        self._n = self.points.view(worth.x, worth.y, worth.heading, self._x, self._y, self.look_ahead + env.half_length)
        self._near = sort_near(self._x, self._y, self._n, env.half_width, env.half_length, env.soft + BAND_MM)

    def _current_free(self):
        k = self._k
        v = self._variant
        self._run(v, k, k + 1, 0)
        return self.free_of[v][k]

    def _promise_some(self, side):
        """Value the next candidates ahead to one side as if nothing were in the way, as many as a slice allows. True when all are done."""
        self._next = self._worth.promise(side, self.free_of[side], self._swept, self._score[side], self._next, self.af, self.ar)
        if self._next < self.candidates.count:
            return False
        self._next = 0
        return True

    def _run_best(self, side):
        """Sweep those candidates ahead to one side that promise most, as many as a slice allows. True when the best of them is known."""
        env = self.candidates
        scores = self._score[side]
        self._mirror(side)
        left = drop_behind(self._x, self._y, self._near, self._n, env.half_length + env.soft, self._swing)
        self._sweep.aim(left, self._near, 1, env.lengths[0])
        number = self._worth.keep_promises(self._sweep, self._x, self._y, left, self.free_of[side], self._soft, self._block, self._swept, scores, self._least)
        self._mirror(side)
        if number >= 0 and number != NOTHING:
            self._least = scores[number]
        return number >= 0

    def _run_some(self, variant):
        """Sweep and value the next candidates of one variant, as many as a slice allows. True when all are done."""
        env = self.candidates
        first = self._next
        if variant & 2 and first < env.astern_first:
            first = env.astern_first
        elif variant < 2 and env.ahead_end <= first < env.arcs:
            first = env.arcs
        last = first + in_a_slice(self._n) + 1
        if variant < 2 and first < env.ahead_end:
            last = min(last, env.ahead_end)
        last = min(last, env.count)
        self._run(variant, first, last, env.lengths[0])
        self._worth.score(
            variant, self.free_of[variant], self._soft, self._score[variant], first, last, 1, self.af, self.ar,
            self._backward if variant & 2 else 0,
        )  # fmt: skip
        self._next = last
        if last < env.count:
            return False
        self._next = 0
        return True

    def _run(self, variant, first, last, floor):
        """Sweep candidates first..last-1 in one variant."""
        self._mirror(variant)
        left = self._n
        if last - first > 2:
            env = self.candidates
            left = drop_behind(self._x, self._y, self._near, left, env.half_length + env.soft, self._swing)
        self._sweep.run(self._x, self._y, left, self._near, first, last, 1, floor, self.free_of[variant], self._soft, self._block)
        self._mirror(variant)

    def _mirror(self, variant):
        """Turn the points about for a variant, or back."""
        if variant & 1:
            mirror(self._x, self._n)
        if variant & 2:
            mirror(self._y, self._n)

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
            # For single moves it need not be as fresh as for pairs: these are made where it is narrow.
            single = self.why in _SINGLE
            fits = self._field_fits(odometry, _FIT, 64) if single else self._field_fits(odometry)
            if self._plan == 0 and (self._ready < 20 or self._renewing or not fits):
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
            self._here = self._worth.stand(odometry)
            # Where two moves were needed last, all candidates are likely to be.
            self._stage = _PROMISE if single else _RIGHT
            self._next = 0
            self._least = NOTHING
            return False
        env = self.candidates
        if stage <= _BEST_OTHER:
            # First to the side that was taken last: it is likely to set the measure for the other.
            side = (self._variant ^ (stage >= _PROMISE_OTHER)) & 1
            best_stage = stage == _BEST or stage == _BEST_OTHER
            if self._run_best(side) if best_stage else self._promise_some(side):
                self._stage = stage + 1
            return False
        if stage == _CHOOSE or stage == _CHOOSE_OF_ALL:
            if self._choose_one():
                self._stage = _IDLE
                self._decided_travel = odometry.travel256
                self._decided_frame = self._ready
                self.free = self._current_free()
                return self._publish()
            # This takes longer. With little way left the robot stands meanwhile.
            self._stage = stage + 1
            decided = self.v != 90 and self.free < env.lengths[2]
            if decided:
                self.v = 90
                self.why = reasons.LOOKING
                self._plan = 0
                self._tell()
            # Made while the robot stands it is fresh however long this takes, or the same would begin again and again.
            if not self._field_fits(odometry, _FRESH, 0xFFFF):
                self._stage = _FIELD
            return decided
        if stage <= _BACK_LEFT:
            if self._run_some(stage - (_RIGHT if stage < _CHOOSE_OF_ALL else _BACK_RIGHT - 2)):
                self._stage = stage + 1
                if stage == _BACK_LEFT:
                    self._look_again()
                    self._pairs.begin()
            return False
        pairs = self._pairs
        if stage == _PICK:
            if pairs.pick(self._score):
                self._stage = _EXPAND if pairs.count else _SETTLE
            return False
        if stage == _EXPAND:
            self.points_count = -1  # their arrays serve as room for points as seen from elsewhere
            if pairs.expand(self._x, self._y, self._n, self.points_x, self.points_y, self._score[0], self.free_of, self._swing):
                self._stage = _SETTLE
            return False
        self._stage = _IDLE
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

    def _field_fits(self, odometry, part=_FRESH, frames=40):
        """Whether the field in use still fits: the robot has not moved by look-ahead / part since, hardly turned, and it is no older than that."""
        if not self.field.ready:
            return False
        dx = (odometry.x - self._field_x) >> 8
        dy = (odometry.y - self._field_y) >> 8
        turned = (odometry.heading - self._field_heading) % 360000
        if turned > 180000:
            turned = 360000 - turned
        near = self.look_ahead // part
        return dx * dx + dy * dy < near * near and turned < 8000 and self._ready - self._field_frame < frames

    def _left(self, odometry):
        """What is left of the move of the plan that is being driven, mm."""
        return (((self._until - odometry.travel256) & 0x3FFFFFF ^ 0x2000000) - 0x2000000) >> 8

    def _choose_one(self):
        """Take the best single move if it gets on well."""
        env = self.candidates
        value = NOTHING
        number = variant = 0
        for v in (0, 1):
            scores = self._score[v]
            one = best(scores, 0, env.count, 1)
            if one != NOTHING and (scores[one] < value or (scores[one] == value and v == self._variant)):
                value = scores[one]
                number = one
                variant = v
        if value == NOTHING:
            return False
        # It may fall short of what the field promises, but one that just drives away from the way on falls short by twice its length.
        if value > self._here + min(env.lengths[1], env.lengths[number % LENGTHS]):
            return False
        k = number // LENGTHS
        if self.free_of[variant][k] < self.config.avoid_accept:
            return False
        self._plan = 0
        self._take(variant, k)
        self._limit = self.look_ahead
        if k == env.arcs:
            self.why = reasons.ON
        elif k > env.arcs:
            self.why = reasons.CRAB
        else:
            self.why = reasons.BEND
        return True

    def _take(self, variant, k):
        self._variant = variant
        self._k = k
        self.af = self.candidates.af_of(variant, k)
        self.ar = self.candidates.ar_of(variant, k)
        self.free = self.free_of[variant][k]

    def _settle(self, odometry):
        """Drive the best pair of moves, or the least bad single one, or stand."""
        pairs = self._pairs
        if self._reversals >= _PATIENCE and self._leave(odometry):
            return
        if pairs.count:
            at = pairs.chosen  # the best single one, where no pair was found
            v = pairs.variant[at]
            self._take(v, pairs.candidate[at])
            self._plan = 1
            self._limit = pairs.length[at]
            self._until = odometry.travel256 + (self._limit << 8)
            if pairs.found:
                self.why = reasons.TURNED if v & 2 else reasons.LOOKING
            else:
                self.why = reasons.BACK if v & 2 else reasons.BEND
            return
        self._plan = 0
        # Nothing of the shortest travel: whatever gives most way, if any.
        most = self._longest((0, 1, 2, 3), 11)
        if most:
            self._limit = most - 6
            self.why = reasons.CENTRE
        else:
            self._limit = 0
            self.free = 0
            self.why = reasons.BOXED

    def _longest(self, variants, least):
        """Take the candidate that is free farthest, of several the first; returns how far, mm, 0 if none is farther than least."""
        found = -1
        for v in variants:
            free = self.free_of[v]
            for k in range(self.candidates.count):
                if free[k] > least:
                    least = free[k]
                    variant = v
                    found = k
        if found < 0:
            return 0
        self._take(variant, found)
        return least

    def _leave(self, odometry):
        """To and fro on the same ground has led nowhere: go back or on as far as anything goes, and look from there."""
        env = self.candidates
        most = self._longest((2, 3, 0, 1), env.lengths[2])
        if not most:
            return False
        self._pairs.found = False  # no second move
        self._plan = 1
        self._limit = min(most - env.lengths[0], env.lengths[3])
        self._until = odometry.travel256 + (self._limit << 8)
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
        third = self.candidates.half_length * 2 // 3
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
        env = self.candidates
        if left <= 4:
            pairs = self._pairs
            if self._plan == 1 and pairs.found:
                v = pairs.second_variant
                k = pairs.second_candidate
                self._run(v, k, k + 1, 0)
                if self.free_of[v][k] >= min(pairs.second_length, env.lengths[1]):
                    self._take(v, k)
                    self._plan = 2
                    self._limit = pairs.second_length
                    self._until = odometry.travel256 + (self._limit << 8)
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
        env = self.candidates
        v = self._variant
        k = self._k
        room = self.free
        if self._limit < room:
            room = self._limit
        cruise = self.config.drive_cruise - 90
        # Stop within the free way: it takes about speed / 10 mm.
        speed = (60 + room * 3) * 90 // self.config.motors_full_speed
        if speed > cruise:
            speed = cruise
        if self._soft[k] < env.lengths[1] and speed > cruise * 4 // 5:
            speed = cruise * 4 // 5
        if 0 < self.windows.urgent <= RED and speed > cruise // 2:
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
        self.window = self.windows.urgent
        self.zone = self.windows.zone()
        self.mode = mode_of(self.af, self.ar)
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
