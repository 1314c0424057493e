"""Registers in, motion out: the way the electronics see the robot."""

from math import atan2, cos, degrees, hypot, radians, sin

import numpy as np
import pytest

from host.twin import body as body_module
from host.twin.body import Body
from host.twin.electronics import Electronics
from host.twin.vehicle import Vehicle

VEHICLE = Vehicle.from_settings({})


class Perfect:
    """Random numbers of a robot without imperfections."""

    def normal(self, mean, sigma, n):
        return np.full(n, float(mean))

    def uniform(self, low, high):
        return 0.0


class Robot:
    """Electronics and body, driven by register writes."""

    def __init__(self, settings=None, pose=(0, 0, 0)):
        vehicle = Vehicle.from_settings(settings or {})
        self.n = 2 * len(vehicle.axles)
        self.body = Body(vehicle, Perfect(), pose)
        self.electronics = Electronics(vehicle, self.body, None)
        for address, prescale in ((0x40, 121), (0x41, 5), (0x42, 5)):
            self.write(address, 0xFE, prescale)
            self.write(address, 0x00, 0x21)
        self.electronics.pin(0, 33, 0)

    def write(self, address, *data):
        self.electronics.i2c_write(self.body.now, address, bytes(data))

    def angles(self, degrees_):
        for channel, angle in enumerate(degrees_):
            count = round((1500 + angle * 1000 / 90) / 4.88)
            self.write(0x40, 0x06 + 4 * channel, 0, 0, count & 255, count >> 8)

    def duties(self, shares):
        for wheel, share in enumerate(shares):
            count = round(abs(share) * 4095)
            first, second = (count, 0) if share >= 0 else (0, count)
            data = [0, 0, first & 255, first >> 8, 0, 0, second & 255, second >> 8]
            self.write(0x41 + wheel % 2, 0x06 + 8 * (wheel // 2), *data)

    def wait(self, seconds):
        end = self.body.now + seconds * 1e6
        while self.body.now < end:
            step = min(end, self.electronics.latch, self.body.now + 10_000)
            if step > self.body.now:
                self.body.advance(step)
            if step == self.electronics.latch:
                self.electronics.take_pulses()
        return self

    def drive(self, angles, shares, seconds=1.0):
        """Turn the wheels, then drive; returns the pose."""
        self.angles(angles)
        self.wait(1.0)
        self.duties(shares)
        self.wait(seconds)
        return self.body.x, self.body.y, degrees(self.body.heading)


def rolled(seconds, share=0.2):
    """Distance at full speed 1280 mm/s from rest, with the motors' lag."""
    return 1280 * share * (seconds - 0.08 * (1 - np.exp(-seconds / 0.08)))


def test_straight():
    x, y, heading = Robot().drive([0] * 10, [0.2] * 10)
    assert (x, heading) == pytest.approx((0, 0), abs=1.0)
    assert y == pytest.approx(rolled(1.0), rel=0.002)


def test_backwards():
    _, y, _ = Robot().drive([0] * 10, [-0.2] * 10)
    assert y == pytest.approx(-rolled(1.0), rel=0.002)


def test_crab_moves_sideways_without_turning():
    x, y, heading = Robot().drive([60] * 10, [0.2] * 10)
    assert heading == pytest.approx(0, abs=0.1)
    assert degrees(atan2(x, y)) == pytest.approx(60, abs=0.3)


def spin_angles():
    """Wheel angles of a clockwise spin, and the shares of the speed with their signs."""
    angles, shares = [], []
    for y in VEHICLE.axles:
        for x in (-115, 115):
            # Clockwise: the wheel's velocity is (y, -x). Turned into -90..90 with the sign in the speed.
            wx, wy = (y, -x) if x < 0 else (-y, x)
            angles.append(degrees(atan2(wx, wy)))
            shares.append(hypot(wx, wy) / 300 * (1 if x < 0 else -1))
    return angles, shares


def test_spin_on_the_spot():
    robot = Robot()
    x, y, heading = robot.drive(*spin_angles(), 0.5)
    turned = degrees(1280 / 300 * (0.5 - 0.08 * (1 - np.exp(-0.5 / 0.08))))
    assert heading == pytest.approx(turned, rel=0.01)
    assert (x, y) == pytest.approx((0, 0), abs=1.0)
    assert robot.body.mean_scrub < 3


def test_adverse_phase_turns_about_its_centre():
    # AF = -AR = 30: centre at the right, R = S / (2 tan 30).
    s, radius = 497, 497 / (2 * np.tan(radians(30)))
    angles, shares = [], []
    for y in VEHICLE.axles:
        for x in (-115, 115):
            wx, wy = y, radius - x
            angles.append(degrees(atan2(wx, wy)))
            shares.append(hypot(wx, wy) / hypot(s / 2, radius + 115) * 0.2)
    robot = Robot()
    x, y, heading = robot.drive(angles, shares, 2.0)
    # The outer wheel of the first axle moves at the full share.
    turned = rolled(2.0) / hypot(s / 2, radius + 115)
    assert heading == pytest.approx(degrees(turned), rel=0.01)
    assert (x, y) == pytest.approx((radius * (1 - cos(turned)), radius * sin(turned)), abs=3)
    assert robot.body.mean_scrub < 3


def test_wheels_that_disagree_scrub():
    robot = Robot()
    robot.drive([10, 10] + [0] * 6 + [10, 10], [0.2] * 10)
    assert robot.body.mean_scrub > 15


def test_a_servo_needs_its_time():
    robot = Robot().wait(0.1)
    robot.angles([90] * 10)
    robot.wait(0.2)
    assert 45 < degrees(robot.body.angles[0]) < 60  # 300 deg/s, less up to 20 ms for the pulse and the reaction
    robot.wait(0.2)
    assert degrees(robot.body.angles[0]) == pytest.approx(90, abs=0.3)


def test_output_enable_stops_motors_and_lets_servos_be():
    robot = Robot()
    robot.drive([20] * 10, [0.2] * 10)
    robot.electronics.pin(robot.body.now, 33, 1)
    robot.angles([-20] * 10)
    robot.wait(1.0)
    assert not robot.body.speeds.any()
    assert degrees(robot.body.angles[0]) == pytest.approx(20, abs=0.3)


def test_a_chip_that_browns_out_stops_its_motors():
    robot = Robot()
    robot.drive([0] * 10, [0.2] * 10)
    robot.electronics.brown_out(robot.body.now, 0x41)
    robot.wait(1.0)
    assert not robot.body.speed_targets[0::2].any() and robot.body.speed_targets[1::2].all()


def test_any_number_of_axles():
    robot = Robot({"robot": {"length": 500}, "axles": {"spacings": [200, 150], "track": 200}})
    x, y, heading = robot.drive([45] * 6, [0.2] * 6)
    assert degrees(atan2(x, y)) == pytest.approx(45, abs=0.3)
    assert hypot(x, y) == pytest.approx(rolled(1.0), rel=0.005)


def test_both_inputs_high_brake():
    robot = Robot()
    for axle in range(5):
        robot.write(0x41, 0x06 + 8 * axle, 0, 0x10, 0, 0, 0, 0x10, 0, 0)
    assert not robot.body.speed_targets.any()


def test_channels_directions_and_trims_are_those_of_robot_json():
    settings = {
        "servos": {"channels": list(range(9, -1, -1)), "directions": [-1] + [1] * 9, "trims": [0] * 9 + [5]},
        "motors": {"directions": [1, -1] * 5, "channels": [8, 6, 4, 2, 0]},
    }
    robot = Robot(settings).wait(0.1)
    robot.angles([0] * 9 + [30])  # channel 9 is wheel 0, which turns the other way
    robot.wait(0.5)
    assert np.degrees(robot.body.angles) == pytest.approx([-30] + [0] * 8 + [-5], abs=0.4)
    robot.duties([0.1] * 10)
    assert robot.body.speed_targets == pytest.approx([128, -128] * 5, rel=0.01)


def test_imperfections_are_small_and_seeded():
    one, two = (Body(VEHICLE, np.random.default_rng(5), (0, 0, 0)) for _ in range(2))
    assert np.array_equal(one.gain, two.gain)
    assert abs(one.gain - 1).max() < 0.025 + 4 * body_module.GAIN_ERROR
    assert 0 < np.degrees(np.abs(one.trim_error)).max() < 2.5


def test_poses_in_between():
    robot = Robot()
    robot.drive([0] * 10, [0.2] * 10)
    end = robot.body.now
    x, y, heading = robot.body.poses_at(np.array([end - 10_000, end - 5_000, end]))
    assert y[2] - y[1] == pytest.approx(1.28, abs=0.01)
    assert y[2] == robot.body.y
