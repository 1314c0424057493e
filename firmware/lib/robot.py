"""The robot's loop: one `step()`, in which nothing waits and nothing is allocated."""

from time import ticks_diff, ticks_us

from micropython import const

from core.unload import forget
from link import telemetry
from perception.odometry import Odometry

_STOPPED = const(12)  # reasons.STOPPED
_FAULT = const(13)  # reasons.FAULT
_START = const(18)  # reasons.START

_LIMITS = const(11)  # of safety/faults.py
_ABRUPT = const(10)  # V

_SLICES = const(6)  # of the decision before it waits for the next frame
_FRAME_US = const(15_000)  # between two frames, at the lidar's speed or slower
_LATE_US = const(200_000)  # a speed times more would not fit a small integer
_PART = const(2)  # place in the watchdog's note, and who is at work
_LIDAR = const(1)
_PLANNER = const(2)
_DRIVE = const(3)
_LINK = const(4)
_SCREEN = const(5)


class Robot:
    """The parts, joined; buses and pins were handed to them by core/start.py.

    avoid: Avoid; lidar: Lidar; drive: Drive; safety: Safety; health: Health; link: Link or None; screen: Screen or None; goal: Goal, where there is a map, or None.
    note, keep, feed: see safety/watchdog.py; until that has begun both do nothing. remember: safety.remember.Remember, or None.
    took_us: computing time of the slices of the latest decision.
    """

    def __init__(self, config, avoid, lidar, drive, safety, health, link=None, screen=None, goal=None):
        self.config = config
        self.avoid = avoid
        self.lidar = lidar
        self.drive = drive
        self.safety = safety
        self.health = health
        self.note = bytearray(b"GS\x00\x00")
        self.keep = len  # takes the bytes as well, and does nothing
        self.feed = bool
        self.remember = None
        self.link = link
        self.screen = screen
        self.goal = goal
        self.odometry = Odometry(config)
        self.trust = safety.trust
        self.took_us = 0
        self._slices_us = 0
        self._watched_us = 0  # when the way was looked at last
        self._slices = 0  # of the decision, which may still be made before the next frame
        self._owed = 0  # so many of them at least
        self._hand = None  # planner.hand.by_hand while it is needed
        self._by_hand = 0  # how far V may lie from 90 by the last frame

    def step(self):
        """Once round. Returns True if there is more to do at once: a frame was taken in, or a decision is under way.

        Whatever goes wrong in link or screen is counted and told. In what drives the robot, it stops it until a person starts it again.
        """
        note = self.note
        keep = self.keep
        now = ticks_us()
        busy = False
        try:
            busy = self._drive_on(now, note, keep)
        except Exception as error:
            self._fail(error)
        try:
            if self.link is not None:
                note[_PART] = _LINK
                keep(note)
                self.link.update(now, self)
            if self.screen is not None:
                note[_PART] = _SCREEN
                keep(note)
                self.screen.update(now, self, self.link)
            if self.remember is not None and not self.drive.told_v256:
                self.remember(self.safety.state)
        except Exception as error:
            self._survive(error)
        self.feed()
        return busy

    def _drive_on(self, now, note, keep):
        """A turn does one long thing: it takes in frames, or writes the chips, or works at the decision. So none takes longer than a frame of the
        lidar, and none is put off for ever: after a frame come the chips, if they are due, and a slice of the decision, then the next frame. True
        when the next turn should come at once.
        """
        lidar = self.lidar
        drive = self.drive
        avoid = self.avoid
        odometry = self.odometry
        link = self.link
        trust = self.trust
        goal = self.goal
        seen = busy = False
        owed = self._owed
        note[_PART] = _LIDAR
        keep(note)
        odometry.advance(now, drive)
        while not owed and lidar.poll(now):
            if link is not None:
                link.frame(lidar)
            if trust is not None:
                trust.frame(lidar, odometry, drive.told_v256)
            avoid.frame(lidar, odometry)
            if goal is not None:
                goal.frame(lidar, odometry)
            seen = True
        safety = self.safety
        due = drive.due(now) and not seen
        self._owed = 0
        if not safety.check(now) or goal is not None and goal.holds and safety.state == telemetry.AUTO:
            self._slices = 0
            self._stand(safety, seen)
        elif safety.state == telemetry.MANUAL:
            self._slices = 0
            if self._hand is None:
                drive.stop()  # loading takes longer than a turn
                from planner.hand import by_hand

                self._hand = by_hand
            elif seen:
                self._by_hand = most = self._hand(avoid, odometry, link.af, link.ar, link.v)
                if abs(drive.told_v256) > most + _ABRUPT << 8:
                    drive.stop()  # slowing down as gently as it is done otherwise would take too long
            most = self._by_hand
            self._command(link.af, link.ar, min(max(link.v, 90 - most), 90 + most))
        elif seen:
            note[_PART] = _PLANNER
            keep(note)
            self._watch_out(now)
            busy = True
            self._slices = _SLICES
            self._owed = 1 if drive.v256 else 2  # a robot that stands may be late
        elif self._slices:
            if due:
                busy = True
                self._owed = owed
            else:
                note[_PART] = _PLANNER
                keep(note)
                self._slices -= 1
                self._decide()
                busy = avoid.decision.busy and self._slices > 0
                if owed and busy:
                    self._owed = owed - 1
        if due:
            note[_PART] = _DRIVE
            keep(note)
            drive.update(now)
        return busy

    def off(self):
        """Everything off, for good. The chips go on with what they last heard: whatever ends the loop must not leave the wheels turning."""
        try:
            self.drive.off()
        finally:
            self.lidar.stop()

    def _fail(self, error):
        """A part that the robot cannot drive without has raised an exception."""
        self.safety.failed(isinstance(error, MemoryError))
        try:
            self.drive.halt()
        except Exception:
            self.drive.off()  # which cannot fail
        self._survive(error)

    def _survive(self, error):
        try:
            from safety.survive import survive

            survive(self, error)
            forget("safety.survive")
        except MemoryError:
            pass  # then it is not told

    def _command(self, af, ar, v):
        """Steer and drive, no faster than safety lets it. False where a wheel cannot turn so far."""
        most = self.safety.most
        return self.drive.command(af, ar, min(max(v, 90 - most), 90 + most))

    def _stand(self, safety, seen):
        """Motors off, steering as it is; the surroundings are still looked at."""
        drive = self.drive
        drive.stop()
        if self._hand is not None:
            self._hand = None
            self._by_hand = 0
            forget("planner.hand")
        if seen:
            why = _FAULT if safety.fault else _START if safety.waiting else _STOPPED
            if self.goal is not None and safety.state == telemetry.AUTO and not safety.fault:
                why = self.goal.why
            self.avoid.observe(self.odometry, why, drive.af, drive.ar, 90)
        elif self.goal is not None:
            self.goal.step(self.odometry, self.avoid.map)

    def _watch_out(self, now):
        """On every frame: stop for what is new; the sooner, the longer nobody could look."""
        drive = self.drive
        late = min(max(ticks_diff(now, self._watched_us) - _FRAME_US, 0), _LATE_US) // 1000
        self._watched_us = now
        avoid = self.avoid
        if avoid.v != 90:
            speed = drive.v256 * self.config.motors_full_speed // (90 * 256)
            # A ninth of a second's way is what it takes to stop; what was rolled since the last look may be rolled again before the next one.
            if avoid.guard(self.odometry, (-speed if speed < 0 else speed) * (1000 + 9 * late) // 1000):
                drive.stop()  # at once: the next servo period may be 20 ms off

    def _decide(self):
        """One slice of the decision."""
        avoid = self.avoid
        if self.goal is not None and self.goal.step(self.odometry, avoid.map):
            return
        began = ticks_us()
        done = avoid.step(self.odometry)
        self._slices_us += ticks_diff(ticks_us(), began)
        if done:
            if not self._command(avoid.af, avoid.ar, avoid.v):
                self._limit()
            self.took_us = self._slices_us
            self._slices_us = 0

    def _limit(self):
        """What the planner wants a wheel's limits forbid: from now on it wants nothing of the kind. Takes long, while the robot stands."""
        self.drive.stop()
        from planner.limits import bar

        wrong = bar(self)
        if wrong:
            self.safety.latch(_LIMITS)
            if self.link is not None:
                self.link.log(2, wrong)
        self.avoid.observe(self.odometry, _FAULT, self.drive.af, self.drive.ar, 90)
        self.feed()
