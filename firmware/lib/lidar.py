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

from core.crc16 import TABLE

_START = const(0xAA)
_MEASUREMENT = const(0xAD)
_SPEED_FAULT = const(0xAE)

_HEADER = const(8)
_MAX_POINTS = const(80)
_MAX_LENGTH = const(253)  # L of a frame of 80 points

_STORE = const(416)  # a chunk behind what may be left of a frame
_CHUNK = const(160)  # a frame of 48 points

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


# Places in the array that the viper functions share with the class; none is ever negative.
_HEAD = const(0)  # store[head:tail] is not yet taken
_TAIL = const(1)
_FRESH = const(2)  # 1 while there may be a whole frame among it
_SPEED = const(3)  # of the frame taken last: speed20
_COUNT = const(4)  # its points,
_POINTS = const(5)  # where they are in the store,
_ANGLE = const(6)  # its start angle, 0.01 deg,
_STEPS = const(7)  # frames from the one before to it by their angles, 0 while that is not known,
_BEHIND = const(8)  # and bytes from its first to the last that has come
_GOOD = const(9)  # measurement frames since the trust was lost, up to _TRUST_FRAMES
_HEARD = const(10)  # 1 while frames of either kind come
_RULE = const(11)
_RULE_CANDIDATE = const(12)
_RULE_PASSED = const(13)
_PENDING = const(14)  # bytes left in the UART
_BURST = const(15)  # bytes that came at once,
_COUNTED = const(16)  # and those of them that an overflow is already counted for
_ERRORS = const(17)
_SKIPPED = const(18)
_MISSED = const(19)
# of the configuration
_FRAMES = const(20)  # frames a revolution
_WIDTH = const(21)  # of a frame, 0.01 deg
_SECTOR = const(22)  # the same in the unit of the bearing sums
_OFFSET = const(23)  # likewise
_MIRRORED = const(24)
_STATES = const(25)


@micropython.viper
def _append(store: ptr8, state: ptr32, chunk: ptr8, count: int) -> int:
    """Put chunk[:count] behind what is in the store; 1 when the chunk was full, so that more may be pending.

    Loops instead of slices, which would allocate; four bytes a turn, or the loop would cost more than the bytes.
    """
    head = state[_HEAD]
    tail = state[_TAIL]
    if head == tail or tail > _STORE - _CHUNK:
        i = head
        while i < tail:
            store[i - head] = store[i]
            i += 1
        tail -= head
        state[_HEAD] = 0
    i = 0
    while i < count - 3:
        store[tail] = chunk[i]
        store[tail + 1] = chunk[i + 1]
        store[tail + 2] = chunk[i + 2]
        store[tail + 3] = chunk[i + 3]
        tail += 4
        i += 4
    while i < count:
        store[tail] = chunk[i]
        tail += 1
        i += 1
    state[_TAIL] = tail
    state[_FRESH] = 1
    if count == _CHUNK:
        return 1
    state[_PENDING] = 0
    state[_BURST] = 0
    state[_COUNTED] = 0
    return 0


