"""drive.py and outputs.py, seen at the registers of the chips."""

from array import array
from math import exp
from time import ticks_add

import micropython
from fake_chips import PRE_SCALE, FakeBus, FakePin

from actuation.drive import Drive
from actuation.outputs import Outputs
from core.axles import lay_out
from params.change import change
from params.config import Config
from pca9685 import PCA9685
from steering import Steering

SERVOS, LEFT, RIGHT = 0x40, 0x41, 0x42
PERIOD_US = 20000


class _Robot:
    """A drive with chips, and a clock that moves in servo periods."""

    def __init__(self, values=None, start_us=0):
        self.config = config = Config(values)
        self.bus = FakeBus()
        self.enable = FakePin()
        chips = (
            PCA9685(self.bus, config.servos_address, config.servos_frequency, config.servos_oscillator, max(config.servos_channels) + 1),
            PCA9685(self.bus, config.motors_left, config.motors_frequency, channels=max(config.motors_channels) + 2),
            PCA9685(self.bus, config.motors_right, config.motors_frequency, channels=max(config.motors_channels) + 2),
        )
        self.drive = Drive(lay_out(config.axles_spacings, config.axles_track, config.axles_first), *chips, self.enable, config)
        self.now = start_us
        self.wheels = 2 * config.axles

    def step(self, periods=1):
        for _ in range(periods):
            assert self.drive.update(self.now)
            self.now = ticks_add(self.now, PERIOD_US)

    def ready(self):
        """Past the first swing, wheels straight, standing."""
        for _ in range(100):
            self.step()
            if not self.drive.turning:
                return self
        assert False, "never ready"

    def counts(self):
        return self.bus.chips[SERVOS].counts(16)

    def angles(self):
        """Wheel angles in degrees, from the pulses of default servos."""
        counts = self.bus.chips[SERVOS].counts(self.wheels)
        return [(count * 4.88 - 1500) * 0.09 for count in counts]

    def speeds(self):
        """Signed duty of each motor, 0 .. 4096."""
        speeds = []
        for i in range(self.config.axles):
            for address in (LEFT, RIGHT):
                forward, backward = (self.bus.chips[address].count(2 * i + k) for k in (0, 1))
                assert not (forward and backward)
                speeds.append(forward - backward)
        return speeds

    def stands(self):
        return not any(self.speeds())


def test_everything_is_off_until_the_registers_are_valid():
    robot = _Robot()
    assert robot.enable.level == 1 and not robot.drive.ok
    assert all(not chip.running() for chip in robot.bus.chips.values())
    level_at_burst = []
    chip = robot.bus.chips[SERVOS]
    write = chip.write

    def watched(data):
        level_at_burst.append(robot.enable.level)
        write(data)

    chip.write = watched
    robot.step()
    assert level_at_burst and all(level_at_burst)
    assert robot.enable.level == 0 and robot.drive.ok
    assert robot.counts() == [307] * 10 + [0] * 6 and robot.stands()


def test_it_waits_until_the_wheels_must_be_straight_after_power_up():
    robot = _Robot()
    robot.drive.command(0, 0, 108)
    periods = 0
    robot.step()
    while robot.drive.turning:
        assert robot.stands()
        robot.step()
        periods += 1
    assert 15 <= periods <= 20  # 90 degrees at 300 deg/s, and the latency


def test_pulses_of_the_wheels():
    robot = _Robot().ready()
    robot.drive.command(300, -200, 90)
    robot.step(30)
    exact = Steering(lay_out(robot.config.axles_spacings, robot.config.axles_track))
    exact.solve(300, -200)
    for angle, wanted in zip(robot.angles(), exact.angles):
        assert abs(angle - wanted / 10) < 0.23, (angle, wanted)


def test_trims_directions_and_pulse_ranges_of_single_servos():
    servos = {
        "trims": [9] + [0] * 9,
        "directions": [1, -1] + [1] * 8,
        "pulse_low": [500, 500, 600] + [500] * 7,
        "pulse_high": [2500, 2500, 2300] + [2500] * 7,
    }
    robot = _Robot({"servos": servos}).ready()
    assert abs(robot.angles()[0] - 9) < 0.25
    robot.drive.command(450, 450, 90)
    robot.step(40)
    angles = robot.angles()
    assert abs(angles[0] - 54) < 0.25 and abs(angles[1] + 45) < 0.25
    assert abs(robot.counts()[2] * 4.88 - 1875) < 2.5  # 1450 us and half of 850 us


