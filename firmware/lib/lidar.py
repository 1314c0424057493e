"""Lidars of the Delta family (3irobotix Delta-2A, 2B, 2D, 2G): bytes from the UART to measurement frames.

A frame, all fields big-endian, L = 8 + P:

    offset  size
    0       1     0xAA
    1       2     L, the number of bytes before the check
    3       1     protocol version
    4       1     0x61
    5       1     command: 0xAD measurement, 0xAE speed fault; others are skipped
    6       2     P, the number of parameter bytes
    8       P     parameters
    8 + P   2     check over bytes 0 .. L-1

    0xAD: rotation speed (1 byte, 0.05 r/s), zero offset (2, already applied: ignored), start angle (2, 0.01 deg), then for each
    point signal strength (1) and distance (2, 0.25 mm).  The Delta-2D puts an end angle (2) before the points; P tells which.
    0xAE: rotation speed (1 byte, 0.05 r/s), sent instead of points while the speed is out of range.

Version 1 and above check with the 16-bit sum. Units with version 0 use either the sum or CRC-16, so both are accepted until one has
passed several times; from then on only that one is.

Source: vendor protocol manuals of Delta-1A/2A/2D; the CRC of version 0 from the vendor's SDK for the Delta-2B.
"""

from array import array
from time import ticks_add, ticks_diff

import micropython
from micropython import const

from crc16 import crc16

_START = const(0xAA)
_MEASUREMENT = const(0xAD)
_SPEED_FAULT = const(0xAE)

_HEADER = const(8)
_MAX_POINTS = const(80)
_MAX_LENGTH = const(253)  # L of a frame of 80 points

_STORE = const(512)  # a chunk behind what may be left of a frame
_CHUNK = const(256)

_RULE_SUM = const(1)
_RULE_CRC = const(2)
_RULE_PASSES = const(4)

_TRUST_FRAMES = const(8)
_SILENT_FRAMES = const(10)  # frame periods without a frame: the lidar is silent
_SILENT_MIN_US = const(60_000)
_SILENT_MAX_US = const(300_000)

_TURN = const(471859200)  # 360 deg in steps of 0.1 deg / 2**17, the unit of the bearing sums: below 2**30 even doubled

# Motor: duty of 65536 per 1/20 r/s of error (0.2 per r/s), and per 1/20 r/s and 3 ms of error (0.1 per r/s and second).
_MOTOR_PERIOD_US = const(20_000)
_MOTOR_KP = const(655)
_MOTOR_KI_MS = const(3)
_MOTOR_FULL = const(65535)
_MOTOR_START = const(39322)  # 0.6, the duty that turns the usual unit at about its rated speed


@micropython.viper
def _append(store: ptr8, tail: int, chunk: ptr8, count: int):
    """Copy chunk[:count] to store[tail:]; one viper loop instead of slices, which would allocate."""
    i = 0
    while i < count:
        store[tail + i] = chunk[i]
        i += 1


@micropython.viper
def _compact(store: ptr8, head: int, tail: int):
    """Move store[head:tail] to the beginning of the store."""
    i = head
    while i < tail:
        store[i - head] = store[i]
        i += 1


@micropython.viper
def _seek(store: ptr8, head: int, tail: int) -> int:
    """Index of the first place in store[head:tail] where a frame may begin, or tail.

    A header that is not whole yet counts as possible.
    """
    i = head
    while i < tail:
        if store[i] == 0xAA:
            if tail - i < 8:
                return i
            length = store[i + 2]
            if store[i + 1] == 0 and store[i + 4] == 0x61 and store[i + 6] == 0:
                if length == store[i + 7] + 8 and length >= 9 and length <= 253:
                    return i
        i += 1
    return tail


@micropython.viper
def _sum16(store: ptr8, start: int, end: int) -> int:
    """Sum of store[start:end] modulo 65536."""
    total = 0
    i = start
    while i < end:
        total += store[i]
        i += 1
    return total & 0xFFFF


@micropython.viper
def _unpack(store: ptr8, at: int, count: int, angle: int, step: int, bearings: ptr16, distances: ptr16, signals: ptr8):
    """Points from store[at:] into the three arrays.

    angle, step: bearing of the first point and from point to point, 0.1 deg / 2**17, so that no point needs a division.
    A point without signal has no distance either.
    """
    i = 0
    while i < count:
        signal = store[at]
        distance = (store[at + 1] << 8) | store[at + 2]
        if signal == 0:
            distance = 0
        signals[i] = signal
        distances[i] = distance
        bearing = (angle + 65536) >> 17
        if bearing >= 3600:
            bearing -= 3600
        bearings[i] = bearing
        angle += step
        if angle >= 471859200:
            angle -= 471859200
        elif angle < 0:
            angle += 471859200
        at += 3
        i += 1


