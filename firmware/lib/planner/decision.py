"""Which move: the decision, made in slices.

One step of look-ahead: a move is one of the travels of a candidate steering; its cost is its length plus the cost to go from where it ends
(move_cost.py), if the points allow it. The cost of a move without any points is a lower bound of what it is with them; so the candidates are
checked best first, and as soon as the best is known the others need not be. Where no single move gets on well, all candidates are checked, backward
ones too, and the best moves are each followed by a second one (two_step.py).

Source: papers A section 4 and B section 3; the cost to go and the second move are this project's own.
"""

from time import ticks_diff

from micropython import const

from planner.candidates import LENGTHS
from planner.cost_grid import fill
from planner.move_cost import NEAR, NOTHING, best, in_a_slice

_ONE_WAY = const(8)  # of Decision.side: only the way that the robot goes was looked at
_SLACK = const(150)  # mm that two moves may cost more than one
_PATIENCE = const(5)  # times backing up on the same ground
_CHOSEN_US = const(76_000)  # as long a single move is left alone

# What a stage gives back: the stage that comes next, by its place in Decision.STAGES.
COST_TO_GO = const(0)
REST = const(1)
_BOUND = const(2)
_CHECK_BEST = const(3)
CHOOSE = const(4)
_CHECK_ALL = const(5)
_FIRST_MOVES = const(6)
_SECOND_MOVES = const(7)
_SETTLE = const(8)

# How far the robot may have gone since the cost to go was begun, in parts of the look-ahead, and how old it may be to serve once more.
_FRESH = const(10)
_FRESH_US = const(379_000)
_FIT = const(6)  # single moves are made where it is wide: it need not be as fresh
_FIT_US = const(606_000)
_NO_AGE = const(0x1FFFFFFF)
_FRESH_TURN = const(7999)  # 0.001 deg
_LATE = const(4)  # ... where making it took longer than that: it serves once, whatever its age
_LATE_TURN = const(20_000)

# planner/reasons.py
_ON = const(1)  # reasons.ON
_BEND = const(2)  # reasons.BEND
_CENTRE = const(3)  # reasons.CENTRE
_CRAB = const(4)  # reasons.CRAB
_LOOKING = const(6)  # reasons.LOOKING
_BACK = const(7)  # reasons.BACK
_TURNED = const(8)  # reasons.TURNED
_BOXED = const(11)  # reasons.BOXED
_AGAIN = const(16)  # reasons.AGAIN


def mark(place, odometry):
    """A place, array('i') of x, y (1/256 mm) and heading (0.001 deg), is where the robot is now."""
    place[0] = odometry.x
    place[1] = odometry.y
    place[2] = odometry.heading


def away(place, odometry, reach, heading):
    """Whether the robot is `reach` mm from the place or farther, or has turned by more than `heading` (0.001 deg) since."""
    # Modulo 8 m: the odometry's coordinates go round.
    dx = ((odometry.x - place[0] & 0x1FFFFF ^ 0x100000) - 0x100000) >> 8
    dy = ((odometry.y - place[1] & 0x1FFFFF ^ 0x100000) - 0x100000) >> 8
    turned = (odometry.heading - place[2]) % 360000
    return dx * dx + dy * dy >= reach * reach or min(turned, 360000 - turned) > heading