def test_a_tuned_trim_counts_at_once():
    robot = _Robot().ready()
    change(robot.config, "servos.trims.4", 10)
    robot.step()
    assert abs(robot.angles()[4] - 10) < 0.25 and abs(robot.angles()[3]) < 0.25


def test_channels_as_wired():
    robot = _Robot({"servos": {"channels": [15, 14, 13, 12, 11, 10, 9, 8, 7, 6]}, "motors": {"channels": [14, 12, 10, 8, 6]}}).ready()
    assert robot.counts() == [0] * 6 + [307] * 10
    robot.drive.command(0, 0, 108)
    robot.step(30)
    duty = 4096 * 18 // 90
    assert robot.bus.chips[LEFT].counts(16) == [0] * 6 + [duty, 0] * 5


def test_speed_of_the_fastest_wheel_and_shares_of_the_others():
    robot = _Robot().ready()
    robot.drive.command(300, -300, 126)
    robot.step(80)
    exact = Steering(lay_out(robot.config.axles_spacings, robot.config.axles_track))
    exact.solve(300, -300)
    for speed, share in zip(robot.speeds(), exact.shares):
        assert abs(speed - 4096 * 0.4 * share / 16384) <= 1.5
    robot.drive.command(300, -300, 54)
    robot.step(80)
    for speed, share in zip(robot.speeds(), exact.shares):
        assert abs(speed + 4096 * 0.4 * share / 16384) <= 1.5


def test_full_speed_is_always_on():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 180)
    robot.step(100)
    assert robot.speeds() == [4096] * 10
    robot.drive.command(0, 0, 0)
    robot.step(100)
    assert robot.speeds() == [-4096] * 10


def test_dead_band_and_motor_directions():
    robot = _Robot({"motors": {"dead_band": 25, "directions": [1, -1] * 5}}).ready()
    assert robot.stands()
    robot.drive.command(0, 0, 135)
    robot.step(60)
    assert robot.speeds() == [1024 + 1536, -1024 - 1536] * 5


def test_speed_ramps_up_and_stops_at_once():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 108)
    before = 0
    ramp = 4096 * 2000 * 0.02 / 1280
    steps = 0
    while before < 4096 * 18 // 90:
        robot.step()
        speed = robot.speeds()[0]
        assert 0 < speed - before <= ramp + 2
        before = speed
        steps += 1
    assert steps == 7
    robot.drive.command(0, 0, 90)
    robot.step()
    assert robot.stands()


def test_stop_does_not_wait_for_the_next_period():
    robot = _Robot().ready()
    robot.drive.command(200, -200, 108)
    robot.step(30)
    assert not robot.stands()
    servos = robot.counts()
    robot.drive.stop()
    assert robot.stands() and robot.counts() == servos
    robot.step(10)
    assert robot.stands()


def _lengths(robot):
    """[(address, bytes)] of what is sent from now on; the chips are told nothing."""
    sent = []
    robot.bus.writeto = lambda address, data: sent.append((address, len(data)))
    return sent


def test_stop_is_one_byte_for_each_of_the_motors_chips_and_then_nothing():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 180)
    robot.step(90)
    sent = _lengths(robot)
    robot.drive.stop()
    assert sent == [(LEFT, 2), (RIGHT, 2)]
    robot.drive.stop()
    robot.drive.command(0, 0, 90)
    robot.step(2)
    robot.drive.stop()
    assert len(sent) == 2


def test_a_command_to_stand_takes_as_little():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 108)
    robot.step(40)
    sent = _lengths(robot)
    robot.drive.command(0, 0, 90)
    robot.step(2)
    assert sent == [(LEFT, 2), (RIGHT, 2)]