@micropython.viper
def _take(store: ptr8, state: ptr32) -> int:
    """Take frames out of the store up to the next of use, which is described in the state.

    Returns _MEASUREMENT, _SPEED_FAULT, or 0 when no whole frame is left.
    """
    at = state[_HEAD]
    tail = state[_TAIL]
    skipped = 0
    command = 0
    while command == 0 and at < tail:
        if store[at] != _START:
            at += 1
            skipped += 1
            continue
        if tail - at < _HEADER:
            break  # a header that is not whole yet may be one
        length = store[at + 2]
        if length != store[at + 7] + 8 or length < 9 or length > _MAX_LENGTH or store[at + 1] != 0 or store[at + 4] != 0x61 or store[at + 6] != 0:
            at += 1
            skipped += 1
            continue
        end = at + length
        if end + 2 > tail:
            break

        check = (store[end] << 8) | store[end + 1]
        rule = state[_RULE]
        total = 0
        passed = 0
        i = at
        if store[at + 3] or rule == _RULE_SUM:
            while i < end - 3:
                total += store[i] + store[i + 1] + store[i + 2] + store[i + 3]
                i += 4
            while i < end:
                total += store[i]
                i += 1
            if total & 0xFFFF == check:
                passed = _RULE_SUM
        else:
            table = ptr16(TABLE)
            crc = 0xFFFF
            while i < end:
                value = store[i]
                total += value
                crc = crc ^ value
                crc = (crc >> 4) ^ table[crc & 15]
                crc = (crc >> 4) ^ table[crc & 15]
                i += 1
            if crc == check:
                passed = _RULE_CRC
            elif rule != _RULE_CRC and total & 0xFFFF == check:
                passed = _RULE_SUM
        if passed == 0:
            # One byte only: the start of a true frame may lie inside what looked like one.
            at += 1
            skipped += 1
            state[_ERRORS] += 1
            if state[_GOOD] < _TRUST_FRAMES:
                state[_GOOD] = 0
            continue
        if rule == 0 and store[at + 3] == 0:
            if passed != state[_RULE_CANDIDATE]:
                state[_RULE_CANDIDATE] = passed
                state[_RULE_PASSED] = 0
            state[_RULE_PASSED] += 1
            if state[_RULE_PASSED] >= _RULE_PASSES:
                state[_RULE] = passed

        kind = store[at + 5]
        if kind == _SPEED_FAULT:
            command = kind
        elif kind == _MEASUREMENT and length >= 13:
            count = (length - 13) // 3
            extra = length - 13 - 3 * count  # 2 when the end angle comes first, 1 when the length holds no whole number of points
            if extra != 1:
                command = kind
                state[_COUNT] = count
                state[_POINTS] = at + 13 + extra
                state[_BEHIND] = tail - at + state[_PENDING]
                angle = (store[at + 11] << 8) | store[at + 12]
                if angle >= 36000:
                    angle -= 36000
                state[_STEPS] = 0
                if state[_GOOD]:
                    turned = angle - state[_ANGLE]
                    if turned < 0:
                        turned += 36000
                    steps = (turned + (state[_WIDTH] >> 1)) // state[_WIDTH]
                    if steps == 0:
                        steps = state[_FRAMES]
                    state[_MISSED] += steps - 1
                    state[_STEPS] = steps
                state[_ANGLE] = angle
                if state[_GOOD] < _TRUST_FRAMES:
                    state[_GOOD] += 1
        if command:
            state[_SPEED] = store[at + 8]
            state[_HEARD] = 1
        at = end + 2
    state[_HEAD] = at
    state[_SKIPPED] += skipped
    if command == 0:
        state[_FRESH] = 0
    return command


