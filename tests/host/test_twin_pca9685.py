"""The PWM chip at its registers, against the data sheet."""

import pytest

from host.twin.pca9685 import Pca9685


def awake(prescale=121):
    chip = Pca9685()
    chip.write(bytes([0xFE, prescale]))
    chip.write(bytes([0x00, 0x21]))
    return chip


def test_reset_state():
    chip = Pca9685()
    chip.write(b"\x00")
    assert chip.read(1) == b"\x11"
    chip.write(b"\xfe")
    assert chip.read(1) == b"\x1e"
    assert all(chip.duty(channel) == 0 for channel in range(16))


def test_pulse_width_at_50_hz():
    chip = awake()
    chip.write(bytes([0x06, 0, 0, 307 & 0xFF, 307 >> 8]))
    assert chip.on_us(0) == pytest.approx(1498, abs=1)
    assert chip.period_us == pytest.approx(19988, abs=1)


def test_auto_increment_runs_through_the_channels_and_wraps_behind_the_last():
    chip = awake()
    chip.write(bytes([0x06]) + bytes([0, 0, 100, 0] * 16) + bytes([0x25]))
    assert [chip.duty(channel) for channel in range(16)] == [100 / 4096] * 16
    assert chip.registers[0] == 0x25  # behind the last channel comes MODE1
    chip.write(bytes([0x00, 0x31]))
    chip.write(bytes([0xFA, 0, 0, 0, 0x10, 3, 0x21]))  # behind ALL_LED and PRE_SCALE as well
    assert chip.registers[0xFE] == 3
    assert chip.registers[0] & 0x7F == 0x21


def test_without_auto_increment_one_register_takes_all():
    chip = Pca9685()
    chip.write(bytes([0x06, 1, 2, 3]))
    assert bytes(chip.registers[6:10]) == bytes([3, 0, 0, 0x10])


def test_full_off_wins_over_full_on():
    chip = awake()
    chip.write(bytes([0x06, 0, 0x10, 0, 0]))
    assert chip.duty(0) == 1
    chip.write(bytes([0x06, 0, 0x10, 0, 0x10]))
    assert chip.duty(0) == 0


def test_on_count_shifts_the_pulse_only():
    chip = awake()
    chip.write(bytes([0x06, 0x00, 0x0F, 0x2C, 0x01]))  # on at 3840, off at 300 of the next period
    assert chip.duty(0) == pytest.approx(556 / 4096)


def test_prescale_is_taken_only_asleep_and_not_below_3():
    chip = awake(121)
    chip.write(bytes([0xFE, 5]))
    assert chip.registers[0xFE] == 121
    chip.write(bytes([0x00, 0x31]))
    chip.write(bytes([0xFE, 1]))
    assert chip.registers[0xFE] == 3


def test_asleep_nothing_comes_out_and_restart_shows():
    chip = awake()
    chip.write(bytes([0x06, 0, 0, 100, 0]))
    chip.write(bytes([0x00, 0x31]))
    assert chip.duty(0) == 0
    assert chip.registers[0] & 0x80
    chip.write(bytes([0x00, 0x21]))
    chip.write(bytes([0x00, 0xA1]))
    assert not chip.registers[0] & 0x80
    assert chip.duty(0) > 0


def test_all_channels_register():
    chip = awake()
    chip.write(bytes([0xFA, 0, 0, 50, 0]))
    assert {chip.duty(channel) for channel in range(16)} == {50 / 4096}
    chip.write(b"\xfa")
    assert chip.read(4) == bytes(4)  # write only
