"""What the constructors of drive and outputs do: which register of which chip moves each wheel, and how far. Needed once, at the start."""

from array import array

from micropython import const

_HISTORY = const(32)  # as in drive.py


def _servo_lines(config, chip):
    """Each wheel's pulse over its angle is a line: array 'i' as outputs._servo_registers reads it, without the trims. chip: the servos' PCA9685."""
    wheels = 2 * config.axles
    lines = array("i", [wheels])
    for k in range(wheels):
        first = chip.counts(config.servos_pulse_low[k], 32768)
        last = chip.counts(config.servos_pulse_high[k], 32768)
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
    self._ticks_a_second = config.servos_frequency
    self._looked = -1  # third of a second in which a chip was looked at last
    self._tick = -1  # counts servo periods round a second; chips that failed are tried at 0
    self._lines = _servo_lines(config, chips[0])
    self._wires = _motor_wires(config)
    self._trims = array("h", bytes(4 * config.axles))  # those that the lines contain


def drive(self, steerings, outputs, config):
    """Fields of a Drive."""
    self.steering, self.aim, self._goal, self._trial = steerings
    self._wheels = wheels = 2 * config.axles
    self._config = config
    self._outputs = outputs
    self._low = config.servos_low
    self._high = config.servos_high
    self._period_us = 1000000 // config.servos_frequency
    self._due = -1
    self.af = self.ar = self.v256 = self.told_v256 = self._goal_v256 = self._restarts = 0
    self.turning = True
    self._swinging = False  # the wheels were told to swing; turning without it: the robot still rolls
    self._delay = 0  # periods until the swing shows
    self._positions = array("h", bytes(2 * wheels))  # where the wheels are taken to stand
    self._pointed = array("h", bytes(2 * wheels))  # angles while one wheel is pointed on its own
    self._pointing = False
    self._past = array("h", bytes(4 * _HISTORY))  # AF, AR of each period
    self._now = 0  # place of the period that has begun
    self._speed = 0  # v256 in 1/256 at its end