def test_the_same_speed_is_driven_again_after_a_stop():
    robot = _Robot({"drive": {"acceleration": 20000}}).ready()
    robot.drive.command(0, 0, 108)
    robot.step(2)
    speeds = robot.speeds()
    robot.drive.stop()
    assert robot.stands()
    robot.drive.command(0, 0, 108)
    robot.step(2)
    assert robot.speeds() == speeds and not robot.stands()


def test_a_chip_that_could_not_be_stopped_does_not_start_as_it_was():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 108)
    robot.step(40)
    robot.bus.chips[LEFT].present = False
    robot.drive.stop()
    assert not robot.drive.ok and robot.enable.level == 1 and not any(robot.bus.chips[RIGHT].counts(10))
    robot.bus.chips[LEFT].present = True
    for _ in range(60):
        robot.step()
        assert not robot.drive.ok or robot.stands()
    assert robot.drive.ok and robot.enable.level == 0


def test_reversal_passes_through_off():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 108)
    robot.step(20)
    robot.drive.command(0, 0, 72)
    robot.step()
    assert robot.stands()
    robot.step()
    assert all(speed < 0 for speed in robot.speeds())


def test_small_changes_are_driven_round_one_turning_centre():
    robot = _Robot({"servos": {"swing": 60}}).ready()
    robot.drive.command(100, -100, 108)
    robot.step(30)
    exact = Steering(lay_out(robot.config.axles_spacings, robot.config.axles_track))
    before = robot.angles()
    for af, ar in ((350, -250), (300, 50), (-100, -100)):
        robot.drive.command(af, ar, 108)
        for _ in range(12):
            robot.step()
            aim = robot.drive.aim
            angles = robot.angles()
            assert not robot.drive.turning and not robot.stands()
            exact.solve(aim.af, aim.ar)
            for angle, wanted, last in zip(angles, exact.angles, before):
                assert abs(angle - wanted / 10) < 0.23
                assert abs(angle - last) <= 6.0 + 0.45
            before = angles
        assert (robot.drive.aim.af, robot.drive.aim.ar) == (af, ar)


def test_no_wheel_is_told_to_turn_faster_than_its_servo():
    for rate in (300, 100):
        robot = _Robot({"servos": {"swing": 90, "rate": rate}}).ready()
        exact = Steering(lay_out(robot.config.axles_spacings, robot.config.axles_track))
        step = rate * 10 // 50
        seed = 3
        driven = 0
        for k in range(150):
            if k % 6 == 0:
                seed = (seed * 1103515245 + 12345) & 0x7FFFFFFF
                robot.drive.command((seed >> 8) % 701 - 350, (seed >> 19) % 701 - 350, 126)
            before = list(robot.drive.aim.angles)
            told = robot.drive.aim.af, robot.drive.aim.ar
            robot.step()
            aim = robot.drive.aim
            if not robot.drive.turning:
                largest = max(abs(a - b) for a, b in zip(aim.angles, before))
                assert largest <= step
                # and the slowest wheel is not waited for without need
                goal = (seed >> 8) % 701 - 350, (seed >> 19) % 701 - 350
                if (aim.af, aim.ar) != goal:
                    assert largest >= step * 3 // 4, (told, goal, largest)
                driven += told != (aim.af, aim.ar)
            exact.solve(aim.af, aim.ar)
            assert list(exact.angles) == list(aim.angles) and list(exact.shares) == list(aim.shares)
            estimate = robot.drive.steering
            exact.solve(robot.drive.af, robot.drive.ar)
            assert list(exact.angles) == list(estimate.angles) and (exact.vy, exact.w) == (estimate.vy, estimate.w)
        assert driven > 60


def test_large_changes_stop_the_robot_first():
    robot = _Robot().ready()
    for af, ar in ((900, -900), (900, 900), (-900, -900), (0, 0), (650, -650), (-300, 300)):
        robot.drive.command(af, ar, 108)
        old = robot.angles()
        moved_at = None
        for period in range(200):
            robot.step()
            angles = robot.angles()
            if robot.drive.turning:
                assert robot.stands(), (af, ar)
            if moved_at is None and angles != old:
                moved_at = period
                assert abs(robot.drive.v256) <= 512
                change = max(abs(a - b) for a, b in zip(angles, old))
            if not robot.drive.turning and moved_at is not None:
                break
        waited = (period - moved_at) * 0.020
        assert change / 300 + 0.03 <= waited + 0.021 and waited < change / 300 + 0.12, (af, ar, change, waited)
        assert (robot.drive.aim.af, robot.drive.aim.ar) == (af, ar)
        robot.step(20)
        assert not robot.stands()


