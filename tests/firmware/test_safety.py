"""safety.py, stop_button.py, watchdog.py: what lets the robot drive and what stops it. The faults by their numbers of faults.py."""

import micropython

from link.reason_texts import FAULTS
from safety import faults
from safety.health import Health
from safety.safety import AUTO, STOPPED, Safety
from safety.stop_button import PRESSED, START, StopButton
from safety.watchdog import begin, prompt

MANUAL = 2


class Config:
    battery_divider1000 = 3000
    battery_low = 6600
    battery_empty = 6200


class Part:
    """A lidar or a drive."""

    def __init__(self):
        self.ok = True
        self.v256 = self.told_v256 = 0
        self.restarts = 1


class Pin:
    def __init__(self, level=1):
        self.level = level

    def value(self):
        return self.level


class Adc:
    microvolts = 2_466_000  # 7.4 V over 3

    def read_uv(self):
        return self.microvolts


class Bench:
    """A Safety with stand-ins for what it asks, and a clock."""

    def __init__(self, button=None, adc=None, autostart=True, hung=False, start_us=0, trust=None):
        self.lidar, self.drive = Part(), Part()
        self.now = start_us
        self.health = Health(self.drive, adc, Config)
        self.safety = Safety(self.lidar, self.drive, self.health, button and StopButton(button), trust, autostart, hung)

    def run(self, ms, step_us=5000):
        """True if it may move at the end of so many ms."""
        for _ in range(ms * 1000 // step_us):
            self.now = (self.now + step_us) & 0x3FFFFFFF
            may = self.safety.check(self.now)
        return may


def test_each_fault_has_its_text():
    numbers = [getattr(faults, name) for name in dir(faults) if name[0] != "_" and name != "LATCHED"]
    assert sorted(numbers) == list(range(len(FAULTS)))
    for number, word in ((faults.STOP_BUTTON, "button"), (faults.LIDAR, "silent"), (faults.CHIPS, "answer"), (faults.BATTERY, "empty"),
                         (faults.SETTLING, "well again"), (faults.SLOW, "too long"), (faults.MEMORY, "memory"), (faults.CHIPS_AGAIN, "three times"),
                         (faults.FAILED, "failed"), (faults.HUNG, "hung"), (faults.LIMITS, "limits")):  # fmt: skip
        assert word in FAULTS[number], FAULTS[number]


def test_it_waits_for_a_start_unless_told_otherwise():
    bench = Bench(autostart=False)
    assert not bench.run(5000) and bench.safety.waiting and bench.safety.fault == 0
    assert bench.safety.start(AUTO) and bench.run(10) and not bench.safety.waiting
    assert Bench(autostart=True).run(10)


def test_after_the_watchdog_it_stands_and_says_so_until_it_is_started():
    bench = Bench(autostart=False, hung=True)
    assert not bench.run(5000) and bench.safety.fault == faults.HUNG
    bench.safety.start(AUTO)
    bench.run(600)
    assert bench.run(10) and bench.safety.fault == 0


def test_what_stops_and_passes_by_itself():
    for part, fault in (("lidar", faults.LIDAR), ("drive", faults.CHIPS)):
        bench = Bench()
        assert bench.run(10)
        getattr(bench, part).ok = False
        assert not bench.run(5) and bench.safety.fault == fault
        getattr(bench, part).ok = True
        assert not bench.run(490) and bench.safety.fault == faults.SETTLING
        assert bench.run(20) and bench.safety.state == AUTO


def test_what_has_not_begun_needs_no_settling():
    bench = Bench()
    bench.lidar.ok = False
    assert not bench.run(5)
    bench.lidar.ok = True
    assert bench.run(5)


def test_a_stop_stays():
    bench = Bench()
    bench.run(10)
    bench.safety.stop()
    assert not bench.run(60_000) and bench.safety.fault == 0 and bench.safety.state == STOPPED


def test_two_turns_in_a_row_that_take_too_long_stop_a_robot_that_drives():
    bench = Bench()
    bench.run(100)
    bench.drive.told_v256 = 1000
    assert bench.run(101, 101_000)  # one may be
    assert bench.run(5)
    assert bench.run(101, 101_000) and not bench.run(101, 101_000) and bench.safety.fault == faults.SLOW
    standing = Bench()
    standing.run(100)
    assert standing.run(2000, 400_000)  # standing it harms nobody


def test_chips_lost_three_times_in_a_minute_stop_it_for_good():
    bench = Bench()
    bench.run(100)
    for _ in range(2):
        bench.drive.restarts += 1
        assert bench.run(29_000)
    bench.drive.restarts += 1
    assert not bench.run(5) and bench.safety.fault == faults.CHIPS_AGAIN and bench.safety.state == STOPPED
    assert not bench.run(100_000)
    bench.safety.start(AUTO)
    bench.run(1000)
    assert bench.run(5)


def test_chips_lost_now_and_then_do_not():
    bench = Bench()
    bench.run(100)
    for seconds in (31, 31, 31, 31, 300, 300, 300, 480, 480):  # after more than nine minutes a difference of ticks looks negative
        bench.drive.restarts += 1
        assert bench.run(seconds * 1000, 50_000)


def test_an_exception_stops_it_until_a_person_starts_it():
    for memory, fault in ((False, faults.FAILED), (True, faults.MEMORY)):
        bench = Bench()
        bench.run(10)
        bench.safety.failed(memory)
        assert not bench.run(20_000) and bench.safety.fault == fault and bench.safety.state == STOPPED
        bench.safety.start(MANUAL)
        bench.run(600)
        assert bench.run(5) and bench.safety.state == MANUAL


def test_a_heap_that_is_nearly_gone_stops_it_until_there_is_room_and_a_person_starts_it():
    bench = Bench()
    assert bench.run(100)
    bench.health.heap_free = 4095
    assert not bench.run(5) and bench.safety.fault == faults.MEMORY and bench.safety.state == STOPPED
    bench.safety.start(AUTO)
    assert not bench.run(1000) and bench.safety.fault == faults.MEMORY
    bench.health.heap_free = 4096
    assert not bench.run(1000) and bench.safety.state == STOPPED
    bench.safety.start(AUTO)
    bench.run(600)
    assert bench.run(5)


def test_a_low_battery_slows_and_an_empty_one_stops():
    adc = Adc()
    bench = Bench(adc=adc)
    assert bench.run(1000) and bench.safety.most == 90
    adc.microvolts = 2_150_000
    assert bench.run(6000) and bench.safety.most < 45
    adc.microvolts = 2_030_000
    assert not bench.run(6000) and bench.safety.fault == faults.BATTERY


class Trust:
    """A ScanTrust."""

    fault = 0
    most = 90
    alarm = False
    cleared = 0

    def clear(self):
        self.cleared += 1
        self.alarm = False


def test_a_scan_that_is_not_trusted_stops_and_slows_it():
    trust = Trust()
    bench = Bench(trust=trust)
    assert bench.run(10) and bench.safety.most == 90
    trust.most = 6
    assert bench.run(10) and bench.safety.most == 6
    trust.fault = faults.SCAN
    assert not bench.run(10) and bench.safety.fault == faults.SCAN
    trust.fault = 0
    assert bench.run(600)


def test_an_alarm_of_the_motion_check_stays_until_a_person_starts_it():
    trust = Trust()
    bench = Bench(trust=trust)
    bench.run(10)
    trust.fault, trust.alarm = faults.NOTHING_MOVES, True
    bench.run(10)
    trust.fault, trust.alarm = 0, False
    assert not bench.run(10_000) and bench.safety.fault == faults.NOTHING_MOVES
    bench.safety.start(AUTO)
    assert trust.cleared == 1
    bench.run(600)
    assert bench.run(5)


def test_a_press_stops_at_once_and_a_long_one_of_a_standing_robot_starts_it():
    pin = Pin()
    bench = Bench(button=pin)
    assert bench.run(1000)
    pin.level = 0
    assert not bench.run(5) and bench.safety.fault == faults.STOP_BUTTON and not bench.safety.start(AUTO)
    bench.run(3000)
    pin.level = 1
    assert not bench.run(3000) and bench.safety.state == STOPPED  # it was this press that stopped it
    pin.level = 0
    bench.run(900)
    pin.level = 1
    assert not bench.run(3000)  # too short
    pin.level = 0
    bench.run(1200)
    pin.level = 1
    bench.run(400)
    assert bench.safety.state == STOPPED
    bench.run(700)
    assert bench.run(5) and bench.safety.state == AUTO


def _presses(pattern, stands=True, closed=False):
    """What comes of [(ms, contact)], one after the other, after a second of rest: the answers of the button without repetitions."""
    pin = Pin()
    button = StopButton(pin, closed)
    said, now = [], 2**30 - 2_000_000
    for ms, contact in [(1000, False)] + pattern + [(1000, False)]:
        pin.level = int(contact == closed)
        for _ in range(ms // 2):
            now = (now + 2000) & 0x3FFFFFFF
            answer = button.look(now, stands)
            if not said or said[-1] != answer:
                said.append(answer)
    return said


def test_bouncing_contacts():
    assert START in _presses([(1200, True)])
    assert START in _presses([(4, True), (6, False), (1200, True), (4, False), (2, True)])  # as every contact bounces
    assert START not in _presses([(1200, True)], stands=False)
    assert START not in _presses([(4, True), (6, False), (1200, True)], stands=False)
    assert START not in _presses([(100, True), (100, False)] * 10)  # hammering on it
    assert START not in _presses([(300, True), (300, False), (1500, True)])
    assert START not in _presses([(5000, True)])  # caught, or leant on
    assert START not in _presses([(900, True)])


def test_a_bad_wire_starts_nothing():
    assert START not in _presses([(40, True), (2000, False), (1500, True)])
    assert START not in _presses([(4, True), (2, False), (10, True), (2000, False), (1500, True), (2000, False), (1500, True)])
    assert START in _presses([(60, True), (2000, False), (1500, True)])


def test_a_button_that_opens_never_starts_and_its_broken_wire_stops():
    said = _presses([(1200, True)], closed=True)
    assert PRESSED in said and START not in said


def test_a_button_held_while_the_power_comes_on_starts_nothing():
    pin = Pin(0)
    bench = Bench(button=pin, autostart=False)
    bench.run(2000)
    pin.level = 1
    bench.run(2000)
    assert bench.safety.state == STOPPED


def test_all_of_it_over_the_wraps_of_the_clock():
    for start in (2**29 - 1_000_000, 2**30 - 1_000_000):
        pin = Pin()
        bench = Bench(button=pin, start_us=start)
        assert bench.run(900)
        bench.lidar.ok = False
        assert not bench.run(50)
        bench.lidar.ok = True
        assert not bench.run(400) and bench.run(200)
        pin.level = 0
        assert not bench.run(100)
        pin.level = 1
        assert not bench.run(1000)


def test_checking_allocates_nothing():
    bench = Bench(button=Pin(), adc=Adc())
    bench.run(10)
    check = bench.safety.check
    micropython.heap_lock()
    try:
        now = bench.now
        while now < 12_000_000:
            check(now)
            now += 50_000
    finally:
        micropython.heap_unlock()


class Machine:
    """A board's watchdog and RTC."""

    def __init__(self):
        self.kept = b""
        self.fed = self.timeout = self.resets = 0

    def RTC(self):
        return self

    def memory(self, data=None):
        if data is None:
            return self.kept
        self.kept = bytes(data)

    def WDT(self, timeout):
        self.timeout = timeout
        return self

    def feed(self):
        self.fed += 1

    def reset(self):
        self.resets += 1


class Robot:
    """What the watchdog has to do with of the robot."""

    off_at = None

    def __init__(self, machine):
        self.note = bytearray(b"GS\0\0")
        self.machine = machine

    def off(self):
        self.off_at = self.machine.resets


def test_the_watchdog_wants_to_be_fed_every_second():
    machine = Machine()
    robot = Robot(machine)
    begin(robot, machine)
    robot.feed()
    robot.note[2] = 3
    robot.keep(robot.note)
    assert (machine.fed, machine.timeout, machine.kept) == (1, 1000, b"GS\3\0")


def test_a_build_without_the_clocks_memory_is_watched_all_the_same():
    class Without:
        def __init__(self, machine):
            self.WDT = machine.WDT

    machine = Machine()
    robot = Robot(machine)
    begin(robot, Without(machine))
    robot.feed()
    assert machine.fed == 1


def test_the_way_to_the_prompt_is_off_then_a_reset():
    machine = Machine()
    robot = Robot(machine)
    prompt(robot, machine)
    assert robot.off_at == 0 and machine.resets == 1 and machine.kept[3] == 1
