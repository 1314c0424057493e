"""Builds the robot from robot.json. Needed once: main.py holds the robot, and everything in here is let go again.

The order of build() is a rule, because three things share one memory: the heap, which takes more of it whenever it is full and gives nothing
back; machine code, which has to lie in a part of it; and the drivers of radio and UARTs. Whoever needs a large piece asks before the heap grows.
"""

import gc

from core.unload import unload

# What holds machine code, and stays: each with what it imports.
_MACHINE_CODE = ("link.telemetry", "actuation.drive", "lidar", "avoid")


def build(path="robot.json"):
    """The Robot. In doubt nothing moves: what is wrong is printed on the USB line and raised (ValueError, OSError)."""
    # Garbage between the things that stay would cut the heap to pieces, and make it grow before the others have had their part; a collection
    # at every 2 kB, though, would take longer than the start itself.
    gc.threshold(4096)
    try:
        robot = _build(path)
    except (ValueError, OSError) as error:
        print("gapseeker: cannot start:", error)
        raise
    unload("core.start")
    gc.threshold(-1)  # from now on the loop allocates nothing
    return robot


def _build(path):
    from core import devices

    devices.clock()  # all the rest takes two thirds of the time then
    values = _load(path)
    enable = devices.silence(values)  # whatever the chips did before a restart: motors and servos are off while the rest is made
    config = _checked(values)  # everything depends on it, and a mistake in it must be told before anything moves
    values = None
    once = config.once
    wlan, remark = devices.radio(config)  # its memory must be there before the heap grows; it joins the network meanwhile
    lidar_line, screen_line = devices.uarts(once)  # the drivers' buffers come from the same memory
    servos, left, right, enable = devices.chips(once, enable)
    motor, button, adc, doubt = devices.inputs(once)
    devices = None
    unload("core.devices", "link.wifi")
    for name in _MACHINE_CODE:  # as early, and it is the largest part
        __import__(name)
    avoid = _avoid(config)  # its tables are the largest objects: they come while the heap is still in one piece
    drive = _drive(config, servos, left, right, enable)
    link = _link(config, wlan, remark)
    if doubt:
        link.log(1, doubt)
    robot = _robot(config, avoid, drive, link, _lidar(config, lidar_line, motor), button, adc, screen_line)
    config.once = None
    return robot


def _load(path):
    from params.parse import load

    return load(path)


def _checked(values):
    from params.config import Config

    return Config(values)


def _avoid(config):
    from avoid import Avoid

    return Avoid(config)


def _drive(config, servos, left, right, enable):
    """Everything that moves is off until the first decision."""
    from actuation.drive import Drive
    from core.axles import lay_out

    once = config.once
    axles = lay_out(once["axles_spacings"], once["axles_track"], once["axles_first"])
    drive = Drive(axles, servos, left, right, enable, config)
    lay_out = None
    unload("actuation.wiring", "core.axles")
    return drive


def _link(config, wlan, remark):
    import machine

    from link.start import start_link

    link = start_link(config, machine, wlan, remark)
    start_link = None
    unload("link.start", "core.version")
    return link


def _lidar(config, line, motor):
    from lidar import Lidar

    return Lidar(line, motor, config)


def _trust(config):
    from perception.scan_trust import ScanTrust

    trust = ScanTrust(config)
    unload("perception.build")
    return trust


def _robot(config, avoid, drive, link, lidar, button, adc, screen_line):
    """The robot, with what it shows."""
    from robot import Robot
    from safety.health import Health

    health = Health(lidar, drive, button, adc, config)
    screen = None
    if screen_line is not None:
        from link.screen import Screen

        screen = Screen(screen_line, config.screen_kind, config.screen_baud)
        unload("link.reason_texts", "link.screen_dialects")
    return Robot(config, avoid, lidar, drive, health, link, screen, _trust(config))