def test_a_fold_is_a_large_change_however_small_the_angles():
    robot = _Robot({"servos": {"swing": 180}}).ready()
    robot.drive.command(640, -640, 108)
    robot.step(60)
    assert not robot.drive.turning and not robot.drive.aim.folded
    robot.drive.command(670, -670, 108)
    robot.step()
    assert robot.drive.turning and robot.stands()
    robot.step(120)
    assert robot.drive.aim.folded and not robot.drive.turning
    signs = [speed > 0 for speed in robot.speeds()]
    assert False in signs and True in signs


def test_a_way_past_a_fold_is_not_driven_though_neither_end_is_folded():
    robot = _Robot({"servos": {"swing": 180}}).ready()
    robot.drive.command(880, 880, 108)
    robot.step(80)
    assert robot.drive.aim.af == 880 and not robot.stands()
    robot.drive.command(800, 700, 108)
    stood = False
    for _ in range(100):
        robot.step()
        assert not robot.drive.aim.folded
        if robot.drive.turning:
            assert robot.stands()
            stood = True
    assert stood and robot.drive.aim.af == 800 and not robot.drive.turning and not robot.stands()


def test_a_change_of_mind_while_still_rolling_costs_no_swing():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 180)
    robot.step(60)
    robot.drive.command(900, 900, 108)
    robot.step()
    assert robot.drive.turning and robot.stands()
    robot.drive.command(0, 0, 180)
    robot.step()
    assert not robot.drive.turning and not robot.stands()


def test_a_new_goal_during_the_swing_is_swung_to():
    robot = _Robot().ready()
    robot.drive.command(900, 900, 108)
    robot.step(5)
    assert robot.drive.turning
    robot.drive.command(-900, 900, 108)
    robot.step(3)
    assert (robot.drive.aim.af, robot.drive.aim.ar) == (-900, 900) and robot.stands()
    robot.step(60)
    assert not robot.drive.turning and not robot.stands()


def test_estimate_follows_with_latency_and_time_constant():
    robot = _Robot({"servos": {"latency": 40, "swing": 100}, "motors": {"time_constant": 100}, "drive": {"acceleration": 20000}}).ready()
    drive = robot.drive
    drive.command(40, 0, 108)
    robot.step()
    assert drive.aim.af == 40 and drive.af == 0
    robot.step()
    assert drive.af == 0
    robot.step()
    assert drive.af == 40 and drive.steering.af == 40
    for period in range(3, 12):
        robot.step()
        assert abs(drive.v256 / 4608 - (1 - exp(-(period + 0.5) * 0.2))) < 0.02, (period, drive.v256)
    robot.step(60)
    assert abs(drive.v256 - 4608) <= 1
    robot.drive.stop()
    robot.step(100)
    assert abs(drive.v256) <= 1


def test_estimate_between_two_periods():
    robot = _Robot({"servos": {"latency": 30, "swing": 100}}).ready()
    robot.drive.command(60, 60, 90)
    seen = []
    for _ in range(4):
        robot.step()
        seen.append((robot.drive.aim.af, robot.drive.af))
    assert seen == [(60, 0), (60, 30), (60, 60), (60, 60)]


def test_live_parameters_count_at_once():
    robot = _Robot().ready()
    change(robot.config, "servos.swing", 90)
    change(robot.config, "servos.rate", 100)
    robot.drive.command(300, 300, 108)
    robot.step()
    assert robot.drive.aim.af == 20 and not robot.drive.turning


def test_at_angles_beyond_a_servos_limits_the_robot_stops_as_it_is_steered():
    robot = _Robot({"servos": {"high": [60] * 10}}).ready()
    assert robot.drive.command(300, -300, 108)
    robot.step(60)
    assert not robot.stands()
    angles = robot.angles()
    assert robot.drive.command(600, -600, 108) is False
    robot.step()
    assert robot.stands() and robot.angles() == angles
    assert robot.drive.command(300, -300, 108)
    robot.step(2)
    assert not robot.stands()
    assert robot.drive.command(901, 0, 108) is False


