"""PCA9685 chips on a bus, as registers: enough of the data sheet to see what the firmware made them do."""

MODE1, LED0, ALL_LED, PRE_SCALE = 0x00, 0x06, 0xFA, 0xFE
SLEEP, AUTO_INCREMENT = 0x10, 0x20


class FakeChip:
    """Registers of one chip. present = False: it answers nothing."""

    def __init__(self):
        self.present = True
        self.registers = bytearray(256)
        self.bursts = 0
        self.reset()

    def reset(self):
        """As after power-up."""
        for k in range(256):
            self.registers[k] = 0
        self.registers[MODE1] = 0x11
        self.registers[1] = 0x04
        self.registers[PRE_SCALE] = 0x1E
        for k in range(16):
            self.registers[LED0 + 4 * k + 3] = 0x10

    def write(self, data):
        register = data[0]
        self.bursts += 1
        for k in range(1, len(data)):
            value = data[k]
            if register == PRE_SCALE:
                if self.registers[MODE1] & SLEEP:
                    self.registers[register] = value
            elif ALL_LED <= register < ALL_LED + 4:
                for channel in range(16):
                    self.registers[LED0 + 4 * channel + register - ALL_LED] = value
            else:
                self.registers[register] = value
            if self.registers[MODE1] & AUTO_INCREMENT:
                register += 1

    def running(self):
        return self.registers[MODE1] & (SLEEP | AUTO_INCREMENT) == AUTO_INCREMENT

    def count(self, channel):
        """0 .. 4096, or None while the chip sleeps."""
        if not self.running():
            return None
        at = LED0 + 4 * channel
        r = self.registers
        if r[at + 3] & 0x10:
            return 0
        if r[at + 1] & 0x10:
            return 4096
        return (r[at + 2] + 256 * r[at + 3]) - (r[at] + 256 * r[at + 1])

    def counts(self, channels):
        return [self.count(k) for k in range(channels)]


class FakeBus:
    """machine.I2C with chips at 0x40, 0x41, 0x42. Allocates nothing in use."""

    def __init__(self, *addresses):
        self.chips = {address: FakeChip() for address in addresses or (0x40, 0x41, 0x42)}

    def _at(self, address):
        chip = self.chips.get(address)
        if chip is None or not chip.present:
            raise OSError(19)
        return chip

    def writeto(self, address, data):
        self._at(address).write(data)

    def readfrom_mem_into(self, address, register, buffer):
        buffer[0] = self._at(address).registers[register]


class FakePin:
    def __init__(self):
        self.level = None

    def value(self, level):
        self.level = level
