"""arm/: the arm's registers beside those of the wheels, its movements, what freezes it, and which trajectories it takes."""

import json
import os
import struct
from time import ticks_add, ticks_diff

import micropython
from fake_chips import FakeBus, FakePin

from actuation.drive import Drive
from arm import armed, build, requests
from core.axles import lay_out
from core.crc16 import crc16
from link import protocol
from params.config import Config
from pca9685 import PCA9685

OFF, WAKES, HOLDS, MOVES, PLAYS = range(5)
HELD, FAULT, LOST, WHEELS, CHIPS = range(1, 6)
PERIOD_US = 20000
REST = [9000, 0, -3000]
ARM = {
    "name": "three",
    "joints": [{"low_deg": -28, "high_deg": 206, "speed_deg_s": 170}, {"low_deg": -130, "high_deg": 130, "speed_deg_s": 170}],
    "extra": [{"name": "gripper", "low_deg": -40, "high_deg": 60, "speed_deg_s": 90}],
    "servos": {"channels": [12, 10, 13], "zeros_deg": [90, 0, 0], "directions": [1, -1, 1], "range_deg": 270, "rest_deg": [90, 0, -30]},
}
# First start of the ticks, near their wrap: a movement goes on over it
BEGIN = (1 << 30) - 3_000_000


class _Part:
    state = fault = v256 = told_v256 = 0


class _Link:
    """What the arm knows of the link: safety, state, log."""

    state = 0

    def __init__(self):
        self.safety = _Part()
        self.logs = []
        self.stops = self.length = 0

    def stop(self):
        self.stops += 1

    def again(self, data, now_us, robot):
        return self.length

    def log(self, level, text):
        self.logs.append(text)


class _Robot:
    """A drive with chips and an arm, its commands, and a clock that moves in servo periods."""

    def __init__(self, values=None, arm=ARM, own=None, bus=None):
        self.config = config = Config(values)
        self.bus = bus or FakeBus()
        self.enable = FakePin()
        self.own = own
        self.now = BEGIN
        armed.ticks_us = requests.ticks_us = build.ticks_us = lambda: self.now
        self.chips = (
            PCA9685(self.bus, 0x40, config.servos_frequency, config.servos_oscillator, max(config.servos_channels) + 1),
            PCA9685(self.bus, 0x41, config.motors_frequency, channels=max(config.motors_channels) + 2),
            PCA9685(self.bus, 0x42, config.motors_frequency, channels=max(config.motors_channels) + 2),
        )
        self.drive = Drive(lay_out(config.axles_spacings, config.axles_track, config.axles_first), *self.chips, self.enable, config)
        self.link = _Link()
        if arm is not None:
            with open("arm.json", "w") as file:
                file.write(json.dumps(arm))
            self.arm = build.add(config, self.drive, self.link, self.chips, self.enable, own)
        for name in ("reach.bin", "reach.new"):
            try:
                os.remove(name)
            except OSError:
                pass

    def step(self, periods=1, alive=True):
        for _ in range(periods):
            if alive and self.link.safety is not None:
                self.arm.heard_us = self.now
            self.drive.update(self.now)
            self.now = ticks_add(self.now, PERIOD_US)

    def ready(self):
        """Past the first swing of the wheels, and the arm awake at its rest pose."""
        self.step(60)
        assert not self.drive.turning
        self.say(protocol.ARM, 2)
        self.step(50)
        assert self.arm.state == HOLDS and list(self.arm.angles) == REST
        return self

    def say(self, kind, *data):
        """A command; the text of its reply."""
        payload = struct.pack("<I", 7) + b"".join([bytes((one,)) if type(one) is int else one for one in data])
        return requests.carry_out(self.link, kind, memoryview(payload), self, self.drive.told_v256 != 0)

    def refused(self, kind, *data):
        try:
            self.say(kind, *data)
        except ValueError as error:
            return str(error)
        assert False, "not refused"

    def upload(self, data, piece=50):
        for at in range(0, len(data), piece):
            text = self.say(protocol.REACH, struct.pack("<H", at), data[at : at + piece])
        return text

    def counts(self):
        """Of the arm's channels, joint by joint."""
        return [self.bus.chips[0x40].count(k) for k in ARM["servos"]["channels"]]

    def shown(self):
        """Angles in degrees, from the pulses: 2000 us over 270 degrees, 1500 us at the zero."""
        servos = ARM["servos"]
        return [zero + way * (count * 4.88 - 1500) * 0.135 for count, zero, way in zip(self.counts(), servos["zeros_deg"], servos["directions"])]

    def link_lost(self, periods):
        self.step(periods, alive=False)