class Lidar:
    """Reads the lidar and holds its motor at speed.

    uart: anything with `readinto(buffer)` that never waits (None or 0 when empty) and `any()`.
    motor_pwm: anything with `duty_u16(0..65535)`, or None for a lidar that keeps its own speed.
    config: lidar_baud, lidar_rxbuf (bytes), lidar_frames (frames a revolution), lidar_offset (0.1 deg, bearing of the lidar's
        zero in the body frame), lidar_mirrored (True when its angles grow counter-clockwise seen from above), lidar_speed20
        (target, 1/20 r/s).

    After `poll` returned True:
      n             points in the frame, 0..80
      bearings      array('H', 80), 0.1 deg clockwise from forward, 0..3599
      distances     array('H', 80), quarter mm, 0 = no return
      signals       bytearray(80)
      frame_us      ticks_us at which the last point was measured
      period_us     duration of the frame, us

    At any time:
      ok            frames keep coming
      speed20       rotation speed, 1/20 r/s
      frames, errors, skipped, speed_faults, missed, overflows
                    counters: measurement frames, failed checks, bytes outside frames, speed-fault frames, frames missing by
                    their start angle, times more came at once than the UART's buffer holds
    """

    def __init__(self, uart, motor_pwm, config):
        self._uart = uart
        self._motor = motor_pwm

        self.n = 0
        self.bearings = array("H", [0] * _MAX_POINTS)
        self.distances = array("H", [0] * _MAX_POINTS)
        self.signals = bytearray(_MAX_POINTS)
        self.frame_us = 0
        self.ok = False
        self.speed20 = 0
        self.frames = 0
        self.errors = 0
        self.skipped = 0
        self.speed_faults = 0
        self.missed = 0
        self.overflows = 0

        self._frames_a_turn = config.lidar_frames
        self._offset = (config.lidar_offset % 3600) << 17
        self._mirrored = config.lidar_mirrored
        self._target20 = config.lidar_speed20
        self._rxbuf = config.lidar_rxbuf
        self._byte_ns = 10_000_000_000 // config.lidar_baud  # ten bits a byte on the wire
        self._set_period(self._target20)

        self._store = bytearray(_STORE)
        self._head = 0
        self._tail = 0
        self._chunk = bytearray(_CHUNK)
        self._burst = 0
        self._pending = 0
        self._read_us = 0
        self._heard_us = 0
        self._heard = False
        self._good = 0
        self._start = 0
        self._rule = 0
        self._rule_candidate = 0
        self._rule_passes = 0

        self._motor_us = 0
        self._motor_sum = 0
        self._duty = -1

    def poll(self, now_us):
        """Read what has come; True when the next measurement frame is ready. Call it until it is False.

        now_us: ticks_us, as of this call. Allocates nothing.
        """
        while not self._take():
            if not self._receive(now_us):
                if self._good and ticks_diff(now_us, self.frame_us) > self._silent_us:
                    self.ok = False
                    self._good = 0
                if self._motor is not None and ticks_diff(now_us, self._motor_us) >= _MOTOR_PERIOD_US:
                    self._regulate(now_us)
                return False
        return True

    def stop(self):
        """Let the lidar's motor run out."""
        if self._motor is not None:
            self._duty = -1
            self._motor.duty_u16(0)

    def _receive(self, now_us):
        """Move one chunk from the UART to the store; False when there was nothing."""
        if self._tail + _CHUNK > _STORE:
            _compact(self._store, self._head, self._tail)
            self._tail -= self._head
            self._head = 0
        count = self._uart.readinto(self._chunk)
        if not count:
            self._burst = 0
            return False
        _append(self._store, self._tail, self._chunk, count)
        self._tail += count
        self._read_us = now_us
        self._burst += count
        if count < _CHUNK:
            self._burst = 0
            self._pending = 0
        else:
            self._pending = self._uart.any()
            if self._burst + self._pending >= self._rxbuf:
                self.overflows += 1
                self._burst = -self._pending  # what is pending belongs to the overflow already counted
        return True

    def _take(self):
        """Take frames out of the store up to the next measurement; False when no whole frame is left."""
        store = self._store
        tail = self._tail
        head = self._head
        while True:
            at = _seek(store, head, tail)
            if at != head:
                self.skipped += at - head
                self._head = at
            if tail - at < _HEADER:
                return False
            length = store[at + 2]
            end = at + length + 2
            if end > tail:
                return False
            if not self._check(at, at + length):
                # One byte only: the start of a true frame may lie inside what looked like one.
                self.errors += 1
                self.skipped += 1
                self._head = head = at + 1
                if not self.ok:
                    self._good = 0
                continue
            self._head = head = end
            command = store[at + 5]
            if command == _MEASUREMENT:
                if self._measurement(at, length):
                    return True
            elif command == _SPEED_FAULT:
                self.speed_faults += 1
                self.speed20 = store[at + 8]
                self._heard_us = self._read_us
                self._heard = True

    def _check(self, at, end):
        """True when the check of the frame store[at:end] holds by the rule of its version."""
        store = self._store
        check = (store[end] << 8) | store[end + 1]
        if store[at + 3]:
            return _sum16(store, at, end) == check
        rule = self._rule
        if rule != _RULE_SUM and crc16(store, at, end) == check:
            passed = _RULE_CRC
        elif rule != _RULE_CRC and _sum16(store, at, end) == check:
            passed = _RULE_SUM
        else:
            return False
        if rule == 0:
            if passed != self._rule_candidate:
                self._rule_candidate = passed
                self._rule_passes = 0
            self._rule_passes += 1
            if self._rule_passes >= _RULE_PASSES:
                self._rule = passed
        return True

    def _measurement(self, at, length):
        """Unpack the measurement frame at store[at]; False when its length holds no whole number of points."""
        store = self._store
        extra = (length - 13) % 3
        if extra == 1 or length < 13:
            return False
        points = at + 13 + extra  # extra is 2 when the end angle comes first
        count = (length - 13 - extra) // 3
        speed20 = store[at + 8]
        if speed20 and speed20 != self.speed20:
            self.speed20 = speed20
            self._set_period(speed20)
        start = ((store[at + 11] << 8) | store[at + 12]) % 36000  # 0.01 deg
        self._time(start, at + length + 2, length + 2)

        angle = start * 13107 + start // 5  # 2**17 / 10 = 13107.2
        step = _TURN // self._frames_a_turn // count if count else 0
        if self._mirrored:
            angle = -angle
            step = -step
        angle = (angle + self._offset) % _TURN
        _unpack(store, points, count, angle, step, self.bearings, self.distances, self.signals)
        self.n = count
        self.frames += 1
        self._good += 1
        if self._good >= _TRUST_FRAMES:
            self.ok = True
        return True

    def _time(self, start, end, size):
        """Set frame_us for the frame of `size` bytes that ends at store[end] and starts at angle start (0.01 deg).

        The frame came no later than it was read, less the wire time of what came behind it; how much earlier is not seen. But
        frames follow one another at an even pace, so a frame that seems late against the pace was only read late.
        """
        wire = (self._tail - end + self._pending + size) * self._byte_ns // 1000
        measured = ticks_add(self._read_us, -wire)
        if self._good:
            frame = 36000 // self._frames_a_turn
            steps = ((start - self._start) % 36000 + frame // 2) // frame
            if steps == 0:
                steps = self._frames_a_turn
            self.missed += steps - 1
            expected = ticks_add(self.frame_us, steps * self.period_us)
            late = ticks_diff(measured, expected)
            if 0 < late < _SILENT_MAX_US:
                measured = ticks_add(expected, late >> 4)
        self._start = start
        self.frame_us = measured
        self._heard_us = self._read_us
        self._heard = True

    def _set_period(self, speed20):
        """Derive the duration of a frame from speed20 (1/20 r/s, > 0), and from that how long a silence is suspicious."""
        self.period_us = 20_000_000 // self._frames_a_turn // speed20
        self._silent_us = min(max(_SILENT_FRAMES * self.period_us, _SILENT_MIN_US), _SILENT_MAX_US)

    def _regulate(self, now_us):
        """One step of the motor's speed control (PI on the duty); the start duty while the speed is unknown."""
        elapsed_ms = min(ticks_diff(now_us, self._motor_us) // 1000, 100)
        self._motor_us = now_us
        duty = _MOTOR_START
        if self._heard and ticks_diff(now_us, self._heard_us) > _SILENT_MAX_US:
            self._heard = False
        if self._heard:
            error = self._target20 - self.speed20
            duty += error * _MOTOR_KP + self._motor_sum // _MOTOR_KI_MS
            # No integration into a stop, or the speed would overshoot by all that was gathered there.
            if not (duty >= _MOTOR_FULL and error > 0 or duty <= 0 and error < 0):
                self._motor_sum += error * elapsed_ms
            duty = min(max(duty, 0), _MOTOR_FULL)
        else:
            self._motor_sum = 0
        if duty != self._duty:
            self._duty = duty
            self._motor.duty_u16(duty)
