"""bus.py: nothing is begun on a bus that a chip holds, and nine pulses of SCL free it."""

from actuation.bus import Bus


class Machine:
    """A board whose SDA is held low until SCL has risen so many times."""

    pulses = 0

    class Pin:
        OUT = 3

        def __init__(self, gpio, mode=None, value=None):
            self.gpio = gpio
            self.level = value

        def value(self, level=None):
            if level is None:
                return int(Machine.pulses <= 0)
            if level > self.level:
                Machine.pulses -= 1
            self.level = level

    class I2C:
        def __init__(self, number, scl, sda, freq):
            self.sent = Machine.sent

        def writeto(self, address, data):
            self.sent.append((address, bytes(data)))

        def readfrom_mem_into(self, address, register, buffer):
            self.sent.append((address, register))

    sent = []


def _refused(function, *arguments):
    try:
        function(*arguments)
    except OSError:
        return True
    return False


def make(pulses=0):
    Machine.sent, Machine.pulses = [], 0
    bus = Bus(Machine, 0, 22, 21, 400000)
    Machine.pulses = pulses
    return bus


def test_a_free_bus_is_used():
    bus = make()
    bus.writeto(0x41, b"\1\2")
    bus.readfrom_mem_into(0x41, 0, bytearray(1))
    assert Machine.sent == [(0x41, b"\1\2"), (0x41, 0)]


def test_a_held_bus_is_refused_at_once_and_freed_for_the_next():
    for method, arguments in (("writeto", (0x41, b"\1")), ("readfrom_mem_into", (0x41, 0, bytearray(1)))):
        bus = make(9)
        assert _refused(getattr(bus, method), *arguments) and Machine.sent == []
        assert not _refused(getattr(bus, method), *arguments) and len(Machine.sent) == 1


def test_a_short_to_ground_stays_refused():
    bus = make(1000)
    for _ in range(3):
        assert _refused(bus.writeto, 0x41, b"\1") and Machine.sent == []
