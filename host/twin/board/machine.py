"""`machine` as the firmware sees it on the simulated board: the parts of the ESP32 that have wires to something in the twin.

What is rarely used is in machine_more.py, and loaded when it is asked for: this lies in the robot's own heap.
"""

import charge
import lockstep
from micropython import const

_HARD_RESET = const(2)
_ENODEV = const(19)
_I2C_OVERHEAD_US = const(40)  # driver time of one transfer, from what 4 and 64 data bytes take on the chip


def reset_cause():
    """Why the board started; the numbers are in machine_more."""
    return lockstep.cause


def reset():
    """Start again, as after switching on but for the cause."""
    lockstep.reset(_HARD_RESET)


def unique_id():
    """Six bytes, as the ESP32's."""
    return b"\x02twin\x00"


def __getattr__(name):
    import machine_more

    return getattr(machine_more, name)


class Pin:
    """A GPIO. Outputs are noted with their time; inputs show what the twin has wired to the pin."""

    IN = const(1)
    OUT = const(3)
    PULL_UP = const(2)

    def __init__(self, gpio, mode=-1, pull=-1, *, value=None):
        self.gpio = gpio
        self._output = False
        self._level = -1
        self.init(mode, pull, value=value)

    def init(self, mode=-1, pull=-1, *, value=None):
        """Set the direction and, for an output, the first level."""
        if mode != -1:
            self._output = mode == Pin.OUT
        if value is not None:
            self.value(value)

    def value(self, level=None):
        """Read the pin, or set it."""
        charge.settle()
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


def _gpio(pin):
    return pin.gpio if isinstance(pin, Pin) else pin


class PWM:
    """Pulse width modulation on a pin."""

    def __init__(self, pin, freq=5000, duty_u16=0):
        self._pin = _gpio(pin)
        self._duty = -1
        self._freq = -1
        self.freq(freq)
        self.duty_u16(duty_u16)

    def freq(self, hertz=None):
        """Frequency, Hz."""
        if hertz is None:
            return self._freq
        charge.settle()
        if hertz != self._freq:
            self._freq = hertz
            lockstep.note(lockstep.PWM_FREQUENCY, self._pin, min(hertz, 65535), None, 0)

    def duty_u16(self, duty=None):
        """Share of the time the pin is high, 0..65535."""
        if duty is None:
            return self._duty
        if not 0 <= duty <= 65535:
            raise ValueError("duty_u16 must be from 0 to 65535")
        charge.settle()
        if duty != self._duty:
            self._duty = duty
            lockstep.note(lockstep.PWM_DUTY, self._pin, duty, None, 0)

    def deinit(self):
        """Stop: the pin is low."""
        self.duty_u16(0)


class ADC:
    """The battery divider."""

    ATTN_11DB = 3

    def __init__(self, pin, atten=0):
        self._pin = _gpio(pin)

    def read_u16(self):
        """Reading, 0..65535 over 3.3 V."""
        return lockstep.adc()

    def read_uv(self):
        """Reading, uV."""
        reading = lockstep.adc()
        return reading * 50 + reading * 1550 // 4369  # times 3300000 / 65535, in small integers: the board makes no object of it


class UART:
    """A serial port. Bytes arrive when the twin says so; a full receive buffer loses what comes."""

    def __init__(self, id, baudrate=115200, tx=-1, rx=-1, rxbuf=256, **settings):
        self.baudrate = baudrate
        self._tx = _gpio(tx)
        self._size = max(rxbuf, 128)
        self._waiting = open("uart%d" % id, "w+b")  # a file: on the ESP32 these bytes lie outside the heap as well
        self._head = 0
        self._count = 0
        if _gpio(rx) >= 0:
            lockstep.attach(_gpio(rx), self)

    def init(self, baudrate=115200, bits=8, parity=None, stop=1, **settings):
        """Change the speed."""
        self.baudrate = baudrate

    def any(self):
        """Bytes waiting."""
        charge.settle()
        lockstep.deliver()
        return self._count

    def readinto(self, buffer, count=-1):
        """Move waiting bytes to the buffer: their number, or None when there are none. Never waits."""
        charge.settle()
        lockstep.deliver()
        if count < 0 or count > len(buffer):
            count = len(buffer)
        if count > self._count:
            count = self._count
        if count == 0:
            return None
        self._waiting.seek(self._head)
        lockstep.load(self._waiting, buffer, count)
        self._head += count
        self._count -= count
        charge.taken_in += count
        return count

    def read(self, count=-1):
        """Waiting bytes, or None. Never waits."""
        waiting = self.any()
        buffer = bytearray(waiting if count < 0 else min(count, waiting))
        return bytes(buffer) if self.readinto(buffer) else None

    def write(self, data):
        """Send; the bytes are on the wire at once."""
        count = len(data)
        charge.settle()
        charge.given_out += count
        lockstep.note(lockstep.UART_OUTPUT, self._tx & 255, count, data, count)
        return count

    def put(self, source, start, count):
        """The twin's side: bytes arrive."""
        room = self._size - self._count
        if count > room:
            lockstep.overflows += count - room
            count = room
        if self._count == 0:
            self._head = 0
        self._waiting.seek(self._head + self._count)
        lockstep.store(self._waiting, source, start, count)
        self._count += count


class I2C:
    """The I2C bus. A transfer takes its time on the wire; an absent device raises OSError(19)."""

    def __init__(self, id=0, freq=400000, **settings):
        self._bit_ns = 1000000000 // freq
        self._register = bytearray(1)
        self._joined = bytearray(160)

    def transfer(self, address, count):
        """Pass the time of `count` bytes and the address; raise when nobody acknowledges."""
        charge.settle()
        present = lockstep.acknowledges(address)
        bits = (1 + count) * 9 + 2 if present else 11
        lockstep.advance(_I2C_OVERHEAD_US + bits * self._bit_ns // 1000)
        if not present:
            raise OSError(_ENODEV)

    def scan(self):
        """Addresses that acknowledge."""
        return [address for address in range(8, 0x78) if lockstep.acknowledges(address)]

    def writeto(self, address, buffer, stop=True):
        """Write; returns the number of bytes acknowledged."""
        count = len(buffer)
        self.transfer(address, count)
        lockstep.note(lockstep.I2C_WRITE, address, count, buffer, count)
        return count

    def writeto_mem(self, address, register, buffer):
        """Write to a register and those behind it."""
        count = len(buffer)
        if count >= len(self._joined):
            raise ValueError("at most 159 bytes in one write")
        self._joined[0] = register
        lockstep.copy(self._joined, 1, buffer, 0, count)
        self.transfer(address, count + 1)
        lockstep.note(lockstep.I2C_WRITE, address, count + 1, self._joined, count + 1)

    def readfrom_into(self, address, buffer, stop=True):
        """Read from where the register pointer stands."""
        self.transfer(address, len(buffer))
        lockstep.read(address, buffer, len(buffer))

    def readfrom_mem_into(self, address, register, buffer):
        """Read a register and those behind it."""
        self._register[0] = register
        self.writeto(address, self._register)
        self.readfrom_into(address, buffer)

    def readfrom_mem(self, address, register, count):
        """Read a register and those behind it."""
        buffer = bytearray(count)
        self.readfrom_mem_into(address, register, buffer)
        return bytes(buffer)
