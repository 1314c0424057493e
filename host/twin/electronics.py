"""Chips and wires between the firmware's I2C writes and pins, and the servos and motors."""

import numpy as np

from .pca9685 import Pca9685

SHORTEST_US, LONGEST_US = 400.0, 2600.0  # a servo ignores other pulses
REACTION_US = 6_000  # from the end of the pulse to the servo's motion
NEVER = float("inf")


class Electronics:
    """Three PCA9685 chips, the output-enable pin, the lidar's motor driver and the inputs.

    enabled: whether the output-enable pin lets the outputs of the chips through.
    stop_pressed, battery_volts, chips: for an Observer to change; a chip taken out of `chips` no longer answers.
    stop_wired, sda_held: likewise, whether the stop button's wire is there, and whether something holds the bus's data line low.
    motors_on: whether any motor output is on, at the chips and through output enable. switched: [(us, motors_on)] of each change.
    arm: arm.Arm, whose servos sit on the servos' chip, or None.
    latch: time (us) at which the servos answer to changed pulses, NEVER while nothing has changed.
    """

    def __init__(self, vehicle, body, lidar, arm=None):
        self.arm = arm
        self._vehicle = vehicle
        self._body = body
        self._lidar = lidar
        self._servo = Pca9685(vehicle.servo_oscillator)
        self._left, self._right = Pca9685(vehicle.motor_oscillator), Pca9685(vehicle.motor_oscillator)
        self.chips = {vehicle.servo_chip: self._servo, vehicle.left_chip: self._left, vehicle.right_chip: self._right}
        low, high = np.array(vehicle.pulse_low, float), np.array(vehicle.pulse_high, float)
        self._centre = (low + high) / 2
        self._radians_per_us = np.pi / (high - low)
        self._trims = np.radians(np.array(vehicle.trims) / 10)
        self._directions = np.array(vehicle.servo_directions)
        self._speeds = np.array(vehicle.motor_directions) * vehicle.full_speed
        self.enabled = vehicle.output_enable is None  # the pull-up holds the outputs off until the firmware drives the pin; without it they are on
        self._servos_on = self.enabled if vehicle.servo_enable is None else False
        self._servo_phase = 0.0
        self.latch = NEVER
        self._enable_wired = True
        self.stop_pressed = False
        self.stop_wired = True
        self.sda_held = False
        self.battery_volts = 7.8
        self.motors_on = False
        self.switched = []

    @property
    def addresses(self):
        """I2C addresses that acknowledge."""
        return self.chips.keys()

    @property
    def levels(self):
        """Levels of the input pins, bit = GPIO."""
        vehicle = self._vehicle
        levels = 1 << vehicle.scl  # with their pull-ups, like the button
        if not self.sda_held:
            levels |= 1 << vehicle.sda
        # A button that opens is closed to ground until it is pressed; then, and without its wire, the pull-up wins.
        high = self.stop_pressed or not self.stop_wired if vehicle.stop_closed else not (self.stop_pressed and self.stop_wired)
        if vehicle.stop_button is not None and high:
            levels |= 1 << vehicle.stop_button
        return levels

    @property
    def battery_reading(self):
        """What the ADC reads, 0..65535 over 3.3 V."""
        return min(round(self.battery_volts / self._vehicle.battery_divider / 3.3 * 65535), 65535)

    def i2c_write(self, time, address, data):
        """A write ended at the time, us."""
        chip = self.chips.get(address)
        if chip is None:
            return
        awake = chip.awake
        chip.write(data)
        if chip is self._servo:
            if chip.awake and not awake:
                self._servo_phase = time
            self._await_pulse(time)
        else:
            self._drive(time)

    def i2c_read(self, address, count):
        """Bytes that a chip sends; one that went away within the transfer leaves the line high."""
        chip = self.chips.get(address)
        return b"\xff" * count if chip is None else chip.read(count)

    def brown_out(self, time, address):
        """A chip loses its supply for a moment, and with it its registers."""
        self.chips[address].reset()
        self._await_pulse(time)
        self._drive(time)

    def lose_output_enable(self, time):
        """The wire to the chips' output enable comes off: its pull-down there lets the outputs through from now on."""
        self._enable_wired = False
        self._enable(time, True)

    def pin(self, time, gpio, level):
        """An output pin changed."""
        if gpio == self._vehicle.output_enable:
            self._enable(time, not level)
        elif gpio == self._vehicle.servo_enable and gpio is not None:
            self._servos_on = not level
            self._await_pulse(time)

    def release_pins(self, time):
        """The processor resets: its pins float. The pull-up at the output-enable pin switches the chips' outputs off, the lidar's motor driver stops."""
        self._enable(time, self._vehicle.output_enable is None)
        if self._vehicle.servo_enable is not None:
            self._servos_on = False  # it has a pull-up as well
        if self._vehicle.lidar.motor is not None:
            self._lidar.spin(time, 0)

    def pwm(self, time, gpio, duty):
        """The duty of a PWM pin changed, 0..1."""
        if gpio == self._vehicle.lidar.motor:
            self._lidar.spin(time, duty)

    def take_pulses(self):
        """The servos see their new pulses."""
        self.latch = NEVER
        chip = self._servo
        widths = np.array([chip.on_us(channel) for channel in self._vehicle.servo_channels])
        driven = (widths >= SHORTEST_US) & (widths <= LONGEST_US)
        servos_on = self.enabled if self._vehicle.servo_enable is None else self._servos_on
        if not servos_on:
            driven[:] = False
        if self.arm is not None:
            self.arm.take_pulses(self._body.now, [chip.on_us(channel) for channel in self.arm.channels], servos_on)
        angles = self._directions * (widths - self._centre) * self._radians_per_us
        self._body.steer(angles - self._trims, driven)

    def _await_pulse(self, time):
        """A pulse that has begun keeps its width: the new one comes with the next period, and the servo needs a moment."""
        if self.latch != NEVER and time > self.latch - REACTION_US:
            return  # that pulse is on its way; what comes within its last moment is taken with it
        period = self._servo.period_us
        self.latch = self._servo_phase + (np.floor((time - self._servo_phase) / period) + 1) * period + REACTION_US

    def _enable(self, time, on):
        self.enabled = on or not self._enable_wired
        self._await_pulse(time)
        self._drive(time)

    def _drive(self, time):
        """Motors follow IN1 less IN2."""
        shares = np.zeros(len(self._speeds))
        if self.enabled:
            for axle, channel in enumerate(self._vehicle.motor_channels):
                for side, chip in enumerate((self._left, self._right)):
                    shares[2 * axle + side] = chip.duty(channel) - chip.duty(channel + 1)
        on = bool(shares.any())
        if on != self.motors_on:
            self.motors_on = on
            self.switched.append((time, on))
        self._body.drive(shares * self._speeds)
