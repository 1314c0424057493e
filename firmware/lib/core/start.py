"""Builds the robot from robot.json. Needed once: main.py holds the robot, and everything in here is let go again.

The order of build() is a rule, because three things share one memory: the heap, which takes more of it whenever it is full and gives nothing
back; machine code, which has to lie in a part of it; and the drivers of radio and UARTs. Whoever needs a large piece asks before the heap grows.
"""

import gc

import machine

from core.unload import unload
from params.config import Config

_CLOCK = 240_000_000  # Hz; the board wakes up at 160 MHz, and all computing times hold for this

# What holds machine code, and stays: each with what it imports.
_MACHINE_CODE = ("link.telemetry", "actuation.drive", "pca9685", "lidar", "avoid")


def build(path="robot.json"):
    """The Robot. In doubt nothing moves: what is wrong is printed on the USB line and raised (ValueError, OSError)."""
    try:
        return _build(path)
    except (ValueError, OSError) as error:
        print("gapseeker: cannot start:", error)
        raise


def _build(path):
    # Garbage between the things that stay would cut the heap to pieces, and make it grow before the others have had their part; a collection
    # at every 2 kB, though, would take longer than the start itself.
    gc.threshold(4096)
    _clock()  # all the rest takes two thirds of the time then
    values = _read(path)
    enable = _silence(values)  # whatever the chips did before a restart: motors and servos are off while the rest is made
    config = Config(values)  # everything depends on it, and a mistake in it must be told before anything moves
    del values
    wlan, remark = _radio(config)  # its memory must be there before the heap grows; it joins the network meanwhile
    lidar_line, screen_line = _lines(config)  # the drivers' buffers come from the same memory
    for name in _MACHINE_CODE:  # likewise, and it is the largest part
        __import__(name)
    from avoid import Avoid

    avoid = Avoid(config)  # its tables are the largest objects: they come while the heap is still in one piece
    drive = _drive(config, enable)
    link = _link(config, wlan, remark)
    robot = _robot(config, avoid, drive, link, lidar_line, screen_line)
    config.once = None
    unload("core.axles", "core.start", "core.version")
    gc.threshold(-1)  # from now on the loop allocates nothing
    return robot


def _clock():
    if machine.freq() != _CLOCK:
        machine.freq(_CLOCK)
        if machine.freq() != _CLOCK:
            print("gapseeker: the processor runs at %d MHz instead of 240: decisions take longer" % (machine.freq() // 1_000_000))


def _read(path):
    from params.parse import load

    return load(path)


def _silence(values):
    """The output enable pin, outputs off, or None. It is set before the file is checked, as that takes a while."""
    try:
        return machine.Pin(values["pins"]["output_enable"], machine.Pin.OUT, value=1)
    except (ValueError, KeyError, TypeError):
        return None  # there is none, it is left to the default, or it is wrong: the check will say


def _radio(config):
    """(WLAN that joins by itself, None); (None, what went wrong); (None, None) without a radio."""
    if not config.once["wifi_ssid"]:
        return None, None
    from link.wifi import connect

    answer = connect(config)
    unload("link.wifi")
    return answer


def _lines(config):
    """The UARTs of lidar and screen (or None)."""
    once = config.once
    # timeout_char=1 spares an interrupt per byte
    lidar = machine.UART(once["lidar_uart"], once["lidar_baud"], rx=once["lidar_rx"], rxbuf=once["lidar_rxbuf"], timeout=0, timeout_char=1)
    screen = None
    if once["screen_kind"] != "none":
        screen = machine.UART(once["screen_uart"], once["screen_baud"], tx=once["screen_tx"], rx=once["screen_rx"], txbuf=256, timeout=0)
    return lidar, screen


def _drive(config, enable):
    """Everything that moves is off until the first decision."""
    from actuation.drive import Drive
    from pca9685 import PCA9685
    from steering import Steering

    once = config.once
    pin = machine.Pin
    if enable is None and once["pins_output_enable"] is not None:
        enable = pin(once["pins_output_enable"], pin.OUT, value=1)
    i2c = machine.I2C(once["i2c_bus"], scl=pin(once["i2c_scl"]), sda=pin(once["i2c_sda"]), freq=once["i2c_frequency"])
    servo_channels = max(once["servos_channels"]) + 1
    motor_channels = max(once["motors_channels"]) + 2
    servos = PCA9685(i2c, once["servos_address"], once["servos_frequency"], once["servos_oscillator"], servo_channels)
    left = PCA9685(i2c, once["motors_left"], once["motors_frequency"], once["motors_oscillator"], motor_channels)
    right = PCA9685(i2c, once["motors_right"], once["motors_frequency"], once["motors_oscillator"], motor_channels)
    drive = Drive(Steering(once["axles_spacings"], once["axles_track"], once["axles_first"]), servos, left, right, enable, config)
    unload("actuation.wiring")
    return drive


def _link(config, wlan, remark):
    from link.start import start_link

    link = start_link(config, machine, wlan, remark)
    unload("link.start")
    return link


def _robot(config, avoid, drive, link, lidar_line, screen_line):
    """The robot, with what it sees by and what it shows."""
    from lidar import Lidar
    from robot import Robot
    from safety.health import Health

    once = config.once
    pin = machine.Pin
    motor = button = adc = screen = None
    if once["lidar_motor_pin"] is not None:
        motor = machine.PWM(pin(once["lidar_motor_pin"]), freq=once["lidar_motor_frequency"], duty_u16=0)
    lidar = Lidar(lidar_line, motor, config)
    if once["pins_stop_button"] is not None:
        button = pin(once["pins_stop_button"], pin.IN, pin.PULL_UP)
    if once["pins_battery"] is not None:
        adc = _battery(pin(once["pins_battery"]), link)
    health = Health(lidar, drive, button, adc, config)
    if screen_line is not None:
        from link.screen import Screen

        screen = Screen(screen_line, once["screen_kind"], once["screen_baud"])
        unload("link.reason_texts", "link.screen_dialects")
    return Robot(config, avoid, lidar, drive, health, link, screen)


def _battery(pin, link):
    """The ADC of the battery's divider, over the widest range; a chip without calibration is told of once."""
    adc = machine.ADC(pin, atten=machine.ADC.ATTN_11DB)
    try:
        adc.read_uv()
    except OSError:
        link.log(1, "the chip's ADC is not calibrated: the battery's voltage may be 10 % off, set battery.divider by a voltmeter")
    return adc
