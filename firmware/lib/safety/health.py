"""Is the robot fit to drive? Looks at stop button, lidar, chips, battery, loop time and heap; the first thing that is not well stops it.

if not health.check(now_us):
    drive.stop()                 # health.fault says why
"""

import gc
from time import ticks_add, ticks_diff

from micropython import const

# What the faults are called, by these numbers, stands in link/reason_texts.py.
_NONE = const(0)
STOP_BUTTON = const(1)  # the link's too: a press may mean more than a stop
_LIDAR = const(2)
_CHIPS = const(3)
_BATTERY = const(4)
_SETTLING = const(5)

_SETTLE_US = const(500_000)  # a contact that comes and goes must not make the robot jerk
_BATTERY_US = const(100_000)
_HEAP_US = const(10_000_000)
_TOP_MV = const(3300)  # what the ADC reads as 65535, where the chip does not know better
_SECOND_US = const(1_000_000)
_LEAST_MV = const(2000)  # below this nothing is connected to the divider, or the robot runs from USB
_EMPTY_READINGS = const(20)  # so many in a row, or each start of the motors would look like an empty battery


class Health:
    """The robot's self-check.

    lidar: has `ok`; drive: has `ok` and `v256`; stop_button: Pin, low when pressed, or None; adc: ADC with
    `read_uv()`, or `read_u16()` where that raises OSError because the chip was not calibrated, or None; config: battery_divider1000, battery_low, battery_empty (mV).

    fault           what stops the robot, one of the numbers above; 0 if nothing does
    battery_mv      smoothed, 0 when unknown; battery_low: True when it should be charged soon
    worst_us        longest time between two checks in the last second or two
    heap_free       bytes, looked at seldom and only while the robot stands, because counting takes milliseconds
    uptime_ms       since the first check
    chips           True while all PWM chips answer
    """

    def __init__(self, lidar, drive, stop_button, adc, config):
        self._lidar = lidar
        self._drive = drive
        self._button = stop_button
        self._adc = adc
        self._config = config
        self.fault = _LIDAR
        self.battery_mv = 0
        self.battery_low = False
        self.worst_us = 0
        self.heap_free = gc.mem_free()
        self.uptime_ms = 0
        self._empty = 0
        self._checked_us = None
        self._well_us = None
        self._battery_us = 0
        self._heap_us = 0
        self._second_us = 0
        self._millisecond_us = 0
        self._worst_now = 0
        self._started = False
        self._calibrated = True

    @property
    def chips(self):
        return self._drive.ok

    def check(self, now_us):
        """True when the robot may drive. Call once a loop; allocates nothing."""
        if self._checked_us is None:
            self._checked_us = self._battery_us = self._heap_us = self._second_us = self._millisecond_us = now_us
        self._time(now_us)
        if self._adc is not None and ticks_diff(now_us, self._battery_us) >= _BATTERY_US:
            self._battery_us = now_us
            self._measure_battery()
        if ticks_diff(now_us, self._heap_us) >= _HEAP_US and not self._drive.v256:
            self._heap_us = now_us
            gc.collect()  # what commands have left behind, before it must be done while driving
            self.heap_free = gc.mem_free()
        fault = self._find()
        if fault:
            # What has not begun to work yet is no interruption: no settling after the start.
            self._well_us = now_us if self._started else None
        elif self._well_us is not None:
            if ticks_diff(now_us, self._well_us) < _SETTLE_US:
                fault = _SETTLING
            else:
                self._well_us = None
        if not fault:
            self._started = True
        self.fault = fault
        return not fault

    def _find(self):
        if self._button is not None and not self._button.value():
            return STOP_BUTTON
        if not self._drive.ok:
            return _CHIPS
        if not self._lidar.ok:
            return _LIDAR
        if self._empty >= _EMPTY_READINGS:
            return _BATTERY
        return _NONE

    def _time(self, now_us):
        took = ticks_diff(now_us, self._checked_us)
        self._checked_us = now_us
        if took > self._worst_now:
            self._worst_now = took
        if took > self.worst_us:
            self.worst_us = took
        if ticks_diff(now_us, self._second_us) >= _SECOND_US:
            self._second_us = now_us
            self.worst_us = self._worst_now
            self._worst_now = 0
        passed = ticks_diff(now_us, self._millisecond_us) // 1000
        self.uptime_ms = (self.uptime_ms + passed) & 0x3FFFFFFF
        self._millisecond_us = ticks_add(self._millisecond_us, passed * 1000)

    def _measure_battery(self):
        # Millivolts at the pin first: the product of microvolts and divider would leave the small integers.
        reading = self._millivolts() * self._config.battery_divider1000 // 1000
        if reading < _LEAST_MV:
            self.battery_mv = self._empty = 0
            self.battery_low = False
            return
        if not self.battery_mv:
            self.battery_mv = reading
        self.battery_mv += (reading - self.battery_mv) // 8
        self.battery_low = self.battery_mv < self._config.battery_low
        if self.battery_mv < self._config.battery_empty:
            self._empty += 1
        elif self.battery_mv >= self._config.battery_low or self._empty < _EMPTY_READINGS:
            self._empty = 0  # an empty battery recovers a little at rest: it counts as empty until it is charged

    def _millivolts(self):
        if self._calibrated:
            try:
                return self._adc.read_uv() // 1000
            except OSError:
                self._calibrated = False
        return self._adc.read_u16() * _TOP_MV >> 16
