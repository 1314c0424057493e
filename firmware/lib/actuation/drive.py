"""(AF, AR, V) -> wheels: turned together, before and while the robot moves, and an estimate of what they do now.

A small change of steering while driving goes through the space of (AF, AR): each servo period both move on by the same fraction, such that no
wheel turns faster than its servo can. So all wheels point round one turning centre all the way.

A large change (a wheel turns farther than servos.swing, or changes its direction of rolling) would skid: the robot stops, all wheels swing
at once, and it drives on when the slowest has arrived.

What the wheels do now is what the servos were told `servos.latency` ago, and what the motors were told through a first-order lag of
`motors.time_constant`. A swinging wheel turns at servos.rate. There is no sensor in any wheel; the twin of the robot and the real one are
to be matched by these three numbers.
"""

from array import array
from time import ticks_add, ticks_diff

import micropython
from micropython import const

from actuation.outputs import Outputs
from steering import Steering

_STANDS = const(512)  # slow enough for the wheels to swing: V - 90 = 2, in 1/256
_HISTORY = const(32)  # set points remembered; a power of two, more than 200 ms of 10 ms periods
_MOST_PERIODS = const(50)


@micropython.viper
def _largest_change(one: ptr16, other: ptr16, count: int) -> int:
    largest = 0
    k = 0
    while k < count:
        change = (one[k] ^ 0x8000) - (other[k] ^ 0x8000)
        if change < 0:
            change = 0 - change
        if change > largest:
            largest = change
        k += 1
    return largest


@micropython.viper
def _follow(positions: ptr16, goals: ptr16, count: int, step: int) -> int:
    """Move each position towards its goal by at most `step`; return the largest distance left."""
    largest = 0
    k = 0
    while k < count:
        position = (positions[k] ^ 0x8000) - 0x8000
        left = ((goals[k] ^ 0x8000) - 0x8000) - position
        move = left
        if move > step:
            move = step
        elif move < 0 - step:
            move = 0 - step
        positions[k] = (position + move) & 0xFFFF
        left -= move
        if left < 0:
            left = 0 - left
        if left > largest:
            largest = left
        k += 1
    return largest


