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

from time import ticks_add, ticks_diff

import micropython
from micropython import const

from core.crc16 import crc16

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


# Places in the array that the viper functions share with the class; none that they read is ever negative.
_HEAD = const(0)  # store[head:tail] is not yet taken
_TAIL = const(1)
_FRESH = const(2)  # 1 while there may be a whole frame among it
_AT = const(3)  # the frame taken last: where it begins in the store,
_PASSED = const(4)  # the rule that its check passed (0 for versions that know only one),
_COUNT = const(5)  # its points,
_POINTS = const(6)  # where they are in the store,
_ANGLE = const(7)  # and its start angle, 0.01 deg
_GOOD = const(8)  # measurement frames since the trust was lost, up to _TRUST_FRAMES
_HEARD = const(9)  # 1 while frames of either kind come
_RULE = const(10)
_RULE_CANDIDATE = const(11)
_RULE_PASSED = const(12)
_PENDING = const(13)  # bytes left in the UART
_BURST = const(14)  # bytes that came at once,
_COUNTED = const(15)  # and those of them that an overflow is already counted for
_ERRORS = const(16)
_SKIPPED = const(17)
_MISSED = const(18)
_READ_US = const(19)  # when bytes were read last
_HEARD_US = const(20)  # when the latest frame of either kind was
_SILENT_US = const(21)  # how long a silence is suspicious
_MOTOR_US = const(22)  # when its speed was looked at last
# of the configuration
_FRAMES = const(23)  # frames a revolution
_WIDTH = const(24)  # of a frame, 0.01 deg
_SECTOR = const(25)  # the same in the unit of the bearing sums
_OFFSET = const(26)  # likewise
_MIRRORED = const(27)
_TARGET = const(28)  # speed, 1/20 r/s
_RXBUF = const(29)
_BYTE_NS = const(30)  # ten bits on the wire
_FRAME_US20 = const(31)  # duration of a frame at 1/20 r/s
_TOLD = const(32)  # what the motor was told last, the duty and 1; 0 for nothing

_COUNTER = const(0x3FFFFFFF)  # counters start again above: in an hour or two of garbage, or four months of frames


