"""pca9685.py: the bytes on the bus, and what they do to a chip."""

import micropython
from fake_chips import FakeBus

from actuation.wiring import counts
from pca9685 import PCA9685


class _Log:
    """Hands on to a bus, and notes what is written."""

    def __init__(self, bus=None):
        self.sent = []
        self._bus = bus

    def writeto(self, address, data):
        self.sent.append((address, bytes(data)))
        if self._bus is not None:
            self._bus.writeto(address, data)

    def readfrom_mem_into(self, address, register, buffer):
        self._bus.readfrom_mem_into(address, register, buffer)


def _put(chip, channel, *registers):
    for k in range(4):
        chip.image[1 + 4 * channel + k] = registers[k]


def _error(function):
    try:
        function()
    except (OSError, ValueError) as error:
        return str(error)
    return ""


def test_start_sets_frequency_asleep_and_leaves_all_off():
    log = _Log()
    PCA9685(log, 0x41, frequency=50).start()
    assert log.sent == [
        (0x41, bytes((0x00, 0x30, 0x04))),  # asleep, auto-increment; totem pole, outputs change at STOP, low while disabled
        (0x41, bytes((0xFE, 121))),
        (0x41, bytes((0xFA, 0, 0, 0, 0x10))),
        (0x41, bytes((0x00, 0x20))),
    ]


def test_one_burst_carries_all_channels_in_use_which_are_off_at_first():
    log = _Log()
    chip = PCA9685(log, channels=3)
    _put(chip, 1, 0, 0, 0x33, 0x01)
    chip.write()
    assert log.sent == [(0x40, bytes((0x06, 0, 0, 0, 0x10, 0, 0, 0x33, 0x01, 0, 0, 0, 0x10)))]


def test_chip_shows_the_image():
    bus = FakeBus()
    chip = PCA9685(bus)
    chip.start()
    fake = bus.chips[0x40]
    assert fake.running() and fake.registers[0xFE] == 121 and fake.counts(16) == [0] * 16
    _put(chip, 0, 0, 0, 0x33, 0x01)
    _put(chip, 15, 0, 0x10, 0, 0)
    chip.write()
    assert fake.counts(16) == [307] + [0] * 14 + [4096]


def test_clear_takes_one_byte_and_the_next_burst_agrees():
    bus = FakeBus()
    log = _Log(bus)
    chip = PCA9685(log)
    chip.start()
    fake = bus.chips[0x40]
    _put(chip, 0, 0, 0, 0x33, 0x01)
    _put(chip, 15, 0, 0x10, 0, 0)
    chip.write()
    log.sent.clear()
    chip.clear()
    assert log.sent == [(0x40, bytes((0xFD, 0x10)))]
    assert fake.counts(16) == [0] * 16
    chip.write()
    assert fake.counts(16) == [0] * 16 and fake.registers[6 + 4 * 15 + 1] == 0


def test_start_takes_over_a_running_chip():
    bus = FakeBus()
    fake = bus.chips[0x40]
    fake.write(bytes((0x00, 0x20)))
    fake.write(bytes((0x06, 0, 0, 0x33, 0x01)))
    assert fake.count(0) == 307
    PCA9685(bus, frequency=1000).start()
    assert fake.count(0) == 0 and fake.registers[0xFE] == 5


def test_a_start_leaves_nothing_in_the_image():
    chip = PCA9685(FakeBus(), channels=2)
    fresh = bytes(chip.image)
    _put(chip, 0, 0, 0, 0x33, 0x01)
    chip.start()
    assert bytes(chip.image) == fresh


def test_prescale_of_the_data_sheet():
    for frequency, prescale in ((50, 121), (60, 101), (200, 30), (1000, 5), (1526, 3), (3000, 3), (24, 253), (20, 255)):
        assert PCA9685(None, frequency=frequency).prescale == prescale, frequency


def test_counts_of_servo_pulses():
    chip = PCA9685(None)
    assert [counts(us, chip.prescale) for us in (500, 1500, 2500)] == [102, 307, 512]
    assert counts(1500, chip.prescale, parts=32768) == round(1500 * 25 / 122 * 32768)


def test_a_measured_oscillator_corrects_the_pulses():
    # 8 % fast: the same time takes more counts, once the prescale has taken out what it can
    chip = PCA9685(None, oscillator=27000000)
    assert chip.prescale == 131
    assert abs(counts(1500, chip.prescale, 27000000) * 132 / 27 - 1500) <= 2.5


def test_absent_chip_is_named_with_the_remedy():
    chip = PCA9685(FakeBus(0x41), 0x43)
    for use in (chip.start, chip.write, chip.clear, chip.check, chip.deinit):
        assert _error(use) == "PCA9685 at 0x43 does not answer: check its power, SDA, SCL and address jumpers", use


def test_check_sets_a_chip_up_again_that_was_reset():
    bus = FakeBus()
    chip = PCA9685(bus)
    chip.start()
    assert chip.check()
    bus.chips[0x40].reset()
    assert not chip.check()
    assert bus.chips[0x40].running() and bus.chips[0x40].registers[0xFE] == 121
    assert chip.check()


def test_check_notices_a_lost_frequency():
    bus = FakeBus()
    chip = PCA9685(bus)
    chip.start()
    bus.chips[0x40].registers[0xFE] = 30
    assert not chip.check()
    assert bus.chips[0x40].registers[0xFE] == 121


def test_deinit_switches_off():
    bus = FakeBus()
    chip = PCA9685(bus, channels=1)
    chip.start()
    _put(chip, 0, 0, 0, 0x33, 0x01)
    chip.write()
    chip.deinit()
    assert not bus.chips[0x40].running() and bus.chips[0x40].registers[9] == 0x10


def test_bad_addresses_and_channels_are_refused():
    for address in (0x3F, 0x80, 0x70):
        assert "0x%02x" % address in _error(lambda address=address: PCA9685(None, address))
    for channels in (0, 17):
        assert "16" in _error(lambda address=address: PCA9685(None, channels=channels))


def test_nothing_is_allocated_in_use():
    chip = PCA9685(FakeBus())
    chip.start()
    micropython.heap_lock()
    try:
        for _ in range(3):
            chip.image[3] += 100
            chip.write()
            chip.clear()
            chip.check()
    finally:
        micropython.heap_unlock()


def test_a_chip_that_was_reset_sleeps():
    bus = FakeBus()
    chip = PCA9685(bus, 0x40)
    chip.start()
    assert chip.awake()
    bus.chips[0x40].reset()
    assert not chip.awake()
    bus.chips[0x40].present = False
    assert "0x40" in _error(chip.awake)
