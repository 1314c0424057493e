"""`machine` as the firmware sees it on the simulated board: the parts of the ESP32 that have wires to something in the twin."""

import lockstep
from micropython import const

PWRON_RESET = const(1)
HARD_RESET = const(2)
WDT_RESET = const(3)
DEEPSLEEP_RESET = const(4)
SOFT_RESET = const(5)

_ENODEV = const(19)
_I2C_OVERHEAD_US = const(40)  # driver time of one transfer, from what 4 and 64 data bytes take on the chip
_frequency = 160000000


def reset_cause():
    """The board has just been switched on."""
    return PWRON_RESET


def reset():
    """Restart; ends the run, as the twin shows one life of the board."""
    lockstep.reset()


soft_reset = reset


def freq(hertz=None):
    """Clock of the processor, Hz. Has no effect: computing takes no time here."""
    global _frequency
    if hertz is None:
        return _frequency
    _frequency = hertz


def unique_id():
    """Six bytes, as the ESP32's."""
    return b"\x02twin\x00"


def idle():
    """Nothing to wait for."""


def disable_irq():
    """No interrupts to disable."""
    return 0


def enable_irq(state):
    """No interrupts to enable."""


class Pin:
    """A GPIO. Outputs are noted with their time; inputs show what the twin has wired to the pin."""

    IN = const(1)
    OUT = const(3)
    OPEN_DRAIN = const(7)
    PULL_UP = const(2)
    PULL_DOWN = const(1)
    IRQ_RISING = const(1)
    IRQ_FALLING = const(2)

    def __init__(self, gpio, mode=-1, pull=-1, *, value=None):
        self.gpio = gpio
        self._output = False
        self._level = -1
        self.init(mode, pull, value=value)

    def init(self, mode=-1, pull=-1, *, value=None):
        """Set the direction and, for an output, the first level."""
        if mode != -1:
            self._output = mode in (Pin.OUT, Pin.OPEN_DRAIN)
        if value is not None:
            self.value(value)

    def value(self, level=None):
        """Read the pin, or set it."""
        if level is None:
            return int(self._level == 1) if self._output else lockstep.level(self.gpio)
        level = 1 if level else 0
        if level != self._level:
            self._level = level
            lockstep.note(lockstep.PIN, self.gpio, level, None, 0)

    def __call__(self, level=None):
        return self.value(level)

    def on(self):
        """High."""
        self.value(1)

    def off(self):
        """Low."""
        self.value(0)

    def irq(self, handler=None, trigger=0):
        """Accepted and never called: inputs are to be polled."""


def _gpio(pin):
    return pin.gpio if isinstance(pin, Pin) else pin