class Drive:
    """Drives the wheels of one robot.

    axles: from core.axles.lay_out(). The chips and output_enable: see Outputs.

    Everything is off after construction. The first update() sets the chips up, switches the outputs on with all wheels straight, and waits until
    the wheels must have arrived from wherever they stood.

    af, ar          estimate of the steering now, 0.1 deg; `steering` is solved for it
    v256            estimate of the speed of the fastest wheel, V - 90 in 1/256, mean of the servo period that has begun
    turning         the robot stands, or is stopping, because its wheels have to swing
    aim             Steering of the angles the servos were told last; like `steering` another object after an update(), so do not keep it
    restarts        how often the chips were set up: more than once, and they had been lost
    told_v256       likewise, what the motors were told last
    ok, fault       False, and why, while a chip does not answer: all outputs are off then
    """

    def __init__(self, axles, servo_chip, motor_left, motor_right, output_enable, config):
        from actuation.wiring import drive

        drive(self, [Steering(axles) for _ in range(4)], Outputs(servo_chip, motor_left, motor_right, output_enable, config), config)
        self._derive()

    @property
    def ok(self):
        return self.outputs.ok

    @property
    def fault(self):
        return self.outputs.fault

    def command(self, af, ar, v):
        """Steer AF, AR (0.1 deg) and drive at V (0 .. 180, 90 stops). False, and the robot stops as it is steered, if a wheel cannot turn so far."""
        goal = self._goal
        if not self._possible or af != goal.af or ar != goal.ar:
            before_af, before_ar = goal.af, goal.ar
            self._possible = goal.solve(af, ar) and self._beyond(goal) < 0
            if not self._possible:
                goal.solve(before_af, before_ar)
                self._goal_v256 = 0
                return False
        if v > 180:
            v = 180
        elif v < 0:
            v = 0
        self._goal_v256 = (v - 90) * 256
        if self._pointed is not None and (v != 90 or goal.af != self.aim.af or goal.ar != self.aim.ar):
            self._pointed = None
            self._doubt()
        return True

    def beyond(self, af, ar):
        """Index of the first wheel that such a steering would turn farther than its limits, -1 if none."""
        trial = self._trial
        trial.solve(af, ar)
        return self._beyond(trial)

    def _beyond(self, steering):
        config = self._config
        for k in range(self._wheels):
            if not config.servos_low[k] <= steering.angles[k] <= config.servos_high[k]:
                return k
        return -1

    def point(self, wheel, angle):
        """Turn one wheel alone, to find its trim and its limits; index of the wheel, angle in 0.1 deg, -900 .. 900.

        False unless the robot stands. The wheel goes back among the others with the next command that moves anything.
        """
        if self._goal_v256 or self.told_v256 or self.turning or not 0 <= wheel < self._wheels or not -900 <= angle <= 900:
            return False
        if self._pointed is None:
            self._pointed = array("h", self.aim.angles)
        self._pointed[wheel] = angle
        return True

    def stop(self):
        """Motors off now, not with the next update(); the wheels stay as they are. Costs nothing while the motors are off."""
        if self.told_v256:
            self.halt()
        self._goal_v256 = 0

    def halt(self):
        """As stop(), whatever the motors were told: for when that is not sure any more."""
        self.outputs.motors_off()
        self.told_v256 = self._goal_v256 = 0

    def off(self):
        """Everything off, for good: the servos let go. Raises nothing."""
        self.outputs.off()
        self.told_v256 = self._goal_v256 = 0

    def due(self, now_us):
        """Whether update() has something to do."""
        return self._due < 0 or ticks_diff(now_us, self._due) >= 0

    def update(self, now_us):
        """Do what is due; call at least once a servo period. True when the set points moved on. Allocates nothing while all is well."""
        due = self._due
        if due < 0:
            due = now_us
        late = ticks_diff(now_us, due)
        if late < 0:
            return False
        period = self._period_us
        periods = 1
        if late >= period:
            # After a pause the estimate catches up, the set points do not.
            periods += late // period
            if periods > _MOST_PERIODS:
                periods = _MOST_PERIODS
                due = ticks_add(now_us, -(periods - 1) * period)
        self._due = ticks_add(due, periods * period)
        if self._changes != self._config.changes:
            self._derive()
        self._steer()
        v256 = self._accelerate()
        aim = self.aim
        outputs = self.outputs
        outputs.write(self._pointed or aim.angles, aim.shares, v256)
        if self.restarts != outputs.restarts:
            self.restarts = outputs.restarts
            self._doubt()
        self._estimate(periods)
        return True

    def _derive(self):
        """What a servo period makes of the live parameters."""
        config = self._config
        self._changes = config.changes
        self._possible = False  # the goal within the limits: looked at with the next command
        self.outputs.derive()
        period = self._period_us
        self._step = max(config.servos_rate * period // 100000, 1)  # 0.1 deg
        latency = config.servos_latency * 1000
        self._latency = latency // period
        self._latency256 = latency % period * 256 // period
        self._gain256 = min(512 * period // (2000 * config.motors_time_constant + period), 256)
        self._ramp = max(config.drive_acceleration * 23040 // config.motors_full_speed * period // 1000000, 1)

    def _steer(self):
        if self._swinging:
            self._swing_on()
            return
        goal, aim = self._goal, self.aim
        if goal.af == aim.af and goal.ar == aim.ar:
            self.turning = False
            return
        if goal.folded == aim.folded:
            largest = _largest_change(goal.angles, aim.angles, self._wheels)
            if largest <= self._config.servos_swing * 10 and self._approach(goal, aim, largest):
                self.turning = False
                return
        self.turning = True
        if -_STANDS <= self.v256 <= _STANDS:
            self._begin_swing()

    def _approach(self, goal, aim, largest):
        """Move the set point towards the goal as far as the slowest wheel allows. False where the way leads past a fold or a turning centre.

        largest: by how much a wheel changes on the whole way, 0.1 deg, which is the first measure of how much of it can be gone now.
        """
        step = self._step
        trial = self._trial
        if largest <= step:
            trial.solve(goal.af, goal.ar)
        else:
            af, ar = aim.af, aim.ar
            way_af = goal.af - af
            way_ar = goal.ar - ar
            way = max(abs(way_af), abs(way_ar))
            half = way >> 1
            slow = step - (step >> 5)  # that much slack spares most second guesses
            part = way
            change = largest
            while change > step:
                part = part * slow // change
                if part == 0:
                    return False
                trial.solve(af + (way_af * part + half) // way, ar + (way_ar * part + half) // way)
                if trial.folded != aim.folded:
                    return False
                change = _largest_change(trial.angles, aim.angles, self._wheels)
        self.aim = trial
        self._trial = aim
        return True

    def _begin_swing(self):
        aim = self.aim
        if not self._swinging:
            # Until now no wheel was told more than it does in a period.
            self._swinging = True
            _follow(self._positions, aim.angles, self._wheels, 1800)
        aim.solve(self._goal.af, self._goal.ar)
        self._delay = self._latency + 1

    def _swing_on(self):
        goal, aim = self._goal, self.aim
        if goal.folded != aim.folded or _largest_change(goal.angles, aim.angles, self._wheels) > self._config.servos_swing * 10:
            self._begin_swing()
        if self._delay:
            self._delay -= 1
        elif _follow(self._positions, aim.angles, self._wheels, self._step) == 0:
            self._swinging = False
            self.turning = False
            for k in range(0, 2 * _HISTORY, 2):
                self._past[k] = aim.af
                self._past[k + 1] = aim.ar

    def _accelerate(self):
        """The motors' next set point."""
        goal = self._goal_v256
        speed = self.told_v256
        if goal == 0 or self.turning or not self.outputs.ok:
            speed = 0
        elif goal > 0 > speed or goal < 0 < speed:
            speed = 0  # a reversal passes through off
        elif goal > speed:
            speed += self._ramp
            if speed > goal:
                speed = goal
        else:
            speed -= self._ramp
            if speed < goal:
                speed = goal
        self.told_v256 = speed
        return speed

    def _doubt(self):
        """Each wheel may stand anywhere, at worst at the far end."""
        for k in range(self._wheels):
            self._positions[k] = 900 if self.aim.angles[k] < 0 else -900
        self.told_v256 = 0
        self.outputs.motors_off()
        self.turning = True
        self._swinging = True
        self._begin_swing()

    def _estimate(self, periods):
        """So many servo periods of the wheels' life."""
        past = self._past
        now = self._now
        af, ar = past[now], past[now + 1]
        # Swinging wheels have no common centre; the little that the robot still rolls, it rolls mostly as it was steered before.
        if not self._swinging:
            aim = self.aim
            af, ar = aim.af, aim.ar
        speed = self._speed
        goal = self.told_v256 << 8
        gain = self._gain256
        before = speed
        while periods:
            now = (now + 2) & (2 * _HISTORY - 1)
            past[now] = af
            past[now + 1] = ar
            before = speed
            speed += ((goal - speed) >> 4) * gain >> 4
            periods -= 1
        self._now = now
        self._speed = speed
        self.v256 = (before + speed + 256) >> 9  # the mean of the period that begins now

        now = (now - 2 * self._latency) & (2 * _HISTORY - 1)
        af, ar = past[now], past[now + 1]
        f = self._latency256
        if f:
            now = (now - 2) & (2 * _HISTORY - 1)
            af = (af * (256 - f) + past[now] * f + 128) >> 8
            ar = (ar * (256 - f) + past[now + 1] * f + 128) >> 8
        steering = self.steering
        if af != steering.af or ar != steering.ar:
            self.af = af
            self.ar = ar
            trial = self._trial
            if af == trial.af and ar == trial.ar:  # with a latency of one period it is what the servos were told before
                self.steering = trial
                self._trial = steering
            else:
                steering.solve(af, ar)
