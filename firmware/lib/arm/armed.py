"""The outputs of a robot with an arm: those of the wheels, unchanged, and after them the arm's, on channels of the servos' chip that the wheels leave free.

Only loaded where there is an arm.json. Its joints go from one knot, angles and speeds at a time, to the next by a cubic polynomial, in integers; every movement is of
that kind: a trajectory from the flash knot by knot, and a slow one to a pose as a single stretch between two knots at rest.

state   OFF     no pulses: limp, and nobody knows where it stands
        WAKES   pulses begin, joint after joint, at the pose in which it lies without power
        HOLDS   stands at `angles`
        MOVES   goes slowly to a pose
        PLAYS   a trajectory
why     what froze it last, where it was: by number in requests.py; 0 nothing
angles  set points, 0.01 deg, of the joints and then of those beside the plane

It moves only while safety has no fault, the wheels stand (or arm.json allows both), and whoever moves it says so again and again. Else it stays where it is: going limp it
would fall.
"""

from time import ticks_add, ticks_diff, ticks_us

from micropython import const

from actuation.outputs import Outputs
from link.telemetry import copy

_OFF = const(0)
_WAKES = const(1)
_HOLDS = const(2)
_MOVES = const(3)
_PLAYS = const(4)

_HELD = const(1)  # why
_FAULT = const(2)
_LINK = const(3)
_WHEELS = const(4)
_CHIPS = const(5)

_SILENCE_US = const(300_000)
_TOLD_US = const(100_000)
_WAKE = const(15)  # servo periods between one joint's first pulse and the next one's
_ARM = const(0x20)  # type of the message
_AT = const(8)


class Armed(Outputs):
    """See above. Put in the place of a Drive's Outputs by arm/build.py, which sets its fields."""

    def write(self, angles, shares, v256):
        good = super().write(angles, shares, v256)
        if self.state:
            try:
                self._go_on(v256)
            except OSError as error:
                self._fail(error)
        return good

    def begin(self):
        """As ever; but a servo chip that is well is left alone where its output enable is its own, for else the arm would fall."""
        chips = self._chips
        if self._kept:
            self._chips = chips[1], chips[1], chips[2]
        else:
            self._limp()
        good = super().begin()
        self._chips = chips
        return good

    def freeze(self, why):
        """Stay where it is."""
        if self.state > _HOLDS:
            self.state = _HOLDS
            self.why = why
            self._close()
            if why != _HELD:
                self.link.log(1, "the arm is frozen where it was")

    def off(self):
        """Everything off, for good."""
        self._kept = False
        self._limp()
        self._switch(False)
        super().off()

    def stop(self):
        """What the link's stop does now."""
        self.freeze(_FAULT if self.link.safety.fault else _HELD)
        self._link_stop()

    def again(self, data, now_us, robot):
        """What the link tells again and again, and the arm."""
        length = self._link_again(data, now_us, robot)
        if not length and ticks_diff(now_us, self._told_us) >= _TOLD_US:
            self._told_us = now_us
            data[3] = _ARM
            data[_AT] = self.state
            data[_AT + 1] = self.why
            data[_AT + 2] = count = len(self.angles)
            copy(self.angles, 0, 2 * count, data, _AT + 3)
            length = 3 + 2 * count
        return length

    def _go_on(self, v256):
        now = ticks_us()
        state = self.state
        if state > _HOLDS:
            self._move(now, v256)
        elif state == _WAKES:
            self.woken += 1
            if self.woken >= _WAKE * len(self.angles):
                self.state = _HOLDS
        pulse = self._pulse
        lines = self._lines_of_arm
        sent = self.sent
        k = 0
        for angle in self.angles:
            count = (lines[3 * k] + angle * lines[3 * k + 1]) >> 15
            if sent[k] != count and (state != _WAKES or self.woken >= _WAKE * k):
                pulse[0] = lines[3 * k + 2]
                pulse[3] = count & 0xFF
                pulse[4] = count >> 8
                self.servo.send(pulse)
                sent[k] = count
            k += 1

    def _move(self, now, v256):
        why = 0
        if self.link.safety.fault:
            why = _FAULT
        elif v256 and not self.while_driving:
            why = _WHEELS
        elif ticks_diff(now, self.heard_us) > _SILENCE_US:
            why = _LINK
        if why:
            self.freeze(why)
            return
        while not self._between(ticks_diff(now, self.began_us)):
            self.began_us = ticks_add(self.began_us, self.after[0] * 1000)
            self.before, self.after = self.after, self.before
            if not self.file or self.file.readinto(self.after) < 2 * len(self.after):
                self.state = _HOLDS
                self._close()
                return

    def _between(self, elapsed_us):
        """Set points for so long after the knot `before`; False if `after` was reached, whose angles they are then."""
        before, after = self.before, self.after
        span = after[0]
        elapsed_us += self._config.servos_latency * 1000  # the servos are late by that
        s = 4096
        if elapsed_us < span * 1000:
            s = (elapsed_us >> 6) * 4096 // (span * 125 >> 3)
        s2 = s * s >> 12
        s3 = s2 * s >> 12
        a = 3 * s2 - 2 * s3
        b = s3 - 2 * s2 + s
        c = s3 - s2
        angles = self.angles
        k = 0
        for at in range(1, len(before), 2):
            first = before[at]
            slope = (before[at + 1] * span // 100 * b + after[at + 1] * span // 100 * c) >> 12
            angles[k] = first + ((after[at] - first) * a >> 12) + slope
            k += 1
        return s < 4096

    def _close(self):
        if self.file:
            self.file.close()
            self.file = None

    def _limp(self):
        """There are no pulses any more."""
        if self.state:
            self._close()
            self.state = _OFF
            self.why = _CHIPS
            self.link.log(2, "the arm is without power: home switches it on, at the pose in which it lies")

    def _check(self, k):
        before = self.restarts
        bit = super()._check(k)
        if not k and before != self.restarts:
            self._limp()
        return bit

    def _fail(self, error):
        """Where the servos have an output enable of their own, and their chip is well, the arm stays where it is."""
        super()._fail(error)
        if self._own is not None:
            try:
                self._kept = self.servo.awake() and self._own_on
            except OSError:
                self._kept = False
            if not self._kept:
                self._switch(False)
        if not self._kept:
            self._limp()
        self.freeze(_CHIPS)

    def _set_enabled(self, enabled):
        super()._set_enabled(enabled)
        if enabled:
            self._switch(True)

    def _switch(self, on):
        """The servos' own output enable."""
        self._own_on = on
        if self._own is not None:
            self._own.value(0 if on else 1)