def _trajectory(robot, knots, ident=None, joints=3):
    data = b"GR\x01" + struct.pack("<BHH", joints, robot.arm.ident if ident is None else ident, len(knots))
    for knot in knots:
        data += struct.pack("<H%dh" % (2 * joints), *knot)
    return data + struct.pack("<H", crc16(data, 0, len(data)))


def _there_and_back(robot):
    """Half a second up, half a second back, all three joints."""
    return _trajectory(robot, [
        (0, 9000, 0, 0, 0, -3000, 0), (500, 10000, 300, 2000, 0, 0, 0), (500, 11000, 0, 1000, -300, -1000, 0), (1000, 9000, 0, 0, 0, -3000, 0),
    ])  # fmt: skip


def test_no_pulses_until_a_person_asks_for_them():
    robot = _Robot()
    robot.step(100)
    assert robot.arm.state == OFF and robot.counts() == [0, 0, 0]
    assert "home first" in robot.refused(protocol.ARM, 3) and "home first" in robot.refused(protocol.ARM, 4, 0, b"\x00\x00")
    assert "rest pose" in robot.say(protocol.ARM, 2)
    robot.step(1)
    assert [count > 0 for count in robot.counts()] == [True, False, False]  # one after the other: together they would pull the supply down
    assert "a moment" in robot.refused(protocol.ARM, 4, 0, b"\x00\x00")
    robot.step(50)
    assert max([abs(a - b / 100) for a, b in zip(robot.shown(), REST)]) < 0.4


def test_home_goes_slowly_from_anywhere():
    robot = _Robot().ready()
    robot.say(protocol.ARM, 4, 0, struct.pack("<h", 18000))
    before = robot.arm.angles[0]
    fastest = 0
    for _ in range(200):
        robot.step()
        fastest = max(fastest, abs(robot.arm.angles[0] - before))
        before = robot.arm.angles[0]
    assert robot.arm.state == HOLDS and list(robot.arm.angles) == [18000, 0, -3000]
    assert 60 < fastest <= 1.07 * 17000 / 4 / 50  # 0.01 deg a period: a quarter of 170 deg/s, and what integers round
    assert abs(robot.shown()[0] - 180) < 0.4
    robot.say(protocol.ARM, 2)
    robot.step(200)
    assert list(robot.arm.angles) == REST
    robot.say(protocol.ARM, 5, struct.pack("<3h", 10000, 1000, 0))
    robot.step(200)
    assert list(robot.arm.angles) == [10000, 1000, 0]
    assert "outside its limits" in robot.refused(protocol.ARM, 4, 0, struct.pack("<h", 20700))
    assert "joint 0 .. 2" in robot.refused(protocol.ARM, 4, 3, struct.pack("<h", 0))
    assert "arm 9" in robot.refused(protocol.ARM, 9)


def test_a_trajectory_is_played_as_it_was_meant():
    robot = _Robot({"servos": {"latency": 0}}).ready()
    assert robot.upload(_there_and_back(robot)) == "kept"
    robot.say(protocol.ARM, 3)
    robot.step()
    began = ticks_add(robot.now, -PERIOD_US)
    seen = []
    while robot.arm.state == PLAYS:
        seen.append((ticks_diff(robot.now, began) / 1e6 - 0.02, list(robot.arm.angles)))
        robot.step()
    assert 1.9 < seen[-1][0] < 2.05 and list(robot.arm.angles) == REST and robot.arm.why == 0
    for t, angles in seen:  # the cubic through both ends of each stretch, in floating point
        knots = ((0, 9000, 0, 0.5, 10000, 3000), (0.5, 10000, 3000, 0.5, 11000, 0), (1.0, 11000, 0, 1.0, 9000, 0))
        at = [knot for knot in knots if knot[0] <= t + 1e-6][-1]
        start, q0, v0, span, q1, v1 = at
        s = min((t - start) / span, 1)
        wanted = q0 + (3 * s**2 - 2 * s**3) * (q1 - q0) + span * ((s**3 - 2 * s**2 + s) * v0 + (s**3 - s**2) * v1)
        assert abs(wanted - angles[0]) < 12, (t, wanted, angles[0])  # 0.12 deg
    assert max([abs(a - b / 100) for a, b in zip(robot.shown(), REST)]) < 0.4
    robot.say(protocol.ARM, 3)  # it is still there
    robot.step(150)
    assert robot.arm.state == HOLDS and robot.arm.why == 0


