"""What the constructors of the robot and of its safety do. Needed once, at the start: then it is unloaded, and leaves its room to the robot."""

import gc

from micropython import const

from perception.odometry import Odometry

# safety.py
_STOPPED = const(0)
_AUTO = const(1)
_NONE = const(0)
_LIDAR = const(2)
_HUNG = const(10)


def robot(self, config, avoid, lidar, drive, safety, health, link, screen, goal):
    """Fields of a Robot."""
    self.config = config
    self.avoid = avoid
    self.lidar = lidar
    self.drive = drive
    self.safety = safety
    self.health = health
    self.note = bytearray(b"GS\x00\x00")
    self.keep = len  # takes the bytes as well, and does nothing
    self.feed = bool
    self.link = link
    self.screen = screen
    self.goal = goal
    self.odometry = Odometry(config)
    self.trust = safety.trust
    self.took_us = 0
    self._slices_us = 0
    self._slices = 0  # of the decision, which may still be made before the next frame
    self._owed = 0  # so many of them at least
    self._hand = None  # planner.hand.by_hand while it is needed
    self._by_hand = 0  # how far V may lie from 90 by the last frame


def safety(self, lidar, drive, health, button, trust, autostart, hung):
    """Fields of a Safety."""
    self._lidar = lidar
    self._drive = drive
    self._health = health
    self._button = button
    self.trust = trust
    self.state = _AUTO if autostart else _STOPPED
    self.waiting = not autostart
    self.fault = _LIDAR
    self.most = 90
    self.failures = 0
    self._latched = _HUNG if hung else _NONE
    self._well_us = None
    self._begun = False  # it was fit to drive once
    self._late = 0
    self._restarts = drive.restarts
    self._lost_us = self._lost_before_us = None  # when a chip was lost last, and the time before


def health(self, drive, adc, config):
    """Fields of a Health."""
    self._drive = drive
    self._adc = adc
    self._config = config
    self.battery_mv = 0
    self.battery_low = self.lost = self.empty = False
    self.worst_us = 0
    self.heap_free = gc.mem_free()
    self.uptime_ms = 0
    self._empty = 0
    self._checked_us = None
    self._battery_us = self._heap_us = self._second_us = self._millisecond_us = None
    self._worst_now = 0
    self._calibrated = True


def stop_button(self, pin, closed):
    """Fields of a StopButton."""
    self._pin = pin
    self._level = 1 if closed else 0
    self._never = closed  # starts the robot
    self._pressed = True  # who holds it while the power comes on, or after a reset, starts nothing
    self._starts = False
    self._since_us = self._open_us = None
