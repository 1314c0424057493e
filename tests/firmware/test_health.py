"""health.py: battery, times of the loop."""

import micropython

from safety.health import Health


class Config:
    battery_divider1000 = 3000
    battery_low = 6600
    battery_empty = 6200


class Part:
    ok = True
    told_v256 = 0


class Adc:
    microvolts = 2_466_000  # 7.4 V over 3

    def read_uv(self):
        return self.microvolts


def make(adc=None, drive=None):
    return Health(drive or Part(), adc, Config)


def run(health, start, stop, step=5000):
    for now in range(start, stop, step):
        health.check(now)
    return not health.empty


def test_without_a_divider_the_battery_is_unknown():
    health = make()
    assert run(health, 0, 1_000_000) and health.battery_mv == 0 and not health.battery_low and not health.lost


def test_battery_is_measured_and_smoothed():
    adc = Adc()
    check = make(adc)
    run(check, 0, 3_000_000)
    assert abs(check.battery_mv - 7398) <= 8 and not check.battery_low
    adc.microvolts = 1_600_000  # a dip of the motors' start
    assert run(check, 3_000_000, 3_300_000)
    adc.microvolts = 2_466_000
    assert run(check, 3_300_000, 6_000_000)


def test_empty_battery_stops_until_charged():
    adc = Adc()
    check = make(adc)
    run(check, 0, 500_000)
    adc.microvolts = 2_150_000  # 6.45 V: low
    assert run(check, 500_000, 6_000_000) and check.battery_low
    adc.microvolts = 2_030_000  # 6.09 V: empty
    assert not run(check, 6_000_000, 12_000_000)
    adc.microvolts = 2_150_000  # recovered at rest
    assert not run(check, 12_000_000, 20_000_000)
    adc.microvolts = 2_466_000
    assert run(check, 20_000_000, 30_000_000)


def test_an_empty_battery_whose_wire_comes_off_is_no_better():
    adc = Adc()
    check = make(adc)
    adc.microvolts = 2_030_000
    assert not run(check, 0, 5_000_000)
    adc.microvolts = 0
    assert not run(check, 5_000_000, 15_000_000) and check.lost and check.battery_mv == 0
    adc.microvolts = 2_150_000
    assert not run(check, 15_000_000, 20_000_000) and not check.lost
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
    check = make(adc)
    assert run(check, 0, 3_000_000)
    assert abs(check.battery_mv - 7398) <= 8 and adc.asked == 1


def test_no_divider_connected_is_unknown():
    adc = Adc()
    adc.microvolts = 100_000
    check = make(adc)
    assert run(check, 0, 5_000_000) and check.battery_mv == 0


def test_worst_loop_time_of_the_last_seconds():
    check = make()
    run(check, 0, 500_000)
    assert check.check(512_000) == 17_000
    assert check.worst_us == 17_000
    run(check, 515_000, 3_000_000)
    assert check.worst_us == 5000 and abs(check.uptime_ms - 2995) <= 1


def test_checking_allocates_nothing():
    check = make(Adc())
    check.check(0)
    micropython.heap_lock()
    try:
        now = 0
        while now < 12_000_000:
            check.check(now)
            now += 50_000
    finally:
        micropython.heap_unlock()


def test_the_heap_is_counted_while_it_stands_only():
    drive = Part()
    health = make(None, drive)
    counted = health.heap_free = -1
    drive.told_v256 = 100
    run(health, 0, 21_000_000, 50_000)
    assert health.heap_free == counted
    drive.told_v256 = 0
    health.check(21_000_000)
    assert health.heap_free != counted
