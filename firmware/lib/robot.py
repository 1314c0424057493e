"""The robot's loop: one `step()`, in which nothing waits and nothing is allocated."""

from time import ticks_diff, ticks_us

import reasons
from avoid import Avoid
from drive import Drive
from lidar import Lidar
from odometry import Odometry


class Robot:
    """The parts, joined. Buses and pins are handed in by main.py."""

    def __init__(self, config, lidar, drive):
        self.config = config
        self.lidar = lidar
        self.drive = drive
        self.odometry = Odometry(config)
        self.avoid = Avoid(config)
        self.manual = False
        self.stopped = False
        self._fresh = False

    def step(self):
        """Once round. Returns True if a lidar frame was taken in."""
        now = ticks_us()
        lidar = self.lidar
        drive = self.drive
        avoid = self.avoid
        odometry = self.odometry
        seen = False
        odometry.advance(now, drive)
        while lidar.poll(now):
            avoid.frame(lidar, odometry, now)
            seen = True
        if seen:
            if drive.v256 != 0 or avoid.v != 90:
                room = avoid.guard(odometry)
                speed = drive.v256 * self.config.motors_full_speed // (90 * 256)
                if speed < 0:
                    speed = -speed
                # Way to stop: what rolls out in the motors' time constant, and a little.
                if room < speed // 12 and avoid.v != 90:
                    avoid.halt(reasons.BLOCKED)
                    drive.command(avoid.af, avoid.ar, 90)
            if avoid.work(now, odometry, drive):
                drive.command(avoid.af, avoid.ar, avoid.v)
        if not lidar.ok:
            drive.command(avoid.af, avoid.ar, 90)
        drive.update(now)
        return seen