class PWM:
    """Pulse width modulation on a pin."""

    def __init__(self, pin, freq=5000, duty_u16=0, duty_ns=None, duty=None):
        self._pin = _gpio(pin)
        self._duty = -1
        self._freq = -1
        self.freq(freq)
        if duty_ns is not None:
            self.duty_ns(duty_ns)
        elif duty is not None:
            self.duty(duty)
        else:
            self.duty_u16(duty_u16)

    def freq(self, hertz=None):
        """Frequency, Hz."""
        if hertz is None:
            return self._freq
        if hertz != self._freq:
            self._freq = hertz
            lockstep.note(lockstep.PWM_FREQUENCY, self._pin, min(hertz, 65535), None, 0)

    def duty_u16(self, duty=None):
        """Share of the time the pin is high, 0..65535."""
        if duty is None:
            return self._duty
        if not 0 <= duty <= 65535:
            raise ValueError("duty_u16 must be from 0 to 65535")
        if duty != self._duty:
            self._duty = duty
            lockstep.note(lockstep.PWM_DUTY, self._pin, duty, None, 0)

    def duty(self, duty=None):
        """Share of the time the pin is high, 0..1023."""
        if duty is None:
            return self._duty >> 6
        self.duty_u16(min(duty * 64, 65535))

    def duty_ns(self, width=None):
        """Width of the pulse, ns."""
        if width is None:
            return self._duty * 1000000000 // 65535 // self._freq
        self.duty_u16(min(width * self._freq * 65535 // 1000000000, 65535))

    def deinit(self):
        """Stop: the pin is low."""
        self.duty_u16(0)


class ADC:
    """The battery divider."""

    ATTN_0DB = const(0)
    ATTN_2_5DB = const(1)
    ATTN_6DB = const(2)
    ATTN_11DB = const(3)
    WIDTH_12BIT = const(12)

    def __init__(self, pin, atten=3):
        self._pin = _gpio(pin)

    def init(self, atten=3):
        """Accepted; the range is always that of 11 dB."""

    def atten(self, atten):
        """Accepted; the range is always that of 11 dB."""

    def width(self, bits):
        """Accepted."""

    def read_u16(self):
        """Reading, 0..65535 over 3.3 V."""
        return lockstep.adc()

    def read_uv(self):
        """Reading, uV."""
        return lockstep.adc() * 3300000 // 65535

    def read(self):
        """Reading, 0..4095."""
        return lockstep.adc() >> 4


class UART:
    """A serial port. Bytes arrive when the twin says so; a full receive buffer loses what comes."""

    def __init__(self, id, baudrate=115200, bits=8, parity=None, stop=1, *, tx=-1, rx=-1, rxbuf=256, txbuf=256, timeout=0,
                 timeout_char=0, invert=0, flow=0):
        self.baudrate = baudrate
        self._tx = _gpio(tx)
        self._size = max(rxbuf, 128)
        self._ring = bytearray(self._size)
        self._head = 0
        self._count = 0
        if _gpio(rx) >= 0:
            lockstep.attach(_gpio(rx), self)

    def init(self, baudrate=115200, bits=8, parity=None, stop=1, **settings):
        """Change the speed."""
        self.baudrate = baudrate

    def any(self):
        """Bytes waiting."""
        lockstep.deliver()
        return self._count

    def readinto(self, buffer, count=-1):
        """Move waiting bytes to the buffer: their number, or None when there are none. Never waits."""
        lockstep.deliver()
        if count < 0 or count > len(buffer):
            count = len(buffer)
        if count > self._count:
            count = self._count
        if count == 0:
            return None
        first = min(count, self._size - self._head)
        lockstep.copy(buffer, 0, self._ring, self._head, first)
        lockstep.copy(buffer, first, self._ring, 0, count - first)
        self._head = (self._head + count) % self._size
        self._count -= count
        return count

    def read(self, count=-1):
        """Waiting bytes, or None. Never waits."""
        waiting = self.any()
        buffer = bytearray(waiting if count < 0 else min(count, waiting))
        return bytes(buffer) if self.readinto(buffer) else None

    def write(self, data):
        """Send; the bytes are on the wire at once."""
        count = len(data)
        lockstep.note(lockstep.UART_OUTPUT, self._tx & 255, count, data, count)
        return count

    def txdone(self):
        """Always True."""
        return True

    def flush(self):
        """Nothing to wait for."""

    def deinit(self):
        """Nothing to release."""

    def put(self, source, start, count):
        """The twin's side: bytes arrive."""
        room = self._size - self._count
        if count > room:
            lockstep.overflows += count - room
            count = room
        tail = (self._head + self._count) % self._size
        first = min(count, self._size - tail)
        lockstep.copy(self._ring, tail, source, start, first)
        lockstep.copy(self._ring, 0, source, start + first, count - first)
        self._count += count


class I2C:
    """The I2C bus. A transfer takes its time on the wire; an absent device raises OSError(19)."""

    def __init__(self, id=0, *, scl=None, sda=None, freq=400000, timeout=50000):
        self._bit_ns = 1000000000 // freq
        self._register = bytearray(1)
        self._joined = bytearray(160)

    def _transfer(self, address, count):
        """Pass the time of `count` bytes and the address; raise when nobody acknowledges."""
        present = lockstep.acknowledges(address)
        bits = (1 + count) * 9 + 2 if present else 11
        lockstep.advance_to(lockstep.now + _I2C_OVERHEAD_US + bits * self._bit_ns // 1000)
        if not present:
            raise OSError(_ENODEV)

    def scan(self):
        """Addresses that acknowledge."""
        return [address for address in range(8, 0x78) if lockstep.acknowledges(address)]

    def writeto(self, address, buffer, stop=True):
        """Write; returns the number of bytes acknowledged."""
        count = len(buffer)
        self._transfer(address, count)
        lockstep.note(lockstep.I2C_WRITE, address, count, buffer, count)
        return count

    def writeto_mem(self, address, register, buffer, *, addrsize=8):
        """Write to a register and those behind it."""
        count = len(buffer)
        if count >= len(self._joined):
            raise ValueError("at most 159 bytes in one write")
        self._joined[0] = register
        lockstep.copy(self._joined, 1, buffer, 0, count)
        self._transfer(address, count + 1)
        lockstep.note(lockstep.I2C_WRITE, address, count + 1, self._joined, count + 1)

    def writevto(self, address, vector, stop=True):
        """Write several buffers as one."""
        return self.writeto(address, b"".join(bytes(part) for part in vector))

    def readfrom_into(self, address, buffer, stop=True):
        """Read from where the register pointer stands."""
        self._transfer(address, len(buffer))
        lockstep.read(address, buffer, len(buffer))

    def readfrom(self, address, count, stop=True):
        """Read from where the register pointer stands."""
        buffer = bytearray(count)
        self.readfrom_into(address, buffer)
        return bytes(buffer)

    def readfrom_mem_into(self, address, register, buffer, *, addrsize=8):
        """Read a register and those behind it."""
        self._register[0] = register
        self.writeto(address, self._register)
        self.readfrom_into(address, buffer)

    def readfrom_mem(self, address, register, count, *, addrsize=8):
        """Read a register and those behind it."""
        buffer = bytearray(count)
        self.readfrom_mem_into(address, register, buffer)
        return bytes(buffer)


SoftI2C = I2C


class WDT:
    """The watchdog: when it is not fed in time the board resets, which ends the run."""

    def __init__(self, id=0, timeout=5000):
        self._timeout_us = timeout * 1000
        self.feed()

    def feed(self):
        """Start the time-out again."""
        lockstep.watchdog_at = lockstep.now + self._timeout_us


class Timer:
    """Accepted and never called: the firmware's loop keeps its own time."""

    ONE_SHOT = const(0)
    PERIODIC = const(1)

    def __init__(self, id=-1, **settings):
        pass

    def init(self, **settings):
        """Accepted."""

    def deinit(self):
        """Accepted."""