def test_the_servos_latency_is_led():
    robot = _Robot({"servos": {"latency": 100}}).ready()
    other = _Robot({"servos": {"latency": 0}}).ready()
    for one, steps in ((robot, 6), (other, 11)):
        armed.ticks_us = requests.ticks_us = lambda one=one: one.now
        one.upload(_there_and_back(one))
        one.say(protocol.ARM, 3)
        one.step(steps)
    assert abs(robot.arm.angles[0] - other.arm.angles[0]) < 3 and robot.arm.angles[0] > 9100


def _frozen(robot, why):
    where = list(robot.arm.angles)
    assert robot.arm.state == HOLDS and robot.arm.why == why, (robot.arm.state, robot.arm.why)
    assert where != REST
    robot.step(50)
    assert list(robot.arm.angles) == where and all(robot.counts())  # it holds: limp it would fall
    assert robot.enable.level == 0


def _playing():
    robot = _Robot().ready()
    robot.upload(_there_and_back(robot))
    robot.say(protocol.ARM, 3)
    robot.step(20)
    assert robot.arm.state == PLAYS
    return robot


def test_what_freezes_it():
    robot = _playing()
    robot.say(protocol.ARM, 0)
    _frozen(robot, HELD)
    robot = _playing()
    robot.link.safety.fault = 1  # the stop button
    robot.step()
    robot.link.safety.fault = 0
    _frozen(robot, FAULT)
    assert robot.link.logs == ["the arm is frozen where it was"]
    robot = _playing()
    robot.link_lost(14)
    assert robot.arm.state == PLAYS
    robot.link_lost(3)
    _frozen(robot, LOST)
    robot = _playing()
    for _ in range(10):
        robot.say(protocol.ARM, 1)
        robot.link_lost(5)  # 100 ms
    assert robot.arm.state == PLAYS
    robot.drive.command(0, 0, 108)
    robot.step(3)
    robot.drive.stop()
    _frozen(robot, WHEELS)
    assert "where the trajectory begins" in robot.refused(protocol.ARM, 3)
    assert "first to where it begins" in robot.say(protocol.ARM, 3, 1)
    robot.step(200)
    robot.say(protocol.ARM, 3)
    assert robot.arm.state == PLAYS


def test_a_stop_of_the_link_freezes_it_and_its_state_is_told():
    robot = _playing()
    data = bytearray(64)
    assert robot.link.again(data, ticks_add(robot.now, 100_000), robot) == 3 + 2 * 3  # the link itself has nothing to tell
    assert data[3] == protocol.ARM_STATE and data[8] == PLAYS and data[10] == 3
    assert struct.unpack_from("<3h", data, 11) == tuple(robot.arm.angles)
    assert robot.link.again(data, ticks_add(robot.now, 150_000), robot) == 0  # ten times a second
    robot.link.length = 7
    assert robot.link.again(data, ticks_add(robot.now, 300_000), robot) == 7
    robot.link.stop()
    assert robot.link.stops == 1
    _frozen(robot, HELD)


def test_with_while_driving_the_wheels_may_turn():
    robot = _Robot(arm=dict(ARM, while_driving=True)).ready()
    robot.upload(_there_and_back(robot))
    robot.drive.command(0, 0, 108)
    robot.step(10)
    robot.say(protocol.ARM, 3)
    robot.step(20)
    assert robot.arm.state == PLAYS and robot.drive.told_v256


def test_no_start_with_a_fault_or_while_it_drives():
    robot = _Robot().ready()
    robot.upload(_there_and_back(robot))
    robot.link.safety.fault = 2
    assert "has a fault" in robot.refused(protocol.ARM, 3) and "has a fault" in robot.refused(protocol.ARM, 2)
    robot.link.safety.fault = 0
    robot.link.state = 1
    assert "the robot drives" in robot.refused(protocol.ARM, 3)
    robot.link.state = 0
    robot.drive.command(0, 0, 108)
    robot.step(10)
    assert "the robot drives" in robot.refused(protocol.ARM, 4, 0, b"\x00\x00")
    assert robot.arm.state == HOLDS


