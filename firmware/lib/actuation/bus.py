"""The I2C bus of the PWM chips. The ESP32's driver waits 100 ms for each byte of a transfer when a chip holds SDA low, so nothing is begun then."""

from micropython import const

_PULSES = const(9)  # of SCL: after so many a chip that was cut off within a byte lets go
_TIMED_OUT = const(116)


class Bus:
    """machine: the module; number, scl, sda, frequency: of machine.I2C. OSError at once while SDA is held low; each time it is tried to free it."""

    def __init__(self, machine, number, scl, sda, frequency):
        self._machine = machine
        self._wiring = number, scl, sda, frequency
        self._join()

    def writeto(self, address, data):
        if not self._sda.value():
            self._free()
        self._i2c.writeto(address, data)

    def readfrom_mem_into(self, address, register, buffer):
        if not self._sda.value():
            self._free()
        self._i2c.readfrom_mem_into(address, register, buffer)

    def _join(self):
        pin = self._machine.Pin
        number, scl, sda, frequency = self._wiring
        self._i2c = self._machine.I2C(number, scl=pin(scl), sda=pin(sda), freq=frequency)
        self._sda = pin(sda)

    def _free(self):
        """Clock out what the chip wants to say. What it was told before is lost: OSError even if that helps."""
        scl = self._machine.Pin(self._wiring[1], self._machine.Pin.OUT, value=1)
        for _ in range(_PULSES):
            scl.value(0)
            scl.value(1)
        self._join()
        raise OSError(_TIMED_OUT)
