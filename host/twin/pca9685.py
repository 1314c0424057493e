"""The PCA9685 PWM chip as a register model. Source: NXP PCA9685 data sheet."""

MODE1, MODE2, LED0, LAST_LED, ALL_LED, PRE_SCALE, TEST = 0x00, 0x01, 0x06, 0x45, 0xFA, 0xFE, 0xFF
RESTART, AI, SLEEP, ALLCALL = 0x80, 0x20, 0x10, 0x01
FULL = 0x10
CHANNELS = 16


class Pca9685:
    """One chip.

    oscillator: Hz. The registers are bytes as on the chip; `on_us` and `duty` say what comes out of a channel.
    """

    def __init__(self, oscillator=25_000_000.0):
        self.oscillator = oscillator
        self.reset()

    def reset(self):
        """Power-on state."""
        self.registers = bytearray(256)
        self.registers[MODE1] = SLEEP | ALLCALL
        self.registers[MODE2] = 0x04
        self.registers[2:6] = bytes((0xE2, 0xE4, 0xE8, 0xE0))
        for channel in range(CHANNELS):
            self.registers[LED0 + 4 * channel + 3] = FULL
        self.registers[PRE_SCALE] = 0x1E
        self.pointer = 0

    def write(self, data):
        """One I2C write: register number, then the bytes for it and, with AI, those behind it."""
        if not data:
            return
        self.pointer = data[0]
        end = self.pointer + len(data) - 1
        if self.registers[MODE1] & AI and LED0 <= self.pointer and end <= LAST_LED + 1:  # the usual burst, in one piece
            self.registers[self.pointer : end] = data[1:]
            self.registers[MODE1] &= ~RESTART
            self.pointer = end if end <= LAST_LED else 0
            return
        for value in data[1:]:
            self._store(self.pointer, value)
            self._step()

    def read(self, count):
        """Bytes from where the pointer stands."""
        out = bytearray()
        for _ in range(count):
            write_only = ALL_LED <= self.pointer < PRE_SCALE
            out.append(0 if write_only else self.registers[self.pointer])
            self._step()
        return bytes(out)

    @property
    def awake(self):
        """True while the oscillator runs."""
        return not self.registers[MODE1] & SLEEP

    @property
    def period_us(self):
        """Length of one PWM period."""
        return 4096 * self._count_us

    def on_us(self, channel):
        """Width of the channel's pulse, us; 0 when it stays low, the whole period when it stays high."""
        return self._counts(channel) * self._count_us if self.awake else 0.0

    def duty(self, channel):
        """Share of the time the channel is high, 0..1."""
        return self._counts(channel) / 4096 if self.awake else 0.0

    @property
    def _count_us(self):
        return (self.registers[PRE_SCALE] + 1) / self.oscillator * 1e6

    def _counts(self, channel):
        on_l, on_h, off_l, off_h = self.registers[LED0 + 4 * channel : LED0 + 4 * channel + 4]
        if off_h & FULL:
            return 0
        if on_h & FULL:
            return 4096
        return ((off_l | (off_h & 0x0F) << 8) - (on_l | (on_h & 0x0F) << 8)) % 4096

    def _store(self, register, value):
        if register == MODE1:
            # Writing 1 to RESTART clears it; it sets itself when the chip goes to sleep with outputs running.
            running = self.awake and any(self._counts(channel) for channel in range(CHANNELS))
            restart = self.registers[MODE1] & RESTART & ~value
            if value & SLEEP and running:
                restart = RESTART
            self.registers[MODE1] = value & ~RESTART | restart
        elif register == PRE_SCALE:
            if not self.awake:
                self.registers[PRE_SCALE] = max(value, 3)
        elif ALL_LED <= register < PRE_SCALE:
            for channel in range(CHANNELS):
                self.registers[LED0 + 4 * channel + register - ALL_LED] = value
        elif register <= LAST_LED:
            self.registers[register] = value
            if register >= LED0:
                self.registers[MODE1] &= ~RESTART

    def _step(self):
        if self.registers[MODE1] & AI:
            if self.pointer in (LAST_LED, PRE_SCALE):
                self.pointer = 0
            else:
                self.pointer = (self.pointer + 1) & 0xFF