@micropython.viper
def _append(store: ptr8, state: ptr32, chunk: ptr8, count: int) -> int:
    """Put chunk[:count] behind what is in the store; 1 when the chunk was full, so that more may be pending.

    Loops instead of slices, which would allocate.
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
    while i < count:
        store[tail + i] = chunk[i]
        i += 1
    state[_TAIL] = tail + count
    state[_FRESH] = 1
    if count == _CHUNK:
        return 1
    state[_PENDING] = 0
    state[_BURST] = 0
    state[_COUNTED] = 0
    return 0


@micropython.viper
def _take(buffer, state: ptr32) -> int:
    """Take the next frame whose check is right out of the store; its command, or 0 when no whole frame is left.

    Byte by byte: what looks like a header may be none, and the start of a true frame may lie inside what looked like one.
    """
    store = ptr8(buffer)
    at = state[_HEAD]
    tail = state[_TAIL]
    rule = state[_RULE]
    command = 0
    while command == 0 and at < tail:
        if store[at] == _START:
            if tail - at < _HEADER:
                break  # a header that is not whole yet may be one
            length = store[at + 2]
            if length == store[at + 7] + 8 and length >= 9 and length <= _MAX_LENGTH and (store[at + 1] | store[at + 6]) == 0 and store[at + 4] == 0x61:
                end = at + length
                if end + 2 > tail:
                    break
                check = (store[end] << 8) | store[end + 1]
                passed = 0
                if store[at + 3] == 0 and rule != _RULE_SUM and int(crc16(buffer, at, end)) == check:
                    passed = _RULE_CRC
                elif store[at + 3] or rule != _RULE_CRC:
                    total = 0
                    i = at
                    while i < end:
                        total += store[i]
                        i += 1
                    if total & 0xFFFF == check:
                        passed = _RULE_SUM
                if passed:
                    command = store[at + 5]
                    state[_AT] = at
                    state[_PASSED] = 0 if store[at + 3] else passed
                    at = end + 2
                else:
                    state[_ERRORS] += 1
                    if state[_GOOD] < _TRUST_FRAMES:
                        state[_GOOD] = 0
        if command == 0:
            at += 1
            state[_SKIPPED] = (state[_SKIPPED] + 1) & _COUNTER
    state[_HEAD] = at
    if command == 0:
        state[_FRESH] = 0
    return command


@micropython.viper
def _unpack(state: ptr32, store: ptr8, distances: ptr16, bearings: ptr16):
    """The points of the frame taken last into the two arrays.

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
        if store[at]:
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
      place         which frame of the revolution it is, 0..frames a revolution - 1
      bearings      array('H', 80), 0.1 deg clockwise from forward, 0..3599
      distances     array('H', 80), quarter mm, 0 = no return
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
        from perception.build import lidar

        lidar(self, uart, motor_pwm, config)
        self._set_period(config.lidar_speed20)

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
                passed = state[_PASSED]
                if passed and command and not state[_RULE]:
                    # A frame of version 0 passed one of the rules: the one that passes several times in a row holds from then on.
                    if passed != state[_RULE_CANDIDATE]:
                        state[_RULE_CANDIDATE] = passed
                        state[_RULE_PASSED] = 0
                    state[_RULE_PASSED] += 1
                    if state[_RULE_PASSED] >= _RULE_PASSES:
                        state[_RULE] = passed
                if command == _MEASUREMENT:
                    if self._measurement(state, store):
                        return True
                elif command == _SPEED_FAULT:
                    self.speed_faults += 1
                    self.speed20 = store[state[_AT] + _HEADER]
                    state[_HEARD] = 1
                    state[_HEARD_US] = state[_READ_US]
                if command:
                    continue
            chunk = self._chunk
            count = self.uart.readinto(chunk)
            if not count:
                break
            state[_READ_US] = now_us
            if _append(store, state, chunk, count):
                # The chunk was full: see what is left, and whether so much came at once that some was lost.
                pending = self.uart.any()
                burst = state[_BURST] + _CHUNK
                if burst + pending >= state[_RXBUF] + state[_COUNTED]:
                    self.overflows += 1
                    burst = 0
                    state[_COUNTED] = pending
                state[_PENDING] = pending
                state[_BURST] = burst
        state[_BURST] = 0
        state[_COUNTED] = 0
        if state[_GOOD] and ticks_diff(now_us, self.frame_us) > state[_SILENT_US]:
            self.ok = False
            state[_GOOD] = 0
        # Not in the time since it was told last: at the start, that is 0.
        if self._motor is not None and not 0 <= ticks_diff(now_us, state[_MOTOR_US]) < _MOTOR_PERIOD_US:
            self._regulate(now_us)
        return False

    def stop(self):
        """Let the lidar's motor run out."""
        if self._motor is not None:
            self._state[_TOLD] = 0
            self._motor.duty_u16(0)

    def _measurement(self, state, store):
        """The measurement frame taken last: its time and its points. False if its length holds no whole number of points.

        The frame came no later than it was read, less the wire time of what came behind it; how much earlier is not seen. But
        frames follow one another at an even pace, so a frame that seems late against the pace was only read late.
        """
        at = state[_AT]
        size = store[at + 2] - _HEADER - 5
        extra = size % 3  # 2 when the end angle comes first
        if size < 0 or extra == 1:
            return False
        speed20 = store[at + _HEADER]
        if speed20 and speed20 != self.speed20:
            self.speed20 = speed20
            self._set_period(speed20)
        at += _HEADER + 5 + extra
        state[_POINTS] = at
        angle = ((store[at - extra - 2] << 8) | store[at - extra - 1]) % 36000
        good = state[_GOOD]
        read_us = state[_READ_US]
        # From its first byte to the last that has come
        wire = (state[_TAIL] - state[_AT] + state[_PENDING]) * state[_BYTE_NS] // 1000
        late = 0
        if good:
            # Frames from the one before to it, by their angles
            steps = ((angle - state[_ANGLE]) % 36000 + (state[_WIDTH] >> 1)) // state[_WIDTH]
            if steps == 0:
                steps = state[_FRAMES]
            state[_MISSED] += steps - 1
            ahead = steps * self.period_us
            late = ticks_diff(read_us, self.frame_us) - wire - ahead
        if 0 < late < _SILENT_MAX_US:
            self.frame_us = ticks_add(self.frame_us, ahead + (late >> 4))
        else:
            self.frame_us = ticks_add(read_us, -wire)
        state[_ANGLE] = angle
        self.place = (angle + (state[_WIDTH] >> 1)) // state[_WIDTH] % state[_FRAMES]
        state[_HEARD] = 1
        state[_HEARD_US] = read_us
        self.n = state[_COUNT] = size // 3
        _unpack(state, store, self.distances, self.bearings)
        self.frames = (self.frames + 1) & _COUNTER
        if good < _TRUST_FRAMES:
            state[_GOOD] = good = good + 1
        if good == _TRUST_FRAMES:
            self.ok = True
        return True

    def _set_period(self, speed20):
        """Derive the duration of a frame from speed20 (1/20 r/s, > 0), and from that how long a silence is suspicious."""
        period = self._state[_FRAME_US20] // speed20
        self.period_us = period
        self._state[_SILENT_US] = min(max(_SILENT_FRAMES * period, _SILENT_MIN_US), _SILENT_MAX_US)

    def _regulate(self, now_us):
        """One step of the motor's speed control (PI on the duty); the start duty while the speed is unknown."""
        state = self._state
        elapsed_ms = min(abs(ticks_diff(now_us, state[_MOTOR_US])) // 1000, 100)
        state[_MOTOR_US] = now_us
        duty = _MOTOR_START
        if state[_HEARD] and ticks_diff(now_us, state[_HEARD_US]) > _SILENT_MAX_US:
            state[_HEARD] = 0
        if state[_HEARD]:
            error = state[_TARGET] - self.speed20
            duty += error * _MOTOR_KP + self._motor_sum // _MOTOR_KI_MS
            # No integration into a stop, or the speed would overshoot by all that was gathered there.
            if not (duty >= _MOTOR_FULL and error > 0 or duty <= 0 and error < 0):
                self._motor_sum += error * elapsed_ms
            duty = min(max(duty, 0), _MOTOR_FULL)
        else:
            self._motor_sum = 0
        if state[_TOLD] != duty + 1:
            state[_TOLD] = duty + 1
            self._motor.duty_u16(duty)
