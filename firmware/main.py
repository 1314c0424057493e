"""The robot. Reads robot.json, builds the parts and runs the loop; everything else is in lib/."""

import sys
from time import sleep_ms

sys.path.append("/lib")

import machine

import config as configuration
from drive import Drive
from lidar import Lidar
from pca9685 import PCA9685
from robot import Robot
from steering import Steering


def build(config):
    """Hand the buses and pins to the parts. Everything that moves is off until the first decision."""
    enable = machine.Pin(config.pins_output_enable, machine.Pin.OUT, value=1)
    i2c = machine.I2C(
        config.i2c_bus, scl=machine.Pin(config.i2c_scl), sda=machine.Pin(config.i2c_sda), freq=config.i2c_frequency
    )
    servos = PCA9685(i2c, config.servos_address, config.servos_frequency, config.servos_oscillator)
    left = PCA9685(i2c, config.motors_left, config.motors_frequency, config.motors_oscillator)
    right = PCA9685(i2c, config.motors_right, config.motors_frequency, config.motors_oscillator)
    drive = Drive(Steering(config.axles_spacings, config.axles_track, config.axles_first), servos, left, right, enable, config)
    uart = machine.UART(config.lidar_uart, config.lidar_baud, rx=config.lidar_rx, rxbuf=config.lidar_rxbuf, timeout=0, timeout_char=1)
    motor = None
    if config.lidar_motor_pin is not None:
        motor = machine.PWM(machine.Pin(config.lidar_motor_pin), freq=config.lidar_motor_frequency, duty_u16=0)
    return Robot(config, Lidar(uart, motor, config), drive)


try:
    robot = build(configuration.load())
except (configuration.ConfigError, OSError) as error:
    # In doubt the robot stands still: outputs stay disabled, the reason goes out on the USB line.
    print("gapseeker: cannot start:", error)
    raise

while True:
    if not robot.step():
        sleep_ms(1)
