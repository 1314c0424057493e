"""health.py: what stops the robot, and what does not."""

import micropython

from link.reason_texts import FAULTS
from safety.health import Health


class Config:
    battery_divider1000 = 3000
    battery_low = 6600
    battery_empty = 6200


class Part:
    ok = True
    v256 = 0


class Pin:
    level = 1

    def value(self):
        return self.level


class Adc:
    microvolts = 2_466_000  # 7.4 V over 3

    def read_uv(self):
        return self.microvolts


def make(adc=None, button=None):
    lidar, drive = Part(), Part()
    lidar.ok = drive.ok = True
    return Health(lidar, drive, button, adc, Config), lidar, drive


def _fault(word):
    """The number of the fault that is called so."""
    return [k for k in range(len(FAULTS)) if word in FAULTS[k]][0]


def run(check, start, stop, step=5000):
    """What the last check says."""
    for now in range(start, stop, step):
        well = check.check(now)
    return well


def test_a_robot_without_button_and_divider_is_well():
    check, _, _ = make()
    assert check.check(0) and check.fault == 0 and check.battery_mv == 0 and not check.battery_low


def test_button_stops_at_once_and_releases_after_a_moment():
    button = Pin()
    check, _, _ = make(button=button)
    assert check.check(0)
    button.level = 0
    assert not check.check(5000) and check.fault == _fault("button")
    button.level = 1
    assert not check.check(10_000) and check.fault == _fault("well again")
    assert not run(check, 15_000, 500_000)
    assert run(check, 500_000, 520_000)


def test_silent_lidar_stops():
    check, lidar, _ = make()
    lidar.ok = False
    assert not check.check(0) and check.fault == _fault("lidar")
    lidar.ok = True
    assert check.check(5000)  # the first time there is nothing to settle
    lidar.ok = False
    assert not check.check(10_000)
    lidar.ok = True
    assert not check.check(15_000)


def test_lost_chip_stops():
    check, _, drive = make()
    drive.ok = False
    assert not check.check(0) and check.fault == _fault("chip") and not check.chips


def test_battery_is_measured_and_smoothed():
    adc = Adc()
    check, _, _ = make(adc)
    run(check, 0, 3_000_000)
    assert abs(check.battery_mv - 7398) <= 8 and not check.battery_low
    adc.microvolts = 1_600_000  # a dip of the motors' start
    assert run(check, 3_000_000, 3_300_000)
    adc.microvolts = 2_466_000
    assert run(check, 3_300_000, 6_000_000)


def test_empty_battery_stops_until_charged():
    adc = Adc()
    check, _, _ = make(adc)
    run(check, 0, 500_000)
    adc.microvolts = 2_150_000  # 6.45 V: low
    assert run(check, 500_000, 6_000_000) and check.battery_low
    adc.microvolts = 2_030_000  # 6.09 V: empty
    assert not run(check, 6_000_000, 12_000_000) and check.fault == _fault("battery")
    adc.microvolts = 2_150_000  # recovered at rest
    assert not run(check, 12_000_000, 20_000_000)
    adc.microvolts = 2_466_000
    assert run(check, 20_000_000, 30_000_000)


def test_a_chip_without_calibration_is_measured_by_its_nominal_scale():
    class Plain:
        asked = 0

        def read_uv(self):
            self.asked += 1
            raise OSError

        def read_u16(self):
            return 48972  # 2466 mV of 3300

    adc = Plain()
    check, _, _ = make(adc)
    assert run(check, 0, 3_000_000)
    assert abs(check.battery_mv - 7398) <= 8 and adc.asked == 1


def test_no_divider_connected_is_unknown():
    adc = Adc()
    adc.microvolts = 100_000
    check, _, _ = make(adc)
    assert run(check, 0, 5_000_000) and check.battery_mv == 0


def test_worst_loop_time_of_the_last_seconds():
    check, _, _ = make()
    run(check, 0, 500_000)
    check.check(512_000)
    assert check.worst_us == 17_000
    run(check, 515_000, 3_000_000)
    assert check.worst_us == 5000 and abs(check.uptime_ms - 2995) <= 1


def test_checking_allocates_nothing():
    check, _, _ = make(Adc(), Pin())
    check.check(0)
    micropython.heap_lock()
    try:
        now = 0
        while now < 12_000_000:
            check.check(now)
            now += 50_000
    finally:
        micropython.heap_unlock()
