"""What the robot may do: the states, what starts it, what stops it, in which order. docs/safety.md has the drawing.

    if safety.check(now_us):  ...    # once a turn of the loop: True when it may move, as `state` says
    else:                     ...    # it stands; safety.fault says why, or it is 0 and the robot was told to

state   STOPPED   it waits for a start, or was told to stop: by command, screen or button, by a hand that was let go, by a reset
        AUTO, MANUAL   it was told to drive, by itself or by hand. It does, unless there is a fault
fault   what keeps it from driving, see faults.py. Most pass by themselves, and half a second later it drives on if `state` says so. One that
        is latched turns the state to STOPPED: a person has to start it again

Only a person starts: start(). Whatever else happens can only stop.
"""

from time import ticks_diff

from micropython import const

from safety.stop_button import PRESSED, START

STOPPED = const(0)  # as telemetry.py has them, and the wire format
AUTO = const(1)

# By their numbers in faults.py
_NONE = const(0)
_STOP_BUTTON = const(1)
_LIDAR = const(2)
_CHIPS = const(3)
_BATTERY = const(4)
_SETTLING = const(5)
_SLOW = const(6)
_MEMORY = const(7)
_CHIPS_AGAIN = const(8)
_FAILED = const(9)
_HUNG = const(10)

_SETTLE_US = const(500_000)  # what comes and goes must not make the robot jerk
_LATE_US = const(100_000)
_OFTEN_US = const(60_000_000)
_LEAST = const(4096)  # bytes of heap: less is soon none, and what then fails is anybody's guess
_SLOW_V = const(9)  # with a low battery: half the usual speed


class Safety:
    """lidar: has `ok`; drive: has `ok`, `restarts` and `told_v256`; health: Health; button: StopButton or None;
    trust: ScanTrust, has `fault`, `alarm`, `most` and `clear()`, or None.

    autostart: True if it drives without being asked. hung: True after the watchdog has reset the board.

    state, fault    see above
    waiting         True until it is started first
    most            how far V may lie from 90 now
    failures        exceptions that the loop has survived
    """

    def __init__(self, lidar, drive, health, button, trust=None, autostart=False, hung=False):
        self._lidar = lidar
        self._drive = drive
        self._health = health
        self._button = button
        self.trust = trust
        self.state = AUTO if autostart else STOPPED
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

    def start(self, state):
        """A person wants it to drive. False while the stop button is pressed."""
        if self.fault == _STOP_BUTTON:
            return False
        self.state = state
        self.waiting = False
        self._latched = _NONE
        if self.trust is not None:
            self.trust.clear()
        return True

    def stop(self):
        """Stand until a person starts it."""
        self.state = STOPPED

    def failed(self, memory=False):
        """A part of the loop has raised an exception: `memory` when there was no room in the heap."""
        self.latch(_MEMORY if memory else _FAILED)

    def latch(self, fault):
        """Stand with that fault until a person starts it."""
        self._latched = fault
        self.state = STOPPED

    def check(self, now_us):
        """True when the robot may move. Once a turn, which is what `late` counts; allocates nothing."""
        took = self._health.check(now_us)
        # Commands that load code take longer, but they stop the motors before.
        self._late = self._late + 1 if took > _LATE_US and self._drive.told_v256 else 0
        pressed = 0
        if self._button is not None:
            pressed = self._button.look(now_us, self.state == STOPPED)
            if pressed == START:
                self.start(AUTO)
        fault = self._find(now_us, pressed)
        if fault:
            # What has not begun to work yet is no interruption: no settling after the start.
            self._well_us = now_us if self._begun else None
        elif self._well_us is not None:
            if ticks_diff(now_us, self._well_us) < _SETTLE_US:
                fault = _SETTLING
            else:
                self._well_us = None
        if not fault:
            self._begun = True
        self.fault = fault
        most = _SLOW_V if self._health.battery_low else 90
        trust = self.trust
        self.most = most if trust is None or trust.most > most else trust.most
        return not fault and self.state != STOPPED

    def _find(self, now_us, pressed):
        """The first that is not well."""
        if pressed == PRESSED:
            self.state = STOPPED
            return _STOP_BUTTON
        restarts = self._drive.restarts
        if restarts != self._restarts:
            self._lost(now_us, restarts)
        if self._health.heap_free < _LEAST:
            self._latched = _MEMORY
        if self._latched:
            self.state = STOPPED
            return self._latched
        if not self._drive.ok:
            return _CHIPS
        if self._late > 1:
            return _SLOW
        if not self._lidar.ok:
            return _LIDAR
        if self._health.empty:
            return _BATTERY
        trust = self.trust
        if trust is None:
            return _NONE
        if trust.alarm:
            self._latched = trust.fault
        return trust.fault

    def _lost(self, now_us, restarts):
        """Chips had to be set up anew: the third time in a minute is once too often."""
        self._restarts = restarts
        if not self._begun:
            return
        before = self._lost_before_us
        if before is not None and 0 <= ticks_diff(now_us, before) < _OFTEN_US:  # what was long ago may seem to come
            self._latched = _CHIPS_AGAIN
            before = self._lost_us = None
        self._lost_before_us = self._lost_us
        self._lost_us = now_us
