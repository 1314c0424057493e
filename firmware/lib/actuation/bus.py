"""The I2C bus of the PWM chips. The ESP32's driver waits 100 ms for each byte of a transfer when a chip holds SDA low, so nothing is begun then."""

from micropython import const

from core.unload import forget

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
        """What the chip was told before is lost: OSError even if that helps."""
        from actuation.bus_recovery import free

        free(self._machine, self._wiring[1])
        forget("actuation.bus_recovery")
        self._join()
        raise OSError(_TIMED_OUT)