def test_a_lost_servo_chip_leaves_it_limp_and_it_does_not_move_by_itself():
    robot = _playing()
    chip = robot.bus.chips[0x40]
    chip.reset()
    robot.step(200)
    assert robot.drive.ok and robot.arm.state == OFF and robot.arm.why == CHIPS
    assert robot.counts() == [0, 0, 0] and any(chip.counts(10))  # the wheels are back
    assert "home switches it on" in robot.link.logs[0] and len(robot.link.logs) == 1
    robot = _playing()
    robot.bus.chips[0x41].present = False
    robot.drive.command(0, 0, 108)
    robot.step(100)
    assert robot.enable.level == 1 and robot.arm.state == OFF
    robot.bus.chips[0x41].present = True
    robot.step(100)
    assert robot.drive.ok and robot.counts() == [0, 0, 0]


def test_with_an_output_enable_of_its_own_it_holds_when_the_motors_are_switched_off():
    robot = _Robot(own=FakePin()).ready()
    assert robot.own.level == 0
    held = robot.counts()
    robot.drive.command(0, 0, 108)
    robot.step(5)
    robot.bus.chips[0x41].present = False
    for _ in range(120):
        robot.step()
        assert robot.counts() == held and robot.own.level == 0
    assert robot.enable.level == 1 and not robot.drive.ok
    robot.bus.chips[0x41].present = True
    for _ in range(120):
        robot.step()
        assert robot.counts() == held and robot.own.level == 0
    assert robot.drive.ok and robot.enable.level == 0 and robot.arm.state == HOLDS
    robot.bus.chips[0x40].present = False
    robot.step(60)
    assert robot.own.level == 1 and robot.arm.state == OFF
    robot.drive.off()
    assert robot.own.level == 1


def test_off_lets_go():
    robot = _Robot(own=FakePin()).ready()
    robot.drive.off()
    assert robot.enable.level == 1 and robot.own.level == 1 and robot.counts() == [None] * 3 and robot.arm.state == OFF


class _Spy(FakeBus):
    """Keeps every write."""

    def __init__(self):
        FakeBus.__init__(self)
        self.writes = []

    def writeto(self, address, data):
        self.writes.append((address, bytes(data)))
        FakeBus.writeto(self, address, data)


def _ride(arm):
    """What is written while wheels steer, drive and stop, with the arm playing in between; the arm's own writes apart."""
    spy = _Spy()
    robot = _Robot(arm=None, bus=spy)
    if arm:
        with open("arm.json", "w") as file:
            file.write(json.dumps(dict(ARM, while_driving=True)))
        robot.arm = build.add(robot.config, robot.drive, robot.link, robot.chips, robot.enable, None)
    else:
        robot.arm = _Part()
    robot.step(60)
    for k in range(300):
        if arm and k == 3:
            robot.say(protocol.ARM, 2)
        if arm and k == 60:
            robot.upload(_there_and_back(robot))
            robot.say(protocol.ARM, 3)
        if k % 8 == 0:
            robot.drive.command((k * 7) % 161 - 80, (k * 11) % 161 - 80, 108 if k % 96 else 72)
        if k == 200:
            robot.drive.stop()
        if k == 230:
            spy.chips[0x42].reset()
        robot.step()
    own = [6 + 4 * channel for channel in ARM["servos"]["channels"]]
    wheels = [one for one in spy.writes if not (one[0] == 0x40 and one[1][0] in own and len(one[1]) == 5)]
    return wheels, len(spy.writes) - len(wheels)


def test_the_wheels_registers_are_byte_for_byte_the_same_with_and_without_an_arm():
    without, none = _ride(False)
    wheels, arms = _ride(True)
    assert none == 0 and arms > 100 and len(without) > 150
    assert wheels == without


def test_nothing_is_allocated_while_it_plays():
    robot = _playing()
    update, arm = robot.drive.update, robot.arm
    now = robot.now
    armed.ticks_us = requests.ticks_us = lambda: _clock[0]
    _clock[0] = now
    micropython.heap_lock()
    try:
        k = 0
        while k < 60:
            arm.heard_us = now
            update(now)
            now = ticks_add(now, PERIOD_US)
            _clock[0] = now
            k += 1
    finally:
        micropython.heap_unlock()
    assert arm.state == PLAYS and arm.before[0] == 500


_clock = [0]


def _bad(robot, data, words):
    said = ""
    try:
        robot.upload(data)
    except ValueError as error:
        said = str(error)
    assert words in said, said
    assert "no trajectory on the board" in robot.refused(protocol.ARM, 3)


