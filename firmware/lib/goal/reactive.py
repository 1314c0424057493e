"""What the two reactive methods of paper C share: a direction that is wanted becomes wheels.

Up to 60 degrees off the nose it is a crab, up to 80 for as long as it leads on without a turn to and fro; beyond that the body turns, on the spot where its circle is free, else AF = -AR. Whatever it is, the swept test says how far it is
free, and so how fast; the guard looks at every frame. Takes the place of planner/decision.py in Avoid while it is chosen.
"""

from micropython import const

from avoid import Avoid
from core.trig import cos14, sin14

_BODY_ZERO = const(8192)
_STRAIGHT = const(60)  # candidates: the strips begin here, straight ahead; the last that is 60 degrees or less
_LAST_CRAB = const(66)
_TURNS_FROM = const(181)  # 1024 / tan(80 deg): a crab of 70 degrees still gets there
_POINTS_THERE = const(2813)  # 1024 / tan(20 deg)
_ALIGNED = const(60)  # 0.1 deg
_STRIP = const(8)  # words of a strip
_TURNS = (53, 46, 38, 29)  # AF = -AR, the sharpest first
_EVERY = const(4)  # frames between two decisions
_LEAST = const(60)  # mm of way that are worth driving
_SPIN = const(45)  # mm: so slowly it turns on the spot
_BACK = const(200)
_STANDS = const(90)
_ON = const(1)  # reasons.ON
_BEND = const(2)  # reasons.BEND
_CRAB = const(4)  # reasons.CRAB
_BACKING = const(7)  # reasons.BACK
_BOXED = const(11)  # reasons.BOXED
_BLOCKED = const(17)  # reasons.BLOCKED


class Reactive:
    """avoid: the Avoid. field.py and behaviour.py say where to: wanted() -> True, fx, fy being the direction, right and ahead; False: back.

    align: by how much it is to turn first, 0.1 deg. x, y: the target as seen from the body, mm; last: it is the goal
    """

    stage = 0
    busy = False
    lines_up = True

    def __init__(self, avoid):
        self._avoid = avoid
        self._kept = kept = avoid.decision
        self.cost_to_go = kept.cost_to_go
        self.move_cost = kept.move_cost
        self.plan = avoid.plan
        self.ways = avoid.ways
        self.spins = False
        self._frame = self.tx = self.ty = self.x = self.y = self.fx = self.fy = self.align = 0
        self.last = self.searches = False
        self._turns = False
        env = avoid.candidates
        self.half_width = env.half_width
        self.half_length = env.half_length
        self._circle = env.half_width**2 + env.half_length**2
        avoid.decision = self
        avoid.guard = self.guard

    def begin(self):
        """A new goal."""
        self.plan.moves = 0

    def end(self):
        """Another method takes over."""
        self._avoid.decision = self._kept
        del self._avoid.guard

    def aim(self, dx, dy, last, odometry):
        """What is steered for lies dx, dy mm off, on the odometry's floor."""
        self.tx = odometry.x + (dx << 8)
        self.ty = odometry.y + (dy << 8)
        self.last = last

    def step(self, odometry):
        """The decision, in one slice. True when there is one."""
        ways = self.ways
        if ways.frames - self._frame < _EVERY:
            return False
        self._frame = ways.frames
        ways.see(odometry)
        heading = odometry.heading // 100
        s = sin14(heading)
        c = cos14(heading)
        dx = (self.tx - odometry.x) >> 8
        dy = (self.ty - odometry.y) >> 8
        self.x = (dx * c - dy * s) >> 14
        self.y = (dx * s + dy * c) >> 14
        plan = self.plan
        plan.moves = 0
        self.spins = False
        if not self.wanted():
            self._drive(2, _STRAIGHT, _BACK, _BACKING)
            return True
        fx = abs(self.fx)
        fy = self.fy
        side = 1 if self.fx < 0 else 0
        # Once it turns, it turns until it points there; else either would begin the other again.
        self._turns = turns = fy * 1024 < fx * (_POINTS_THERE if self._turns else _TURNS_FROM) or fy <= 0
        if self.align > _ALIGNED or self.align < -_ALIGNED:
            side = 1 if self.align < 0 else 0
            turns = self.clear()
        if turns:
            self._turn(side)
            return True
        # The crab that points there best
        strips = self._avoid.candidates.strips
        best = _STRAIGHT
        most = -1
        for k in range(_STRAIGHT, _LAST_CRAB + 1):
            b = (k - _STRAIGHT) * _STRIP
            along = (fx * strips[b] + fy * strips[b + 1]) >> 10
            if along > most:
                most = along
                best = k
        reach = max(abs(self.x), abs(self.y)) if self.last else 900
        if not self._drive(side, best, reach, _CRAB if best > _STRAIGHT else _ON):
            # Blocked: the crabs next to it, then turning towards it
            for k in (best + 1, best - 1, best + 2, best - 2):
                if _STRAIGHT <= k <= _LAST_CRAB and self._drive(side, k, reach, _CRAB):
                    return True
            self._turn(side)
        return True

    def _drive(self, mirroring, candidate, reach, why):
        """Take a candidate if it is free for a while; else stand."""
        plan = self.plan
        plan.take(mirroring, candidate)
        if plan.look() < _LEAST:
            plan.stand(_BOXED)
            return False
        plan.v = _STANDS + 1
        plan.limit = reach
        plan.why = why
        return True

    def _turn(self, side):
        """Turn to a side: on the spot, or as sharply as there is room for, or back a little."""
        plan = self.plan
        if self.clear():
            plan.take(side, _STRAIGHT)
            plan.af = -900 if side else 900
            plan.ar = -plan.af
            plan.free = plan.limit = _SPIN
            plan.why = _BEND
            self.spins = True
            return
        for k in _TURNS:
            if self._drive(side, k, _BACK, _BEND):
                return
        self._drive(2, _STRAIGHT, _BACK, _BACKING)

    def clear(self):
        """Whether the circle in which the body turns on the spot is free."""
        ways = self.ways
        px = ways.x
        py = ways.y
        circle = self._circle + 20000  # some 25 mm more
        for k in range(ways.n):
            x = px[k] - _BODY_ZERO
            y = py[k] - _BODY_ZERO
            if -400 < x < 400 and -400 < y < 400 and x * x + y * y < circle:
                return False
        return True

    def guard(self, odometry, speed):
        """As Avoid.guard; turning on the spot the whole circle has to be free."""
        avoid = self._avoid
        if not self.spins:
            return Avoid.guard(avoid, odometry, speed)
        self.ways.see(odometry)
        if self.clear():
            return False
        self.spins = False
        self.plan.stand(_BLOCKED)
        avoid.observe(odometry, _BLOCKED, avoid.af, avoid.ar, _STANDS)
        return True

    def off(self, k):
        """How far point k is from the body's outline, mm; dx, dy become the way there."""
        ways = self.ways
        x = ways.x[k] - _BODY_ZERO
        y = ways.y[k] - _BODY_ZERO
        self.dx = x = max(x - self.half_width, 0) if x > 0 else min(x + self.half_width, 0)
        self.dy = y = max(y - self.half_length, 0) if y > 0 else min(y + self.half_length, 0)
        x = abs(x)
        y = abs(y)
        return max(x, y) + (min(x, y) * 3 >> 3)
