"""Wheel angles and speeds -> the three PWM chips, and what happens when one of them is lost.

Servos: angle + trim, direction and pulse range of each wheel -> pulse width. Motors (L298N, enable jumpered): IN1 carries the PWM forward, IN2
backward, both low brake. The output enable line keeps everything off until the registers of all chips are valid.
"""

from array import array

import micropython
from micropython import const

_FULL_SPEED = const(23040)  # (180 - 90) * 256


@micropython.viper
def _servo_counts(angles: ptr16, centre: ptr32, slope: ptr16, channels: ptr16, wheels: int, counts: ptr16):
    """count = centre + slope * angle; centre and slope (signed) in 2**-15 counts, angle in 0.1 deg."""
    k = 0
    while k < wheels:
        angle = (angles[k] ^ 0x8000) - 0x8000
        gain = (slope[k] ^ 0x8000) - 0x8000
        counts[channels[k]] = (centre[k] + angle * gain + 0x4000) >> 15
        k += 1


@micropython.viper
def _motor_counts(shares: ptr16, directions: ptr16, channels: ptr16, axles: int, v256: int, dead: int, left: ptr16, right: ptr16):
    """Duty of IN1 (forward) and IN2 (backward) of every motor; dead: counts at which a motor just does not turn."""
    i = 0
    while i < axles:
        side = 0
        while side < 2:
            wheel = i + i + side
            speed = (v256 * ((shares[wheel] ^ 0x8000) - 0x8000)) >> 14
            if directions[wheel] & 0x8000:
                speed = 0 - speed
            backward = 0
            if speed < 0:
                speed = 0 - speed
                backward = 1
            duty = 0
            if speed > 0:
                duty = dead + speed * (4096 - dead) // _FULL_SPEED
            channel = channels[i]
            if side:
                right[channel + backward] = duty
                right[channel + 1 - backward] = 0
            else:
                left[channel + backward] = duty
                left[channel + 1 - backward] = 0
            side += 1
        i += 1


class Outputs:
    """The servo chip and the chips of the left and the right motors (pca9685.PCA9685 each).

    output_enable: Pin whose high level switches every output off, or None. config: Config.

    Everything is off after construction; begin() or the first write() tries to set the chips up. A chip that does not answer takes all outputs
    down, and is tried again once a second.

    ok          all chips have answered
    fault       text of the last fault, "" at first
    restarts    how often the chips have been set up: the wheels may stand anywhere after each
    """

    def __init__(self, servo_chip, motor_left, motor_right, output_enable, config):
        self._enable = output_enable
        self._enabled = None
        self._set_enabled(False)
        self.ok = False
        self.fault = ""
        self.restarts = 0
        self._config = config
        self._chips = (servo_chip, motor_left, motor_right)
        servo_chip.use(max(config.servos_channels) + 1)
        motor_left.use(max(config.motors_channels) + 2)
        motor_right.use(max(config.motors_channels) + 2)
        self._counts = [array("H", bytes(2 * chip.channels)) for chip in self._chips]
        self._unsent = 0  # bit k: chip k holds other registers than its image
        self._ticks_a_second = config.servos_frequency
        self._tick = -1  # counts servo periods round a second; chips that failed are tried at 0
        self._servo_channels = config.servos_channels
        self._directions = config.motors_directions
        self._motor_channels = config.motors_channels
        self._axles = config.axles
        self._changes = config.changes
        self._slope = array("h", [0] * (2 * config.axles))
        self._centre = array("i", [0] * (2 * config.axles))
        self._draw_lines()

    def begin(self):
        """Set all chips up, every output still off. True if all answered."""
        self._set_enabled(False)
        try:
            for chip in self._chips:
                chip.start()
        except OSError as error:
            self._fail(error)
            return False
        self._unsent = 7
        self.ok = True
        self.restarts += 1
        return True

    def write(self, angles, shares, v256):
        """Called once a servo period: send what changed. array('h') of Steering, and the fastest wheel's V - 90 in 1/256. True if all is well."""
        self._tick += 1
        if self._tick >= self._ticks_a_second:
            self._tick = 0
        if not self.ok and (self._tick or not self.begin()):
            return False
        if self._changes != self._config.changes:
            self._draw_lines()
        dead = self._config.motors_dead_band * 4096 // 100
        counts = self._counts
        _servo_counts(angles, self._centre, self._slope, self._servo_channels, 2 * self._axles, counts[0])
        _motor_counts(shares, self._directions, self._motor_channels, self._axles, v256, dead, counts[1], counts[2])
        try:
            self._check_one()
            self._send(0)
            self._send(1)
            self._send(2)
        except OSError as error:
            self._fail(error)
            return False
        self._set_enabled(True)
        return True

    def motors_off(self):
        """Stop the motors now, without waiting for the next period; the servos hold."""
        if not self.ok:
            return
        try:
            for k in range(1, 3):
                _clear(self._counts[k])
                self._send(k)
        except OSError as error:
            self._fail(error)

    def off(self):
        """Everything off, for good: the servos let go."""
        self._set_enabled(False)
        for chip in self._chips:
            try:
                chip.deinit()
            except OSError:
                pass

    def _draw_lines(self):
        """Each wheel's count over its angle, a line with a centre and a slope, in 2**-15 counts."""
        config = self._config
        chip = self._chips[0]
        for k in range(2 * self._axles):
            first = chip.counts(config.servos_pulse_low[k], 32768)
            last = chip.counts(config.servos_pulse_high[k], 32768)
            slope = (last - first + 900) // 1800 * config.servos_directions[k]
            self._centre[k] = (first + last) // 2 + slope * config.servos_trims[k]
            self._slope[k] = slope
        self._changes = config.changes

    def _send(self, k):
        chip = self._chips[k]
        bit = 1 << k
        if chip.load(self._counts[k]) or self._unsent & bit:
            self._unsent |= bit
            chip.write()
            self._unsent &= ~bit

    def _check_one(self):
        """Look at each chip once a second, at different times, and send its registers again."""
        third = self._ticks_a_second // 3
        k = self._tick // third
        if self._tick != k * third or k > 2:
            return
        self._unsent |= 1 << k
        if not self._chips[k].check():
            self.fault = "PCA9685 at 0x%02x was reset: look for dips of its supply" % self._chips[k].address
            self.restarts += 1

    def _fail(self, error):
        self.ok = False
        self.fault = error.args[0]
        self._tick = 0
        self._set_enabled(False)
        # Where output enable is not wired, the chips that still answer can at least be told.
        for k in range(1, 3):
            _clear(self._counts[k])
            try:
                self._chips[k].load(self._counts[k])
                self._chips[k].write()
            except OSError:
                pass

    def _set_enabled(self, enabled):
        if enabled != self._enabled:
            self._enabled = enabled
            if self._enable is not None:
                self._enable.value(0 if enabled else 1)


def _clear(counts):
    for k in range(len(counts)):
        counts[k] = 0
