"""Wheels and body: pulses and duties in, pose out.

Each wheel's servo slews towards the angle of its last pulse and its motor follows its duty with a lag. The body moves with the twist
that fits the velocities of all wheels best (least squares); what is left over is scrub, the speed at which the wheels drag or slip.
"""

from math import exp, hypot, sqrt

import numpy as np

STEP_US = 2000
MOTOR_LAG_US = 80_000.0
TRIM_ERROR = 0.5  # deg, 1 sigma of the servos' mounting
GAIN_ERROR = 0.01  # 1 sigma of the wheels' speeds
SLEW = 300.0  # deg/s of the servos
ROLL_ERROR = 0.025  # largest common error of the distance rolled
MOVING = 5.0  # mm/s of the fastest wheel, above which scrub counts


class Body:
    """The moving robot.

    vehicle: Vehicle. random: numpy Generator of this robot's imperfections. pose: x, y (mm), heading (radians clockwise from +y).

    stuck: for an Observer to set, the wheels whose servos no longer move.
    x, y, heading, now (us): the pose now. times, poses: history, (k,) us and (k, 3), `count` entries used.
    """

    def __init__(self, vehicle, random, pose):
        axles = np.array(vehicle.axles)
        n = 2 * len(axles)
        wheel_x = np.tile([-vehicle.track / 2, vehicle.track / 2], len(axles))
        wheel_y = np.repeat(axles, 2)
        one, zero = np.ones(n), np.zeros(n)
        # Wheel velocity (wx, wy) = (vx + w y, vy - w x); rows: all wx, then all wy.
        self._wheels = np.block([[one[:, None], zero[:, None], wheel_y[:, None]], [zero[:, None], one[:, None], -wheel_x[:, None]]])
        self._fit = np.linalg.pinv(self._wheels).T.copy()
        self._back = self._wheels.T.copy()
        self.trim_error = np.radians(random.normal(0, TRIM_ERROR, n))
        self.gain = 1 + random.normal(0, GAIN_ERROR, n) + random.uniform(-ROLL_ERROR, ROLL_ERROR)
        self.stuck = np.zeros(n, bool)
        self._told = np.zeros(n)
        self._reach = hypot(vehicle.width, vehicle.length) / 2
        self._rate = np.radians(SLEW) / 1e6

        self.angles = self.trim_error.copy()
        self.targets = self.angles.copy()
        self.speeds = np.zeros(n)
        self.speed_targets = np.zeros(n)
        self.now = 0.0
        self.x, self.y, self.heading = pose
        self.twist = [0.0] * 3
        self.scrub = 0.0
        self._scrub_sum = self._scrub_time = 0.0
        self.times = np.zeros(8192)
        self.poses = np.zeros((8192, 3))
        self.poses[0] = pose
        self.count = 1

    @property
    def mean_scrub(self):
        """Mean over the time in motion of the wheels' rms slip, mm/s."""
        return self._scrub_sum / self._scrub_time if self._scrub_time else 0.0

    def steer(self, angles, driven):
        """New targets, radians, for the wheels where `driven`; the others stay where they are."""
        driven = driven & ~self.stuck
        np.copyto(self.targets, angles + self.trim_error, where=driven)
        np.copyto(self.targets, self.angles, where=~driven)

    def drive(self, speeds):
        """New wheel speeds, mm/s."""
        self._told = speeds
        self.speed_targets = speeds * self.gain

    def set_gain(self, gain):
        """Another share of the speed that each wheel is told becomes motion; 1 = all of it."""
        self.gain = gain
        self.drive(self._told)

    @property
    def fastest(self):
        """Upper bound of the speed of any point of the body, mm/s."""
        return hypot(self.twist[0], self.twist[1]) + abs(self.twist[2]) * self._reach

    def still(self):
        """True when nothing moves or is about to."""
        return not (self.speed_targets.any() or np.abs(self.speeds).max() > 0.05)

    def advance(self, time):
        """Move to the time, us: it must be later than now."""
        span = time - self.now
        steps = int(span // STEP_US) + 1
        middle = (np.arange(steps) + 0.5) * (span / steps)
        if self.still():
            self._rest(time, span)
            return
        swing = self.targets - self.angles
        lag = self.speeds - self.speed_targets
        if swing.any():
            reach = (middle * self._rate)[:, None]
            angles = self.angles + _limited(swing, reach)
            self.angles = self.angles + _limited(swing, self._rate * span)
        else:
            angles = self.angles[None]
        speeds = self.speed_targets + np.exp(middle / -MOTOR_LAG_US)[:, None] * lag
        self.speeds = self.speed_targets + exp(span / -MOTOR_LAG_US) * lag
        wheels = np.concatenate([speeds * np.sin(angles), speeds * np.cos(angles)], axis=1)
        twists = wheels @ self._fit
        slip = wheels - twists @ self._back
        slip = slip.ravel()
        self.scrub = sqrt(2 * slip.dot(slip) / len(slip))
        if np.abs(self.speeds).max() > MOVING:
            self._scrub_sum += self.scrub * span
            self._scrub_time += span
        self.twist = twists[-1].tolist()

        step = span / steps / 1e6
        turns = twists[:, 2] * step
        headings = self.heading + turns.cumsum()
        half = headings - turns / 2
        s, c = np.sin(half), np.cos(half)
        end = self._reserve(steps)
        poses = self.poses[self.count : end]
        poses[:, 0] = self.x + (twists[:, 0] * c + twists[:, 1] * s).cumsum() * step
        poses[:, 1] = self.y + (twists[:, 1] * c - twists[:, 0] * s).cumsum() * step
        poses[:, 2] = headings
        self.times[self.count : end] = self.now + np.arange(1, steps + 1) * (span / steps)
        self.count = end
        self.x, self.y, self.heading = poses[-1].tolist()
        self.now = time

    def put_back(self, count, pose):
        """Undo the motion since the history had `count` entries: the body is held at `pose`."""
        self.poses[count : self.count] = pose
        self.x, self.y, self.heading = pose
        self.twist = [0.0] * 3

    def poses_at(self, times):
        """x, y, heading at each time, us, within the history."""
        first = max(int(np.searchsorted(self.times[: self.count], times[0])) - 1, 0)
        known = self.times[first : self.count]
        poses = self.poses[first : self.count]
        return (np.interp(times, known, poses[:, 0]), np.interp(times, known, poses[:, 1]), np.interp(times, known, poses[:, 2]))

    def _rest(self, time, span):
        """Only the servos move."""
        swing = self.targets - self.angles
        if swing.any():
            self.angles = self.angles + _limited(swing, self._rate * span)
        self.speeds = np.zeros_like(self.speeds)
        self.twist = [0.0] * 3
        self.scrub = 0.0
        end = self._reserve(1)
        self.times[end - 1] = time
        self.poses[end - 1] = self.x, self.y, self.heading
        self.count = end
        self.now = time

    def _reserve(self, steps):
        """Make room in the history for so many entries; returns the index behind them."""
        end = self.count + steps
        if end > len(self.times):
            self.times = np.concatenate([self.times, np.zeros_like(self.times)])
            self.poses = np.concatenate([self.poses, np.zeros_like(self.poses)])
        return end


def _limited(values, limit):
    """Values within -limit .. limit."""
    return np.minimum(np.maximum(values, -limit), limit)