class Decision:
    """Fills in the plan, stage by stage. Laid out by planner/build.py.

    stage     number of the stage that comes next, of STAGES; busy: whether there is more to do at once
    scores    by mirroring: LENGTHS for each candidate, see move_cost.py; only while a decision is being made
    """

    def step(self, odometry):
        """One slice of the stage that is due. True when the plan holds a new decision."""
        self.decided = False
        self.stage = self.STAGES[self.stage](self, odometry)
        self.busy = self.renewing or self.stage != REST
        return self.decided

    def _make_cost_to_go(self, odometry):
        return COST_TO_GO if self._renew(odometry) else REST

    def _rest(self, odometry):
        """Nothing to decide as long as the plan holds, or the single move is fresh; else begin, with points and a cost to go that fit."""
        plan = self.plan
        ways = self.ways
        if self._resting(odometry):
            # A plan near its end: the next decision will want a cost to go that fits.
            if plan.moves and plan.left(odometry) < self.candidates.look_ahead >> 2 and (self.renewing or not self._fits(odometry, _FRESH, _FRESH_US)):
                self._renew(odometry)
            return REST
        single = plan.why in (_ON, _BEND, _CRAB, _BACK)
        if not plan.moves:
            fits = self._fits(odometry, _FIT, _FIT_US) if single else self._fits(odometry, _FRESH, _FRESH_US)
            if self.renewing or not fits or ways.frames < self.frames_first:
                if self.late and plan.v != 90:
                    # Driven on too far while it was made: the next one is made standing.
                    plan.stand(_LOOKING)
                    self.decided = True
                return COST_TO_GO
        if ways.seen != ways.frames:
            ways.see(odometry)
            if plan.moves:
                plan.look()
        if plan.moves:
            self.followed = ways.frames
            self.decided = plan.follow(odometry)
            return REST
        self.late = False
        self.here = self.move_cost.stand(odometry)
        for scores in self.scores:
            fill(scores, LENGTHS * self.candidates.count, NOTHING)
        self.next = 0
        self.least = NOTHING
        # Where two moves were needed last, all candidates are likely to be. Else the side taken last comes first: it sets the measure for the other.
        self.side = plan.mirroring if single else 0
        return _BOUND if single else _CHECK_ALL

    def _bound(self, odometry):
        """Lower bounds of the moves to one side, the way the robot goes."""
        side = self.side
        plan = self.plan
        self.next = self.move_cost.lower_bound(side, self.ways.free_of[side], self.scores[side], self.next, plan.af, plan.ar)
        if self.next < self.candidates.count:
            return _BOUND
        self.next = 0
        return _CHECK_BEST

    def _check_best(self, odometry):
        """Check the candidates ahead to one side best first, until the best of them is known."""
        side = self.side
        scores = self.scores[side]
        ways = self.ways
        ways.mirror(side)
        number = self.move_cost.best_first(ways, ways.free_of[side], scores, self.least)
        ways.mirror(side)
        if number < 0:
            return _CHECK_BEST
        if number != NOTHING:
            self.least = scores[number]
        if side == self.plan.mirroring:
            self.side = side ^ 1
            return _BOUND
        self.side = side | _ONE_WAY
        return CHOOSE

    def _choose(self, odometry):
        """Take the best single move if it gets on well."""
        plan = self.plan
        side = self.side
        if self._choose_one(side & 2 if side & _ONE_WAY else (side >> 1) - 1 << 1):
            self.travel = odometry.travel256
            self.chosen_us = odometry.now_us
            plan.look()
            self.decided = True
            return REST
        if side == 4:
            pose = self.move_cost
            self.ways.look(pose.x, pose.y, pose.heading)
            self.two_step.begin(self.here)
            return _FIRST_MOVES
        if side & _ONE_WAY:
            self.side = self.next = 0
        # This takes longer. With little way left, or on a slow chip, the robot stands meanwhile.
        if plan.v != 90 and (self.slow or plan.free < self.candidates.lengths[2]):
            plan.stand(_LOOKING)
            self.decided = True
        # A cost to go made while the robot stands is fresh however long this takes, or the same would begin again and again.
        return _CHECK_ALL if self._fits(odometry, _FRESH, _NO_AGE) else COST_TO_GO

    def _check_all(self, odometry):
        """Check and score all candidates, mirroring by mirroring: those ahead, then, if none of them gets on well, the others."""
        if not self.check_some(self.side):
            return _CHECK_ALL
        self.side += 1
        return _CHECK_ALL if self.side & 1 else CHOOSE

    def _first_moves(self, odometry):
        two_step = self.two_step
        if not two_step.choose_first():
            return _FIRST_MOVES
        return _SECOND_MOVES if two_step.count else _SETTLE

    def _second_moves(self, odometry):
        return _SETTLE if self.two_step.try_second() else _SECOND_MOVES

    def _settle(self, odometry):
        """Drive the best pair of moves, or the least bad single one, or stand."""
        plan = self.plan
        first = self.two_step
        self.decided = True
        lengths = self.candidates.lengths
        # To and fro on the same ground has led nowhere: go back or on as far as anything goes, and look from there.
        most = self.longest((2, 3, 0, 1), lengths[2]) if self.reversals >= _PATIENCE else 0
        if most:
            first.found = False  # no second move
            plan.begin(1, min(most - lengths[0], lengths[3]), odometry, _AGAIN)
            self.reversals = 0
        elif first.count:
            if first.alone != NOTHING and first.least > first.alone + _SLACK:
                # One that gets on by itself is not given up for two that end no better.
                first.found = False
                first.chosen = first.alone_at
            at = first.chosen  # the best single one, where no pair was found
            mirroring = first.mirroring[at]
            plan.take(mirroring, first.candidate[at])
            if first.found:
                why = _TURNED if mirroring & 2 else _LOOKING
            else:
                why = _BACK if mirroring & 2 else _BEND
            plan.begin(1, first.length[at], odometry, why)
        else:
            # Nothing of the shortest travel: whatever gives most way, if any.
            plan.moves = 0
            most = self.longest((0, 1, 2, 3), 11)
            plan.limit = most - 6
            plan.why = _CENTRE
            if not most:
                plan.stand(_BOXED)
        # How often has it backed up since it last got anywhere: a third of its length on, or 15 degrees round?
        if away(self.anchor, odometry, self.candidates.half_length * 2 // 3, 15000):
            mark(self.anchor, odometry)
            self.reversals = 0
        self.reversals += plan.mirroring >> 1
        # Anew for this one: checking others has moved the points about.
        plan.look()
        if not plan.limit:
            plan.free = 0
        return REST

    STAGES = (_make_cost_to_go, _rest, _bound, _check_best, _choose, _check_all, _first_moves, _second_moves, _settle)

    def _resting(self, odometry):
        """Whether there is nothing to decide: a plan that has been looked at on this frame, or a single move that is still fresh.

        The guard watches both, and a few millimetres on nothing has changed.
        """
        plan = self.plan
        if plan.moves:
            return self.followed == self.ways.frames and not plan.arrived(odometry)
        if plan.v == 90:
            return False
        rolled = (odometry.travel256 - self.travel) & 0x3FFFFFF
        return rolled < self.candidates.look_ahead * 5 and ticks_diff(odometry.now_us, self.chosen_us) < _CHOSEN_US

    def _renew(self, odometry):
        """One slice of the next cost to go; False after the last. It cannot be asked before."""
        if not self.renewing:
            mark(self.made_at, odometry)
            self.made_us = odometry.now_us
        self.renewing = not self.cost_to_go.step(odometry, self.map)
        if not self.renewing:
            self.slow = self.late = ticks_diff(odometry.now_us, self.made_us) > _FRESH_US
        return self.renewing

    def _fits(self, odometry, part, age_us):
        """Whether the cost to go still fits: the robot has not moved by look-ahead / part since it was begun, hardly turned, and it is not older.

        One that took long to make serves once, however old, if the robot has not gone much farther: it would else be begun again and again.
        """
        near = self.candidates.look_ahead // part
        turned = _FRESH_TURN
        if self.late:
            age_us = _NO_AGE
            near = max(near, self.candidates.look_ahead // _LATE)
            turned = _LATE_TURN
        return self.cost_to_go.builds > 1 and not away(self.made_at, odometry, near, turned) and ticks_diff(odometry.now_us, self.made_us) < age_us

    def check_some(self, mirroring):
        """Check and score the next candidates of one mirroring, as many as a slice allows. True when all are done."""
        env = self.candidates
        ways = self.ways
        plan = self.plan
        first = self.next
        count = env.count
        if mirroring & 2:
            if first < env.astern_first:
                first = env.astern_first
        elif first >= env.ahead_end:
            first = max(first, env.arcs)
        else:
            count = env.ahead_end
        last = min(first + in_a_slice(ways.n + NEAR * ways.near) + 1, count)
        ways.check(mirroring, first, last, env.lengths[0])
        self.move_cost.score(
            mirroring, ways.free_of[mirroring], ways.soft, self.scores[mirroring], first, last, 1, plan.af, plan.ar,
            self.backward if (mirroring ^ plan.mirroring) & 2 else 0,
        )  # fmt: skip
        self.next = last if last < env.count else 0
        return not self.next

    def _choose_one(self, way):
        """Take the best single move, ahead (way 0) or backward (2). False if it does not get on well."""
        env = self.candidates
        plan = self.plan
        value = NOTHING
        number = mirroring = 0
        for side in range(way, way + 2):
            scores = self.scores[side]
            one = best(scores, 0, env.count, 1)
            if one != NOTHING and (scores[one] < value or (scores[one] == value and side == plan.mirroring)):
                value = scores[one]
                number = one
                mirroring = side
        k = number // LENGTHS
        # It may fall short of what the cost to go says, but one that just drives away from the way out falls short by twice its length.
        if (
            value == NOTHING
            or value > self.here + min(env.lengths[1], env.lengths[number % LENGTHS])
            or self.ways.free_of[mirroring][k] < self.config.avoid_accept
        ):
            return False
        plan.take(mirroring, k)
        plan.moves = 0
        plan.limit = env.look_ahead
        plan.why = _BACK if way else _BEND if k < env.arcs else _CRAB if k > env.arcs else _ON
        return True

    def longest(self, mirrorings, least):
        """Take the candidate that is free farthest, of several the first; returns how far, mm, 0 if none is farther than least."""
        found = -1
        mirroring = 0
        for one in mirrorings:
            free = self.ways.free_of[one]
            for k in range(self.candidates.count):
                if free[k] > least:
                    least = free[k]
                    mirroring = one
                    found = k
        if found < 0:
            return 0
        self.plan.take(mirroring, found)
        return least
