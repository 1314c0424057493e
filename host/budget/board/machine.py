"""Devices that take what the firmware does and answer as if all were well: for measuring memory. The lidar's UART sends what is in lidar.bin."""

import clock

PWRON_RESET = 1
HARD_RESET = 2
WDT_RESET = 3
DEEPSLEEP_RESET = 4
SOFT_RESET = 5
tell = None  # tell(event, ...) of whoever records the start


class Pin:
    """A pin at its idle level, high."""

    IN, OUT, PULL_UP, PULL_DOWN, IRQ_FALLING, IRQ_RISING = 0, 1, 2, 1, 2, 1

    def __init__(self, gpio, *settings, **named):
        self.gpio = gpio

    def value(self, level=None):
        return 1

    __call__ = value

    def init(self, *settings, **named):
        pass

    def irq(self, *settings, **named):
        pass

    def on(self):
        pass

    def off(self):
        pass


_registers = {0x40: bytearray(256), 0x41: bytearray(256), 0x42: bytearray(256)}  # of the three PCA9685


class I2C:
    """A bus on which the three chips answer and remember what was written."""

    def __init__(self, *settings, **named):
        self._at = 0

    def writeto(self, address, data, stop=True):
        registers = _registers[address]
        self._at = data[0]
        for k in range(1, len(data)):
            registers[self._at + k - 1] = data[k]
        registers[0] &= 0x7F  # RESTART reads as 0 once it is done
        return len(data)

    def writeto_mem(self, address, register, data):
        registers = _registers[address]
        for k in range(len(data)):
            registers[register + k] = data[k]
        registers[0] &= 0x7F

    def readfrom_into(self, address, buffer, stop=True):
        self.readfrom_mem_into(address, self._at, buffer)

    def readfrom_mem_into(self, address, register, buffer):
        registers = _registers[address]
        for k in range(len(buffer)):
            buffer[k] = registers[register + k]

    def readfrom_mem(self, address, register, count):
        return bytes(_registers[address][register : register + count])

    def scan(self):
        return sorted(_registers)


class UART:
    """Takes all and sends nothing, but for the first with a receiving pin and no sending one: that is the lidar's."""

    def __init__(self, id, baudrate=115200, tx=None, rx=None, rxbuf=256, txbuf=256, **settings):
        tell("uart", "lidar" if tx is None else "screen", rxbuf, txbuf)
        self._frames = open("lidar.bin", "rb") if tx is None else None
        self._since = clock.now
        self._owed = 0
        self._most = rxbuf

    def init(self, *settings, **named):
        pass

    def any(self):
        if self._frames is None:
            return 0
        passed = (clock.now - self._since) & 0x3FFFFFFF
        count = passed // 74  # us a byte: 38 points, 105.6 frames a second
        self._since = (self._since + 74 * count) & 0x3FFFFFFF
        self._owed = min(self._owed + count, self._most)
        return self._owed

    def readinto(self, buffer, count=-1):
        waiting = self.any()
        if not waiting:
            return None
        if count < 0 or count > len(buffer):
            count = len(buffer)
        view = memoryview(buffer)[: min(count, waiting)]
        got = self._frames.readinto(view)
        if not got:
            self._frames.seek(0)
            return None
        self._owed -= got
        return got

    def read(self, count=-1):
        return None

    def write(self, data):
        return len(data)


class PWM:
    """A motor that turns."""

    def __init__(self, *settings, **named):
        pass

    def duty_u16(self, duty=None):
        return 0

    def freq(self, hertz=None):
        return 0

    def deinit(self):
        pass


class ADC:
    """A full battery."""

    ATTN_11DB = 3

    def __init__(self, *settings, **named):
        pass

    def read_u16(self):
        return 48000

    def read_uv(self):
        return 2600000


class WDT:
    """A watchdog that never bites."""

    def __init__(self, id=0, timeout=5000):
        pass

    def feed(self):
        pass


class RTC:
    """A clock whose memory takes what it is given."""

    def memory(self, data=None):
        return b"" if data is None else None


def reset():
    raise SystemExit


def reset_cause():
    return PWRON_RESET


def unique_id():
    return b"budget"


def freq(hertz=None):
    return 240000000


def disable_irq():
    return 0


def enable_irq(state):
    pass
