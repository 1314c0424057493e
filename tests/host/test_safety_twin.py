"""What stops the robot and what starts it, through the whole firmware in the twin. docs/safety.md has all faults; here are the promises of firmware/lib/safety."""

import numpy as np
import pytest

from host.link import messages
from host.twin import Observer, run
from link import frames as whole_frames
from link import protocol
from safety import faults

INF = float("inf")
COURSE = dict(course="Z", width=550, seed=1, chip=INF, record=False)


class Bench(Observer):
    """Plays a person: at [(s, what)] presses or lets go of the button, takes off its wire, or sends a command. Notes when the motors were on."""

    def __init__(self, *plan):
        self._plan = sorted(plan, key=lambda step: step[0])
        self._send = b""
        self.on = []  # times, s
        self.resets = []
        self.said = b""

    def step(self, simulation):
        electronics = simulation.electronics
        now = simulation.now / 1e6
        while self._plan and self._plan[0][0] <= now:
            what = self._plan.pop(0)[1]
            if isinstance(what, bytes):
                self._send += what
            else:
                setattr(electronics, *what)
        if electronics.enabled and any(abs(chip.duty(k)) > 0 for address, chip in electronics.chips.items() if address != 0x40 for k in range(10)):
            self.on.append(now)

    def commands(self):
        data, self._send = self._send, b""
        return data

    def reset(self, time, cause):
        self.resets.append(cause)

    def serial(self, data):
        self.said += data

    def drove(self, start, end):
        return any(start < time < end for time in self.on)

    def logs(self):
        return [bytes(payload[1:]).decode() for kind, _, payload in whole_frames.decode(self.said) if kind == protocol.LOG]

    def faults(self):
        return {payload[16] for kind, _, payload in whole_frames.decode(self.said) if kind == protocol.HEALTH}


def press(start, end):
    return (start, ("stop_pressed", True)), (end, ("stop_pressed", False))


def drive(*plan, autostart=False, limit_s=8, **more):
    bench = Bench(*plan)
    changes = {"drive.autostart": autostart, **more.pop("changes", {})}
    run(**COURSE, watch=bench, changes=changes, limit_s=limit_s, **more)
    return bench


@pytest.mark.parametrize(
    "fault, within_ms",
    [
        ("hang-avoid", 1500), ("hang-link", 1500), ("hang-hard", 1500), ("exception-avoid", 250), ("exception-lidar", 250), ("exception-health", 250),
        ("exception-drive", 250), ("exception-stop", 250), ("memory-error-avoid", 250), ("slow", 1000), ("slow-150", 500), ("brown-out", 250),
        ("reset", 250), ("button-bounce", 100), ("button-short", 100), ("button-held", 100), ("button-reset", 100), ("button-power", 100), ("button-wire", 100), ("i2c-dead", 250),
        ("chip-gone", 250), ("chip-resets", 3300), ("oe-open", 1000), ("oe-open-json", 1000),
    ],
)  # fmt: skip
def test_it_stands_in_time_and_stays(fault, within_ms):
    outcome = run(**COURSE, fault=fault).fault
    assert outcome.still_ms is not None and outcome.still_ms <= within_ms
    assert outcome.driven_after_s * 1000 <= within_ms and outcome.touched_after == 0


class Resets(Bench):
    """Takes the registers of a chip away at times (s), as soon as motors turn then; how long they went on after each, ms."""

    def __init__(self, address, *times):
        super().__init__()
        self._address, self._times = address, list(times)
        self._since = None
        self.took = []

    def step(self, simulation):
        electronics = simulation.electronics
        if self._since is not None and not electronics.motors_on:
            self.took.append((electronics.switched[-1][0] - self._since) / 1000)
            self._since = None
        elif self._since is None and self._times and simulation.now >= self._times[0] * 1e6 and electronics.motors_on:
            del self._times[0]
            self._since = simulation.now
            electronics.brown_out(simulation.now, self._address)


@pytest.mark.parametrize("address, times", [(0x40, (5.7897,)), (0x40, (4.8077, 7.23)), (0x41, (4.27, 7.1)), (0x42, (4.61, 6.829))])
def test_a_chip_that_loses_its_registers_is_noticed_in_100_ms(address, times):
    bench = Resets(address, *times)
    run("random", gap=340, seed=5, watch=bench, chip=1.0, record=False, limit_s=times[-1] + 2)
    assert len(bench.took) == len(times) and max(bench.took) <= 100, bench.took


@pytest.mark.parametrize("fault, within_ms", [("i2c-stuck", 250)])
def test_it_stops_and_goes_on(fault, within_ms):
    result = run(**COURSE, fault=fault)
    assert result.fault.still_ms <= within_ms and result.fault.driven_after_s > 5 and not result.contacts


@pytest.mark.parametrize("fault", ["exception-link", "exception-telemetry", "memory-error"])
def test_it_drives_on(fault):
    outcome = run(**COURSE, fault=fault)
    assert not outcome.contacts and outcome.fault.driven_after_s > 3


@pytest.mark.parametrize("clock_us", [2**29 - 1_000_000, 2**29 - 8_000_000, 2**30 - 1_000_000, 2**30 - 8_000_000])
def test_it_drives_through_the_wraps_of_the_clock(clock_us):
    """The start alone takes 3 s where computing takes time: a second before the wrap lies in it, eight seconds lie in the drive."""
    bench = Bench()
    run("Z", 550, watch=bench, chip=1.0, record=False, clock_us=clock_us, limit_s=10)
    assert bench.drove(4, 7) and bench.drove(8.5, 10)