@micropython.viper
def _unpack(store: ptr8, state: ptr32, bearings: ptr16, distances: ptr16, signals: ptr8):
    """The points of the frame taken last into the three arrays.

    Their bearings are summed up in 0.1 deg / 2**17, so that no point needs a division. A point without signal has no distance either.
    """
    count = state[_COUNT]
    if count == 0:
        return
    at = state[_POINTS]
    step = state[_SECTOR] // count
    angle = state[_ANGLE] * 13107 + state[_ANGLE] // 5  # 2**17 / 10 = 13107.2
    if state[_MIRRORED]:
        angle = 0 - angle
        step = 0 - step
    angle += state[_OFFSET] + 65536  # rounds
    if angle < 65536:
        angle += _TURN
    i = 0
    while i < count:
        if angle >= _TURN + 65536:
            angle -= _TURN
        elif angle < 65536:
            angle += _TURN
        bearing = angle >> 17
        if bearing == 3600:
            bearing = 0
        bearings[i] = bearing
        signal = store[at]
        signals[i] = signal
        if signal:
            distances[i] = (store[at + 1] << 8) | store[at + 2]
        else:
            distances[i] = 0
        angle += step
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
        self.speed_faults = 0
        self.overflows = 0

        self._target20 = config.lidar_speed20
        self._rxbuf = config.lidar_rxbuf
        self._byte_ns = 10_000_000_000 // config.lidar_baud  # ten bits a byte on the wire
        self._frame_us20 = 20_000_000 // config.lidar_frames  # duration of a frame at 1/20 r/s
        self._set_period(self._target20)

        self._store = bytearray(_STORE)
        self._chunk = bytearray(_CHUNK)
        self._read_us = 0
        self._heard_us = 0
        self._state = state = array("i", [0] * _STATES)
        state[_FRAMES] = config.lidar_frames
        state[_WIDTH] = 36000 // config.lidar_frames
        state[_SECTOR] = _TURN // config.lidar_frames
        state[_OFFSET] = (config.lidar_offset % 3600) << 17
        state[_MIRRORED] = 1 if config.lidar_mirrored else 0

        self._motor_us = 0
        self._motor_sum = 0
        self._duty = -1

    @property
    def errors(self):
        return self._state[_ERRORS]

    @property
    def skipped(self):
        return self._state[_SKIPPED]

    @property
    def missed(self):
        return self._state[_MISSED]

    def poll(self, now_us):
        """Read what has come; True when the next measurement frame is ready. Call it until it is False.

        now_us: ticks_us, as of this call. Allocates nothing.
        """
        state = self._state
        store = self._store
        while True:
            if state[_FRESH]:
                command = _take(store, state)
                if command == _MEASUREMENT:
                    self._measurement(state, store)
                    return True
                if command == _SPEED_FAULT:
                    self.speed_faults += 1
                    self.speed20 = state[_SPEED]
                    self._heard_us = self._read_us
                    continue
            chunk = self._chunk
            count = self._uart.readinto(chunk)
            if not count:
                break
            self._read_us = now_us
            if _append(store, state, chunk, count):
                self._crowded()
        state[_BURST] = 0
        state[_COUNTED] = 0
        if state[_GOOD] and ticks_diff(now_us, self.frame_us) > self._silent_us:
            self.ok = False
            state[_GOOD] = 0
        if self._motor is not None and ticks_diff(now_us, self._motor_us) >= _MOTOR_PERIOD_US:
            self._regulate(now_us)
        return False

    def stop(self):
        """Let the lidar's motor run out."""
        if self._motor is not None:
            self._duty = -1
            self._motor.duty_u16(0)

    def _crowded(self):
        """A chunk was full: see what is left, and whether so much came at once that some was lost."""
        state = self._state
        pending = self._uart.any()
        burst = state[_BURST] + _CHUNK
        if burst + pending >= self._rxbuf + state[_COUNTED]:
            self.overflows += 1
            burst = 0
            state[_COUNTED] = pending
        state[_PENDING] = pending
        state[_BURST] = burst

    def _measurement(self, state, store):
        """The measurement frame taken last: its time and its points.

        The frame came no later than it was read, less the wire time of what came behind it; how much earlier is not seen. But
        frames follow one another at an even pace, so a frame that seems late against the pace was only read late.
        """
        speed20 = state[_SPEED]
        if speed20 and speed20 != self.speed20:
            self.speed20 = speed20
            self._set_period(speed20)
        read_us = self._read_us
        frame_us = self.frame_us
        wire = state[_BEHIND] * self._byte_ns // 1000
        late = 0
        if state[_STEPS]:
            ahead = state[_STEPS] * self.period_us
            late = ticks_diff(read_us, frame_us) - wire - ahead
        if 0 < late < _SILENT_MAX_US:
            self.frame_us = ticks_add(frame_us, ahead + (late >> 4))
        else:
            self.frame_us = ticks_add(read_us, -wire)
        self._heard_us = read_us
        _unpack(store, state, self.bearings, self.distances, self.signals)
        self.n = state[_COUNT]
        self.frames += 1
        if state[_GOOD] == _TRUST_FRAMES:
            self.ok = True

    def _set_period(self, speed20):
        """Derive the duration of a frame from speed20 (1/20 r/s, > 0), and from that how long a silence is suspicious."""
        period = self._frame_us20 // speed20
        self.period_us = period
        silent = _SILENT_FRAMES * period
        if silent < _SILENT_MIN_US:
            silent = _SILENT_MIN_US
        elif silent > _SILENT_MAX_US:
            silent = _SILENT_MAX_US
        self._silent_us = silent

    def _regulate(self, now_us):
        """One step of the motor's speed control (PI on the duty); the start duty while the speed is unknown."""
        elapsed_ms = min(ticks_diff(now_us, self._motor_us) // 1000, 100)
        self._motor_us = now_us
        duty = _MOTOR_START
        state = self._state
        if state[_HEARD] and ticks_diff(now_us, self._heard_us) > _SILENT_MAX_US:
            state[_HEARD] = 0
        if state[_HEARD]:
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