def test_limits_that_are_narrowed_count_with_the_next_command():
    robot = _Robot().ready()
    assert robot.drive.command(300, -300, 108)
    robot.step(60)
    for k in range(10):
        robot.config.servos_high[k] = 100
    robot.config.changes += 1
    robot.step()
    assert robot.drive.command(300, -300, 108) is False
    robot.step()
    assert robot.stands() and robot.drive.command(30, -30, 108)


def test_the_first_wheel_beyond_its_limits_is_told():
    robot = _Robot({"servos": {"high": [90, 90, 40] + [90] * 7, "low": [-90] * 7 + [-20, -90, -90]}}).ready()
    assert (robot.drive.beyond(100, -100), robot.drive.beyond(600, 600), robot.drive.beyond(-300, -300)) == (-1, 2, 7)
    assert robot.drive.command(0, 0, 108)


def test_speeds_beyond_the_scale_are_held_to_it():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 400)
    robot.step(100)
    assert robot.speeds() == [4096] * 10


def test_a_lost_chip_stops_the_robot_and_is_taken_back():
    for address in (SERVOS, LEFT, RIGHT):
        robot = _Robot().ready()
        drive = robot.drive
        drive.command(100, -100, 108)
        robot.step(40)
        robot.bus.chips[address].present = False
        periods = 0
        while drive.ok:
            robot.step()
            periods += 1
        assert periods <= 51
        assert robot.enable.level == 1
        assert "0x%02x does not answer" % address in drive.fault
        others = [robot.bus.chips[a] for a in (LEFT, RIGHT) if a != address]
        assert all(not any(chip.counts(10)) for chip in others)
        robot.step(120)
        assert not drive.ok and robot.enable.level == 1 and drive.v256 == 0
        robot.bus.chips[address].reset()
        robot.bus.chips[address].present = True
        for _ in range(52):
            robot.step()
            if drive.ok:
                break
        assert robot.enable.level == 0 and drive.turning and robot.stands()
        robot.step(60)
        assert not drive.turning and not robot.stands()


def test_a_chip_that_was_reset_is_noticed_within_a_second_and_the_wheels_swing_anew():
    for address in (SERVOS, LEFT, RIGHT):
        robot = _Robot().ready()
        robot.drive.command(100, -100, 108)
        robot.step(40)
        robot.bus.chips[address].reset()
        for _ in range(51):
            robot.step()
            if robot.drive.turning:
                break
        assert robot.bus.chips[address].running() and robot.stands() and robot.drive.ok
        assert "0x%02x was reset" % address in robot.drive.fault
        robot.step(60)
        assert not robot.drive.turning and not robot.stands()
        assert abs(robot.angles()[0] - robot.drive.aim.angles[0] / 10) < 0.3


def test_registers_are_sent_when_they_change_and_once_a_second():
    robot = _Robot().ready()
    robot.step(60)
    before = [chip.bursts for chip in robot.bus.chips.values()]
    robot.step(96)  # a second is 48 periods: a multiple of three, so that the chips take turns
    assert [chip.bursts - b for chip, b in zip(robot.bus.chips.values(), before)] == [2, 2, 2]


def test_bursts_end_with_the_last_output_in_use():
    lengths = []
    robot = _Robot()
    for chip in robot.bus.chips.values():
        chip.write = lambda data: lengths.append(len(data))
    robot.step()
    assert [length for length in lengths if length > 5] == [41, 41, 41]


def test_no_chip_is_set_right_where_all_three_are_written_though_each_is_within_a_second():
    robot = _Robot({"servos": {"swing": 90}}).ready()
    bus = robot.bus
    looked = []
    read = bus.readfrom_mem_into

    def watched(address, register, buffer):
        if register == PRE_SCALE:
            looked.append(address)
        read(address, register, buffer)

    bus.readfrom_mem_into = watched
    for k in range(200):
        if k % 20 == 0:
            robot.drive.command(300 if k % 40 else -300, k, 108 + k % 11)
        before = sum(chip.bursts for chip in bus.chips.values())
        looks = len(looked)
        robot.step()
        if len(looked) > looks:
            assert sum(chip.bursts for chip in bus.chips.values()) - before < 3
        if k % 70 == 69:
            assert set(looked) == {SERVOS, LEFT, RIGHT}
            looked.clear()