def test_after_power_up_it_waits_for_the_page():
    bench = drive((3, whole_frames.frame(protocol.DRIVE, messages.drive(1, "auto"))))
    assert not bench.drove(0, 3) and bench.drove(3, 8)


def test_after_power_up_it_waits_for_a_long_press():
    bench = drive(*press(3, 4.2))
    assert not bench.drove(0, 4.6) and bench.drove(4.6, 8)


def test_a_short_press_or_a_button_held_from_the_start_on_starts_nothing():
    assert not drive(*press(3, 3.5)).on
    assert not drive(*press(0, 2)).on


def test_a_stop_button_held_at_the_start_gives_the_prompt():
    bench = Bench(*press(0, 2))
    result = run(**COURSE, watch=bench, changes={"drive.autostart": True}, limit_s=4)
    assert "came to its end" in result.reason and not bench.on and not bench.resets and b"the prompt" in bench.said


def test_what_was_stopped_drives_again_after_a_start_also_without_power_in_between():
    """With autostart: stopped, power off and on, it waits and says why; started, power off and on, it drives off."""
    start = whole_frames.frame(protocol.DRIVE, messages.drive(1, "auto"))
    bench = drive((9, start), autostart=True, fault="button-power@3", limit_s=12)
    assert bench.drove(2, 3) and not bench.drove(3.1, 9) and bench.drove(9, 12)
    assert any("told to stop before" in line for line in bench.logs())


def test_autostart_drives_off_but_not_after_a_reset():
    assert drive(autostart=True, limit_s=3).on
    bench = drive(autostart=True, fault="hang@3")
    assert bench.resets == [3] and not bench.drove(4.1, 8)
    assert any("watchdog" in line and "planner" in line for line in bench.logs())


def test_a_button_that_opens_stops_with_its_wire_off_and_never_starts():
    closed = {"pins.stop_closed": True}
    bench = drive((4, ("stop_wired", False)), (6, ("stop_wired", True)), autostart=True, changes=closed)
    assert bench.drove(2, 4) and not bench.drove(4.05, 8)
    assert not drive(*press(3, 4.2), changes=closed).on


def test_an_exception_is_told():
    bench = drive(autostart=True, fault="exception-avoid@3", limit_s=5)
    assert 9 in bench.faults() and any(line.startswith("planner:") for line in bench.logs())


def _hand(start, end, v, counter=10, af=0):
    """Commands by hand, ten a second."""
    return [(start + k / 10, whole_frames.frame(protocol.DRIVE, messages.drive(counter + k, "manual", af, 0, v))) for k in range(round((end - start) * 10))]


class Touches(Bench):
    def step(self, simulation):
        super().step(simulation)
        self.touches = len(simulation.contact.touches)
        self.y = simulation.body.y


@pytest.mark.parametrize("v", [180, 130])
def test_a_hand_does_not_drive_it_into_a_wall_and_can_back_out(v):
    bench = Touches(*_hand(3, 12, v))
    run(**COURSE, watch=bench, changes={"drive.autostart": False}, limit_s=13)
    assert bench.drove(3, 5) and not bench.drove(11.5, 12) and bench.touches == 0
    there = bench.y
    bench = Touches(*_hand(3, 12, v), *_hand(12, 13, 70, 200))
    run(**COURSE, watch=bench, changes={"drive.autostart": False}, limit_s=14)
    assert bench.touches == 0 and bench.drove(12.2, 13.3) and bench.y < there - 50


def test_a_broken_robot_json_is_refused_and_the_last_good_one_offered():
    bench = drive(autostart=True, fault="oe-open-json@3", limit_s=5)
    assert b"cannot start: robot.json is not JSON" in bench.said and b"robot.json.good" in bench.said


def test_nothing_fails_unseen_where_computing_takes_time():
    """What is caught in the loop would else hide what is wrong with it."""
    bench = Bench()
    run("Z", 550, watch=bench, chip=1.0, record=False, limit_s=5)
    kinds = {kind for kind, _, _ in whole_frames.decode(bench.said)}
    assert bench.logs() == [] and {protocol.HEALTH, protocol.WHEELS, protocol.POINTS, protocol.DECISION} <= kinds


class Angles(Bench):
    """Notes the angles of the wheels, degrees, while the motors are on."""

    def __init__(self):
        super().__init__()
        self.most = np.zeros(10)

    def step(self, simulation):
        super().step(simulation)
        if simulation.electronics.motors_on:
            self.most = np.maximum(self.most, np.degrees(np.abs(simulation.body.angles)))
        self.away = np.hypot(simulation.body.x - simulation.course.start[0], simulation.body.y - simulation.course.start[1])


def test_what_the_wheels_limits_forbid_is_not_wanted():
    """One wheel of the first axle turns no farther than 35 degrees: the robot drives on with what it can do, and no wheel is told more."""
    limits = {"servos.high": [35] + [90] * 9, "servos.low": [-35] + [-90] * 9}
    bench = Angles()
    run("Z", 650, seed=1, watch=bench, changes=limits, chip=1.0, record=False, limit_s=14)
    assert bench.drove(8, 14) and bench.away > 800 and bench.most[0] < 37 < bench.most[1]
    assert faults.LIMITS not in bench.faults() and not bench.resets


def test_where_no_turn_is_left_a_wheel_is_named():
    bench = Angles()
    run("Z", 650, seed=1, watch=bench, changes={"servos.high": [90] + [1] * 9, "servos.low": [-90] + [-1] * 9}, chip=1.0, record=False, limit_s=11)
    assert not bench.drove(9, 11) and faults.LIMITS in bench.faults() and not bench.resets
    assert any("axle 1 right may turn -1 to 1 degrees only" in line for line in bench.logs())