def test_bad_trajectories_are_refused_with_a_reason():
    robot = _Robot().ready()
    good = [(0, 9000, 0, 0, 0, -3000, 0), (500, 10000, 300, 0, 0, -3000, 0), (500, 11000, 0, 0, 0, -3000, 0)]

    def knots(row, column, value):
        changed = [list(one) for one in good]
        changed[row][column] = value
        return _trajectory(robot, changed)

    whole = _trajectory(robot, good)
    _bad(robot, b"not a trajectory at all", "no bytes of a trajectory")
    _bad(robot, whole[:-3] + bytes((whole[-3] ^ 1,)) + whole[-2:], "its check does not hold")
    _bad(robot, whole + b"\x00", "cut off, or of another arm")
    _bad(robot, _trajectory(robot, good, ident=robot.arm.ident ^ 1), "another arm, or for other limits")
    _bad(robot, _trajectory(robot, [one[:5] for one in good], joints=2), "of another arm")
    _bad(robot, _trajectory(robot, good[:1]), "no way to go")
    _bad(robot, knots(1, 0, 0), "its time goes back")
    _bad(robot, knots(1, 0, 65000), "its time goes back")
    _bad(robot, knots(0, 0, 5), "its time goes back")
    _bad(robot, knots(1, 1, 20700), "joint 1 at 20700 (0.01 deg) is outside its limits")
    _bad(robot, knots(1, 4, 1800), "joint 2 turns faster")
    _bad(robot, knots(2, 5, 6000), "joint 3 jumps")
    _bad(robot, knots(2, 2, 5), "begin and end at rest")
    _bad(robot, knots(0, 2, 5), "begin and end at rest")
    assert "offset 3: " in robot.refused(protocol.REACH, b"\x03\x00", whole[:20])
    assert robot.upload(whole) == "kept"
    robot.say(protocol.ARM, 3)
    robot.step(2)
    assert "the arm moves" in robot.refused(protocol.REACH, b"\x00\x00", whole[:20])
    robot.say(protocol.ARM, 0)
    with open("reach.bin", "rb") as file:
        data = file.read()
    with open("reach.bin", "wb") as file:
        file.write(data[:30])
    assert "cut off" in robot.refused(protocol.ARM, 3)


def test_random_bytes_are_no_trajectory():
    robot = _Robot().ready()
    value = 1
    for _ in range(60):
        data = bytearray(b"GR\x01")
        for _ in range(60):
            value = (value * 1103515245 + 12345) & 0x3FFFFFFF
            data.append(value >> 16 & 255)
        data[3], data[6], data[7] = 3, 3, 0
        try:
            robot.upload(bytes(data))
            assert False
        except ValueError:
            pass
    assert robot.arm.state == HOLDS


def _start_fails(change, words):
    try:
        _Robot(arm=dict(ARM, **change))
    except ValueError as error:
        assert words in str(error) and str(error).startswith("arm.json: "), str(error)
        return
    assert False, "not refused: " + words


def test_an_arm_that_does_not_fit_is_refused_at_the_start():
    servos = ARM["servos"]
    _start_fails({"servos": dict(servos, channels=[9, 10, 11])}, "output 9 of the servos' chip is a wheel's; free are 10, 11, 12, 13, 14, 15")
    _start_fails({"servos": dict(servos, channels=[10, 10, 11])}, "each once")
    _start_fails({"servos": dict(servos, channels=[10, 11])}, "a list of 3 numbers")
    _start_fails({"servos": dict(servos, rest_deg=[90, 0, -50])}, "joint 3: ")
    _start_fails({"servos": dict(servos, range_deg=180)}, "joint 1: ")
    _start_fails({"joints": [], "extra": []}, "1 .. 12 with extra")
    _start_fails({"joints": [{"low_deg": 0}] * 2}, "high_deg = null")
    with open("arm.json", "w") as file:
        file.write('{"joints": [')
    robot = _Robot(arm=None)
    try:
        build.add(robot.config, robot.drive, robot.link, robot.chips, robot.enable, None)
        assert False
    except ValueError as error:
        assert "not JSON, or cut off" in str(error)


def test_eight_axles_leave_no_room():
    robot = _Robot({"axles": {"spacings": [80] * 7}}, arm=None)
    with open("arm.json", "w") as file:
        file.write(json.dumps(ARM))
    try:
        build.add(robot.config, robot.drive, robot.link, robot.chips, robot.enable, None)
        assert False
    except ValueError as error:
        assert "free are none" in str(error)


def test_without_an_arm_its_commands_are_refused():
    link = _Link()
    try:
        requests.carry_out(link, protocol.ARM, b"\x00\x00\x00\x00\x02", None, False)
        assert False
    except ValueError as error:
        assert "no arm" in str(error)
