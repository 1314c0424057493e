"""The robot's loop: one `step()`, in which nothing waits and nothing is allocated."""

from time import ticks_diff, ticks_us

from micropython import const

from link import telemetry
from perception.odometry import Odometry

_STOPPED = const(12)  # reasons.STOPPED
_FAULT = const(13)  # reasons.FAULT
_MANUAL = const(14)  # reasons.MANUAL


class Robot:
    """The parts, joined; buses and pins were handed to them by core/start.py.

    avoid: Avoid; lidar: Lidar; drive: Drive; health: Health or None; link: Link or None (then it drives on its own); screen: Screen or None; trust: ScanTrust.
    took_us: computing time of the slices of the latest decision.
    """

    def __init__(self, config, avoid, lidar, drive, health=None, link=None, screen=None, trust=None):
        self.config = config
        self.avoid = avoid
        self.lidar = lidar
        self.drive = drive
        self.health = health
        self.link = link
        self.screen = screen
        self.odometry = Odometry(config)
        self.trust = trust
        self.took_us = 0
        self._slices_us = 0
        self._slices = 0  # of the decision, still to be made before the next frame
        self._owed = False  # one of them at least

    def step(self):
        """Once round. Returns True if a lidar frame was taken in.

        A turn does one long thing: it takes in frames, or writes the chips, or works at the decision. So none takes longer than a frame of the
        lidar, and none is put off for ever: after a frame come the chips, if they are due, and a slice of the decision, then the next frame.
        """
        now = ticks_us()
        lidar = self.lidar
        drive = self.drive
        avoid = self.avoid
        odometry = self.odometry
        link = self.link
        trust = self.trust
        seen = False
        owed = self._owed
        odometry.advance(now, drive)
        while not owed and lidar.poll(now):
            if link is not None:
                link.frame(lidar)
            if trust is not None:
                trust.frame(lidar, odometry, drive.told_v256)
            avoid.frame(lidar, odometry)
            seen = True
        state = telemetry.AUTO if link is None else link.state
        due = drive.due(now) and not seen
        self._owed = False
        if self.health is not None and not self.health.check(now):
            self._stand(_FAULT, seen)
        elif trust is not None and trust.fault:
            self._stand(_FAULT, seen)
        elif state == telemetry.STOPPED:
            self._stand(_STOPPED, seen)
        elif state == telemetry.MANUAL:
            drive.command(link.af, link.ar, link.v)
            if seen:
                avoid.observe(odometry, _MANUAL, link.af, link.ar, link.v)
        elif seen:
            self._watch_out()
            self._slices = 2 if drive.v256 else 3  # there is time for so many until the next frame; a robot that stands may be late
            self._owed = True
        elif self._slices:
            if due:
                self._owed = owed
            else:
                self._slices -= 1
                self._decide()
        if due:
            drive.update(now)
        if link is not None:
            link.update(now, self)
        if self.screen is not None:
            self.screen.update(now, self, link)
        return seen

    def off(self):
        """Everything off, for good. The chips go on with what they last heard: whatever ends the loop must not leave the wheels turning."""
        self.drive.off()
        self.lidar.stop()

    def _stand(self, why, seen):
        """Motors off, steering as it is; the surroundings are still looked at."""
        drive = self.drive
        drive.stop()
        if seen:
            self.avoid.observe(self.odometry, why, drive.af, drive.ar, 90)

    def _watch_out(self):
        """On every frame: stop for what is new."""
        drive = self.drive
        avoid = self.avoid
        if avoid.v != 90:
            speed = drive.v256 * self.config.motors_full_speed // (90 * 256)
            if avoid.guard(self.odometry, -speed if speed < 0 else speed):
                drive.stop()  # at once: the next servo period may be 20 ms off

    def _decide(self):
        """One slice of the decision."""
        avoid = self.avoid
        began = ticks_us()
        done = avoid.step(self.odometry)
        self._slices_us += ticks_diff(ticks_us(), began)
        if done:
            most = 90 if self.trust is None else self.trust.most
            self.drive.command(avoid.af, avoid.ar, min(max(avoid.v, 90 - most), 90 + most))
            self.took_us = self._slices_us
            self._slices_us = 0
