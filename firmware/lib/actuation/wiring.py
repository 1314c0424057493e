"""What the constructors of chips, outputs and drive do: which register of which chip moves each wheel, and how far. Needed once, at the start."""

from array import array

from micropython import const

_HISTORY = const(32)  # as in drive.py

_LED0 = const(0x06)  # as in pca9685.py
_PRE_SCALE = const(0xFE)
_ALL_CALL = const(0x70)


def chip(self, i2c, address, frequency, oscillator, channels):
    """Fields of a PCA9685."""
    if not 0x40 <= address <= 0x7F or address == _ALL_CALL:
        raise ValueError("PCA9685 address must be 0x40 .. 0x7F and not 0x70 (answered by every chip), not 0x%02x" % address)
    if not 1 <= channels <= 16:
        raise ValueError("a PCA9685 has 1 .. 16 channels, not %r" % channels)
    self.address = address
    self.prescale = min(max((oscillator + 2048 * frequency) // (4096 * frequency) - 1, 3), 255)
    self._i2c = i2c
    self.image = bytearray(1 + 4 * channels)
    self.image[0] = _LED0
    self._scale = bytes((_PRE_SCALE, self.prescale))
    self._byte = bytearray(1)


def counts(us, prescale, oscillator=25000000, parts=1):
    """Width of a pulse of `us` microseconds in counts of 1/4096 period, or in so many parts of a count; int, rounded."""
    scale = 1000000 * (prescale + 1)
    return (us * oscillator * parts + scale // 2) // scale


def _servo_lines(config, chip):
    """Each wheel's pulse over its angle is a line: array 'i' as outputs._servo_registers reads it, without the trims. chip: the servos' PCA9685."""
    wheels = 2 * config.axles
    oscillator = config.servos_oscillator
    lines = array("i", [wheels])
    for k in range(wheels):
        first = counts(config.servos_pulse_low[k], chip.prescale, oscillator, 32768)
        last = counts(config.servos_pulse_high[k], chip.prescale, oscillator, 32768)
        slope = (last - first + 900) // 1800 * config.servos_directions[k]
        lines.append((first + last) // 2)
        lines.append((slope + 0x8000) << 6 | 3 + 4 * config.servos_channels[k])
    return lines


def _motor_wires(config):
    """Where the image of its chip has the two inputs of each motor: bytes as outputs._motor_registers reads them."""
    wheels = 2 * config.axles
    wires = bytearray([wheels])
    for k in range(wheels):
        one = 2 + 4 * config.motors_channels[k >> 1]
        pair = (one, one + 4) if config.motors_directions[k] > 0 else (one + 4, one)
        wires.extend(bytes(pair))
    return wires


def outputs(self, chips, enable, config):
    """Fields of an Outputs."""
    self._enable = enable
    self._enabled = None
    self.ok = False
    self.fault = ""
    self.restarts = 0
    self._config = config
    self._chips = chips
    self._unsent = 0  # bit k: chip k holds other registers than its image
    self._rolling = False  # the motors were told to turn
    self._ticks_a_second = config.servos_frequency // 3 * 3  # each chip has its turn once in three, also from second to second
    self._unseen = 7  # bit k: chip k was not yet looked at as a whole in this second
    self._tick = -1  # counts servo periods round a second; chips that failed are tried at 0
    self._lines = _servo_lines(config, chips[0])
    self._wires = _motor_wires(config)
    self._trims = array("h", bytes(4 * config.axles))  # those that the lines contain


def drive(self, steerings, outputs, config):
    """Fields of a Drive."""
    self.steering, self.aim, self._goal, self._trial = steerings
    self._wheels = wheels = 2 * config.axles
    self._config = config
    self.outputs = outputs
    self._period_us = 1000000 // config.servos_frequency
    self._due = -1
    self.af = self.ar = self.v256 = self.told_v256 = self._goal_v256 = self.restarts = 0
    self.turning = True
    self._possible = False
    self._swinging = False  # the wheels were told to swing; turning without it: the robot still rolls
    self._delay = 0  # periods until the swing shows
    self._positions = array("h", bytes(2 * wheels))  # where the wheels are taken to stand
    self._pointed = None  # angles while one wheel is pointed on its own
    self._past = array("h", bytes(4 * _HISTORY))  # AF, AR of each period
    self._now = 0  # place of the period that has begun
    self._speed = 0  # v256 in 1/256 at its end
