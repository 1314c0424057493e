"""The robot. Reads robot.json, builds the parts and runs the loop; everything else is in lib/."""

import gc
import sys
from time import sleep_ms

sys.path.append("/lib")

import machine

from params import config as configuration

# What the start leaves behind is cleared away at once, or it would lie between the things that stay and cut the heap to pieces.
gc.threshold(2048)

# In doubt the robot stands still: nothing moves before everything has been built, and the reason goes out on the USB line.
try:
    config = configuration.load()
except (configuration.ConfigError, OSError) as error:
    print("gapseeker: cannot start:", error)
    raise

from link import reason_texts
from core.unload import unload

names = reason_texts.names()
del reason_texts
unload("link.reason_texts")

from avoid import Avoid

avoid = Avoid(config)  # its tables are large: they come first, while the heap is still in one piece

from core.constructors import drop

drop(avoid)

from actuation.drive import Drive
from link.start import start_link
from pca9685 import PCA9685
from core.heap_reserve import Room
from params.settings import Settings
from steering import Steering


def build_drive():
    """Everything that moves is off until the first decision."""
    pin = machine.Pin
    enable = pin(config.pins_output_enable, pin.OUT, value=1)
    i2c = machine.I2C(config.i2c_bus, scl=pin(config.i2c_scl), sda=pin(config.i2c_sda), freq=config.i2c_frequency)
    servos = PCA9685(i2c, config.servos_address, config.servos_frequency, config.servos_oscillator)
    left = PCA9685(i2c, config.motors_left, config.motors_frequency, config.motors_oscillator)
    right = PCA9685(i2c, config.motors_right, config.motors_frequency, config.motors_oscillator)
    return Drive(Steering(config.axles_spacings, config.axles_track, config.axles_first), servos, left, right, enable, config)


try:
    drive = build_drive()
except OSError as error:
    print("gapseeker: cannot start:", error)
    raise
room = Room()
link = start_link(config, Settings(config, drive, avoid, room), names, machine)
del build_drive, start_link  # their room is the others' from now on
unload("link.start", "core.version")

from safety.health import Health
from lidar import Lidar
from robot import Robot


def build():
    """The robot, with what it sees by and what it shows."""
    pin = machine.Pin
    # timeout_char=1 spares an interrupt per byte
    uart = machine.UART(config.lidar_uart, config.lidar_baud, rx=config.lidar_rx, rxbuf=config.lidar_rxbuf, timeout=0, timeout_char=1)
    motor = None
    if config.lidar_motor_pin is not None:
        motor = machine.PWM(pin(config.lidar_motor_pin), freq=config.lidar_motor_frequency, duty_u16=0)
    lidar = Lidar(uart, motor, config)
    button = adc = screen = None
    if config.pins_stop_button is not None:
        button = pin(config.pins_stop_button, pin.IN, pin.PULL_UP)
    if config.pins_battery is not None:
        adc = machine.ADC(pin(config.pins_battery))
    health = Health(lidar, drive, button, adc, config)
    if config.screen_kind != "none":
        from link.screen import Screen

        line = machine.UART(config.screen_uart, config.screen_baud, tx=config.screen_tx, rx=config.screen_rx, txbuf=256, timeout=0)
        screen = Screen(line, config.screen_kind, config.screen_baud)
        unload("link.reason_texts")
    return Robot(config, avoid, lidar, drive, health, link, screen)


robot = build()
del build
drop(robot)
del drop
unload("core.constructors")
room.take()
gc.threshold(-1)

try:
    while True:
        if not robot.step():
            sleep_ms(1)
finally:
    # The chips go on with what they last heard: whatever ends the loop (Ctrl-C, a deploy, an error) must not leave the wheels turning.
    robot.drive.off()
    robot.lidar.stop()
