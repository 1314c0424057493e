"""The stop button. A press stops at its first contact, and whatever its contacts do then, a press that stopped the robot does not start it.

contact   ____|  |_|~|____________|~|________________________
              ^ the press begins  ^ opens         ^ it is over: 0.5 s without contact, and armed for the next; the robot starts if it stood
                                                    before, and the contact held for a second but not for more than four
"""

from time import ticks_diff

from micropython import const

PRESSED = const(1)
START = const(2)

_ARMED_US = const(500_000)
_BOUNCE_US = const(30_000)
_FLEETING_US = const(50_000)  # no finger is so quick: a bad wire, which from then on may stop the robot but not start it
_LONG_US = const(1_000_000)
_JAMMED_US = const(4_000_000)  # longer is no wish to start: it is held in fright, leant on, or caught


class StopButton:
    """pin: Pin, low while pressed. closed: True for a button that opens when pressed, so that the pin is high then, and when the wire is broken; it
    never starts the robot, or a loose wire could.
    """

    def __init__(self, pin, closed=False):
        self._pin = pin
        self._level = 1 if closed else 0
        self._never = closed  # starts the robot
        self._pressed = True  # who holds it while the power comes on, or after a reset, starts nothing
        self._starts = False
        self._since_us = self._open_us = None

    def look(self, now_us, stands):
        """PRESSED while there is contact, START once after a long press, else 0. stands: whether the robot was told to stand until now."""
        if self._pin.value() == self._level:
            if not self._pressed:
                self._pressed = True
                self._starts = stands and not self._never
                self._since_us = now_us
            elif self._open_us is not None and ticks_diff(now_us, self._open_us) > _BOUNCE_US:
                self._starts = False  # hammering on it
            elif self._starts and ticks_diff(now_us, self._since_us) > _JAMMED_US:
                self._starts = False
            self._open_us = None
            return PRESSED
        if self._pressed:
            if self._open_us is None:
                self._open_us = now_us
            elif ticks_diff(now_us, self._open_us) >= _ARMED_US:
                self._pressed = False
                if self._since_us is not None:
                    held_us = ticks_diff(self._open_us, self._since_us)
                    if held_us < _FLEETING_US:
                        self._never = True
                    elif self._starts and held_us >= _LONG_US:
                        return START
        return 0
