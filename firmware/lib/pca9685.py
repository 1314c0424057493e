"""PCA9685: sixteen PWM outputs on I2C.

A register image is kept here and sent as one burst, so that all outputs of a chip change together, at the STOP of the transfer.

    chip = PCA9685(i2c, 0x40, frequency=50, oscillator=25_000_000)
    chip.start()                      # every output off
    count = 307                       # of 4096: 1500 us
    chip.image[3] = count & 0xFF      # OFF_L and OFF_H of output 0
    chip.image[4] = count >> 8
    chip.write()

Source: NXP PCA9685 data sheet.
"""

import time

import micropython
from micropython import const

_MODE1 = const(0x00)
_PRE_SCALE = const(0xFE)  # taken only while the chip sleeps

_SLEEP = const(0x10)
_AUTO_INCREMENT = const(0x20)
_FULL = const(0x10)  # bit 4 of ON_H: always on; of OFF_H: always off, which wins

_OSCILLATOR_START_US = const(500)

_ASLEEP = const(b"\x00\x30\x04")  # MODE1: auto increment, sleep; MODE2: totem pole
_AWAKE = const(b"\x00\x20")
_CLEARED = const(b"\xfa\x00\x00\x00\x10")  # all channels off; also clears a restart left pending by the sleep
_ALL_OFF = const(b"\xfd\x10")  # the last byte of that does it


@micropython.viper
def _blank(image: ptr8, size: int):
    at = 1
    while at < size:
        image[at] = 0
        image[at + 1] = 0
        image[at + 2] = 0
        image[at + 3] = _FULL
        at += 4


class PCA9685:
    """One chip.

    i2c: machine.I2C; address: 0x40 .. 0x7F except 0x70; frequency: of all outputs, Hz; oscillator: the chip's own, Hz (nominally 25 MHz,
    23 to 27 in practice: measure an output and correct it here); channels: how many, from 0 up, are in use and sent.

    image       bytearray: the number of the first register, then ON_L, ON_H, OFF_L, OFF_H of each channel in use, off at first. A pulse of
                0 < count < 4096 is 0, 0 and the count; bit 4 of ON_H is always on, bit 4 of OFF_H always off, which wins.

    The bus is first touched by start(), so that an owner can name an absent chip and try again.
    Every method that uses the bus raises OSError, with the address and the remedy, if the chip does not answer; else none of them allocates.
    """

    def __init__(self, i2c, address=0x40, frequency=50, oscillator=25000000, channels=16):
        from actuation.wiring import chip

        chip(self, i2c, address, frequency, oscillator, channels)
        _blank(self.image, len(self.image))

    def start(self):
        """Set up the chip, whatever it did before, with every output off, in the image too."""
        self.send(_ASLEEP)
        self.send(self._scale)
        self.send(_CLEARED)
        self.send(_AWAKE)
        _blank(self.image, len(self.image))
        time.sleep_us(_OSCILLATOR_START_US)

    def write(self):
        """Send the image in one burst."""
        self.send(self.image)

    def clear(self):
        """Every output off, now and in the image: one byte does it, a ninth of the time of a burst of ten channels."""
        self.send(_ALL_OFF)
        _blank(self.image, len(self.image))

    def check(self):
        """False if the chip has lost its settings, as after a dip of its supply; it is then set up again: see start()."""
        byte = self._byte
        try:
            self._i2c.readfrom_mem_into(self.address, _MODE1, byte)
            good = byte[0] & (_SLEEP | _AUTO_INCREMENT) == _AUTO_INCREMENT
            self._i2c.readfrom_mem_into(self.address, _PRE_SCALE, byte)
        except OSError:
            self._absent()
        if good and byte[0] == self.prescale:
            return True
        self.start()
        return False

    def awake(self):
        """False if it has been reset: a chip without settings sleeps. A part of check()."""
        try:
            self._i2c.readfrom_mem_into(self.address, _MODE1, self._byte)
        except OSError:
            self._absent()
        return not self._byte[0] & _SLEEP

    def deinit(self):
        """Every output off, oscillator stopped."""
        self.send(_CLEARED)
        self.send(_ASLEEP)

    def send(self, registers):
        try:
            self._i2c.writeto(self.address, registers)
        except OSError:
            self._absent()

    def _absent(self):
        raise OSError("PCA9685 at 0x%02x does not answer: check its power, SDA, SCL and address jumpers" % self.address)
