"""Which register of which chip moves each wheel, and how far. Needed once, at the start."""

from array import array


def servo_lines(config, chip):
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


def motor_wires(config):
    """Where the image of its chip has the two inputs of each motor: bytes as outputs._motor_registers reads them."""
    wheels = 2 * config.axles
    wires = bytearray([wheels])
    for k in range(wheels):
        one = 2 + 4 * config.motors_channels[k >> 1]
        pair = (one, one + 4) if config.motors_directions[k] > 0 else (one + 4, one)
        wires.extend(bytes(pair))
    return wires
