"""Frees an I2C bus whose data line a chip holds low. Loaded when it happens, and let go after."""

from micropython import const

_PULSES = const(9)  # of SCL: after so many a chip that was cut off within a byte lets go


def free(machine, scl):
    """Clock out what the chip wants to say. scl: GPIO."""
    clock = machine.Pin(scl, machine.Pin.OUT, value=1)
    for _ in range(_PULSES):
        clock.value(0)
        clock.value(1)