def _read_of(bus):
    """Addresses, in the order in which chips are read from now on."""
    looked = []
    read = bus.readfrom_mem_into

    def watched(address, register, buffer):
        looked.append(address)
        read(address, register, buffer)

    bus.readfrom_mem_into = watched
    return looked


def test_a_driving_robot_looks_at_each_chip_every_third_period_whatever_it_writes():
    for frequency in (40, 50, 100):
        robot = _Robot({"servos": {"swing": 90, "frequency": frequency}})
        for _ in range(200):
            robot.drive.update(robot.now)
            robot.now = ticks_add(robot.now, 1000000 // frequency)
        looked = _read_of(robot.bus)
        before = [-1, -1, -1]
        for k in range(250):
            if k % 20 == 0:  # in the latter half all three chips are written in every period
                robot.drive.command(300 if k % 40 else -300, k, 108 + k % 11) if k > 120 else robot.drive.command(0, 0, 108)
            del looked[:]
            robot.drive.update(robot.now)
            robot.now = ticks_add(robot.now, 1000000 // frequency)
            assert len(set(looked)) == 1
            chip = looked[0] - SERVOS
            assert before[chip] < 0 or k - before[chip] <= 3
            before[chip] = k
        assert min(before) > 240


def test_a_garbled_register_is_put_right():
    robot = _Robot().ready()
    robot.bus.chips[SERVOS].registers[6 + 4 * 3 + 2] ^= 0x40
    assert robot.counts()[3] != 307
    robot.step(51)
    assert robot.counts()[3] == 307


def test_update_is_idle_between_the_periods():
    robot = _Robot().ready()
    drive = robot.drive
    assert drive.update(robot.now)
    assert not drive.update(ticks_add(robot.now, 1)) and not drive.update(ticks_add(robot.now, PERIOD_US - 1))
    assert drive.update(ticks_add(robot.now, PERIOD_US))


def test_estimate_catches_up_after_a_pause():
    quick, slow = _Robot().ready(), _Robot().ready()
    for robot in (quick, slow):
        robot.drive.command(0, 0, 108)
        robot.step(20)
        robot.drive.stop()
    quick.step(5)
    slow.now = ticks_add(slow.now, 4 * PERIOD_US)
    slow.step()
    assert quick.drive.v256 == slow.drive.v256


def test_the_first_period_after_a_long_pause_is_a_usual_one():
    robot = _Robot().ready()
    robot.now = ticks_add(robot.now, 3000000)
    robot.step()
    assert not robot.drive.update(ticks_add(robot.now, -1)) and robot.drive.update(robot.now)


def test_the_clock_may_wrap():
    robot = _Robot(start_us=2**30 - 30 * PERIOD_US - 7).ready()
    robot.drive.command(0, 0, 108)
    robot.step(60)
    assert robot.speeds()[0] == 4096 * 18 // 90


def test_one_wheel_can_be_pointed_while_the_robot_stands():
    robot = _Robot().ready()
    assert robot.drive.point(3, 450)
    robot.step()
    assert abs(robot.angles()[3] - 45) < 0.25 and abs(robot.angles()[2]) < 0.25
    assert robot.drive.point(4, -100)
    robot.step()
    assert abs(robot.angles()[3] - 45) < 0.25 and abs(robot.angles()[4] + 10) < 0.25
    assert not robot.drive.point(10, 0) and not robot.drive.point(0, 901)
    robot.drive.command(0, 0, 90)
    robot.step()
    assert abs(robot.angles()[3] - 45) < 0.25
    robot.drive.command(0, 0, 108)
    robot.step()
    assert abs(robot.angles()[3]) < 0.25 and robot.drive.turning and robot.stands()
    robot.step(40)
    assert not robot.stands()
    assert not robot.drive.point(3, 450)


def test_off_lets_everything_go():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 108)
    robot.step(20)
    robot.drive.off()
    assert robot.enable.level == 1
    assert not any(chip.running() for chip in robot.bus.chips.values())


def test_other_numbers_of_axles_drive():
    for spacings in ([300], [200, 200], [80] * 7):
        robot = _Robot({"axles": {"spacings": spacings}}).ready()
        robot.drive.command(150, -150, 108)
        robot.step(40)
        assert len(robot.speeds()) == 2 * robot.config.axles and all(speed > 0 for speed in robot.speeds())


def test_no_output_enable_pin():
    config = Config({"pins": {"output_enable": None}})
    bus = FakeBus()
    chips = PCA9685(bus, SERVOS), PCA9685(bus, LEFT, 1000), PCA9685(bus, RIGHT, 1000)
    drive = Drive(lay_out(config.axles_spacings, config.axles_track), *chips, None, config)
    drive.update(0)
    assert drive.ok and bus.chips[SERVOS].count(0) == 307
    drive.off()  # without the pin, each chip by itself
    assert not drive.ok and not any(chip.running() for chip in bus.chips.values())


def test_nothing_is_allocated_while_driving():
    robot = _Robot().ready()
    drive = robot.drive
    micropython.heap_lock()
    try:
        now = robot.now
        k = 0
        while k < 400:
            if k % 8 == 0:
                drive.command((k * 37) % 1801 - 900, (k * 53) % 1801 - 900, 108 if k % 64 else 72)
            if k % 100 == 99:
                drive.stop()
            drive.update(now)
            now = ticks_add(now, PERIOD_US)
            k += 1
    finally:
        micropython.heap_unlock()
    assert drive.ok


def test_an_update_is_due_once_a_period():
    robot = _Robot()
    assert robot.drive.due(0)
    robot.step()
    assert not robot.drive.due(PERIOD_US - 1) and robot.drive.due(PERIOD_US)


def test_less_than_full_speed_backward_is_full_speed_backward():
    robot = _Robot().ready()
    robot.drive.command(0, 0, -5)
    robot.step(200)
    assert robot.speeds() == [-4096] * 10


def test_a_stop_and_the_end_do_without_a_chip_that_is_gone():
    robot = _Robot().ready()
    robot.drive.command(0, 0, 120)
    robot.step(30)
    robot.bus.chips[LEFT].present = False
    robot.step(60)
    robot.drive.stop()
    robot.drive.off()
    assert robot.enable.level == 1 and not any(robot.bus.chips[RIGHT].counts(10))


def test_a_wheel_in_the_turning_centre_is_not_driven():
    robot = _Robot()
    chips = [PCA9685(robot.bus, address) for address in (SERVOS, LEFT, RIGHT)]
    outputs = Outputs(chips[0], chips[1], chips[2], None, robot.config)
    assert outputs.write(array("h", [0] * 10), array("h", [16384] + [0] * 9), 5000)
    assert [speed != 0 for speed in robot.speeds()] == [True] + [False] * 9
    robot.bus.chips[LEFT].present = False
    outputs.motors_off()
    assert not outputs.ok
    outputs.motors_off()  # nothing is left to be switched off


def test_where_a_tenth_of_a_degree_turns_a_wheel_far_the_robot_swings_standing():
    """Near the spin the turning centre lies among the wheels: no fraction of the way is small enough for a slow servo."""
    robot = _Robot({"servos": {"rate": 20, "swing": 180}})
    robot.step(600)
    robot.drive.command(-900, -870, 90)
    robot.step(600)
    assert not robot.drive.turning
    robot.drive.command(-899, -870, 108)
    robot.step()
    assert robot.drive.turning and robot.stands() and robot.drive.aim.af == -899


def test_off_goes_on_to_the_chips_where_the_pin_refuses():
    robot = _Robot().ready()

    def refuse(level):
        raise OSError

    robot.enable.value = refuse
    robot.bus.chips[LEFT].write = refuse
    robot.drive.off()
    assert not robot.bus.chips[RIGHT].running() and not robot.drive.ok
