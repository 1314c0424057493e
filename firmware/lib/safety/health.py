"""What the robot knows of itself: battery, times of the loop, heap. safety.py makes of it what follows."""

import gc
from time import ticks_add, ticks_diff

from micropython import const

_BATTERY_US = const(100_000)
_HEAP_US = const(1_000_000)
_TOP_MV = const(3300)  # what the ADC reads as 65535, where the chip does not know better
_SECOND_US = const(1_000_000)
_LEAST_MV = const(2000)  # below this nothing is connected to the divider, or the robot runs from USB
_EMPTY_READINGS = const(20)  # so many in a row, or each start of the motors would look like an empty battery


class Health:
    """drive: has `told_v256`; adc: ADC with `read_uv()`, or `read_u16()` where that raises OSError because the chip was not calibrated, or None;
    config: battery_divider1000, battery_low, battery_empty (mV).

    battery_mv      smoothed, 0 when unknown; battery_low: True when it should be charged soon; lost: True when it was known and is not any more
    worst_us        longest time between two checks in the last second or two
    heap_free       bytes, looked at only while the motors are off, if only to swing the wheels, because counting takes milliseconds
    uptime_ms       since the first check
    empty           True from an empty battery on until it is charged: one whose wire comes off then is no better
    """

    def __init__(self, drive, adc, config):
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

    def check(self, now_us):
        """Once a turn of the loop; returns what the turn before took, us. Allocates nothing."""
        if self._checked_us is None:
            self._checked_us = self._battery_us = self._heap_us = self._second_us = self._millisecond_us = now_us
        took = ticks_diff(now_us, self._checked_us)
        self._time(now_us, took)
        if self._adc is not None and ticks_diff(now_us, self._battery_us) >= _BATTERY_US:
            self._battery_us = now_us
            self._measure_battery()
        if ticks_diff(now_us, self._heap_us) >= _HEAP_US and not self._drive.told_v256:
            self._heap_us = now_us
            gc.collect()  # what commands have left behind, before it must be done while driving
            self.heap_free = gc.mem_free()
        return took

    def _time(self, now_us, took):
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
            self.lost = self.lost or self.battery_mv > 0
            self.battery_mv = 0
            if not self.empty:
                self._empty = 0
            return
        self.lost = False
        if not self.battery_mv:
            self.battery_mv = reading
        self.battery_mv += (reading - self.battery_mv) // 8
        self.battery_low = self.battery_mv < self._config.battery_low
        if self.battery_mv < self._config.battery_empty:
            self._empty += 1
            self.empty = self.empty or self._empty >= _EMPTY_READINGS
        elif self.battery_mv >= self._config.battery_low or not self.empty:
            self._empty = 0
            self.empty = False  # an empty battery recovers a little at rest: it counts as empty until it is charged

    def _millivolts(self):
        if self._calibrated:
            try:
                return self._adc.read_uv() // 1000
            except OSError:
                self._calibrated = False
        return self._adc.read_u16() * _TOP_MV >> 16
