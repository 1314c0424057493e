"""Builds the robot from robot.json. Needed once: main.py holds the robot, and everything in here is let go again.

The order of build() is a rule, because three things share one memory: the heap, which takes more of it whenever it is full and gives nothing
back; machine code, which has to lie in a part of it; and the drivers of radio and UARTs. Whoever needs a large piece asks before the heap grows.
"""

import gc
import os
import sys

from micropython import const

from core.unload import forget, unload

_POWER_ON = const(1)  # of machine.reset_cause()
_WDT_RESET = const(3)
_GOOD = const(".good")
_BLOCK = const(64)

_TABLES_MADE = const("tables made")  # as in planner/tables.py
_THIS = const("core/start.mpy")
_IMPORT_ONLY = const("__file__ __name__ const")  # what modules need for their import, and never again

# What holds machine code, and stays: each with what it imports.
_MACHINE_CODE = (
    "link.telemetry", "actuation.drive", "lidar", "perception.local_map", "planner.collision", "planner.cost_to_go", "planner.move_cost", "perception.windows",
    "perception.scan_trust",
)  # fmt: skip


def build(note=None, path="robot.json"):
    """The Robot. In doubt nothing moves: what is wrong is printed on the USB line and raised (ValueError, OSError).

    note: what the life before this one left, see safety/watchdog.py; None after power was switched on.
    """
    # Garbage between the things that stay would cut the heap to pieces, and make it grow before the others have had their part; a collection
    # at every 2 kB, though, would take longer than the start itself.
    gc.threshold(4096)
    try:
        robot = _build(path, note)
    except (ValueError, OSError) as error:
        print("gapseeker: cannot start:", error)
        if _same(path + _GOOD, path + _GOOD):
            print("gapseeker: the file of the last good start is kept as %s: copy it over %s to go back" % (path + _GOOD, path))
        raise
    _keep(path)
    forget("core.start", "safety.first")
    _trim()
    gc.threshold(-1)  # from now on the loop allocates nothing
    _watch(robot)
    return robot


def _build(path, note):
    from core import devices

    devices.clock()  # all the rest takes two thirds of the time then
    values = _load(path)
    config = _checked(values)  # everything depends on it, and a mistake in it must be told before anything moves
    values = None
    once = config.once
    wlan, remark = devices.radio(config)  # its memory must be there before the heap grows; it joins the network meanwhile
    lidar_line, screen_line = devices.uarts(once)  # the drivers' buffers come from the same memory
    servos, left, right, enable = devices.chips(once)
    own = devices.servo_enable(once)
    motor, button, adc, doubt = devices.inputs(once)
    devices = None
    forget("core.devices", "link.wifi")
    for name in _MACHINE_CODE + ("link.screen_kernels",) * (screen_line is not None):  # as early, and it is the largest part
        __import__(name)
    screen = None if screen_line is None else _screen(config, screen_line)
    world = _map()
    avoid = _avoid(config)  # its tables are the largest objects: they come while the heap is still in one piece
    drive = _drive(config, servos, left, right, enable)
    lidar = _lidar(config, lidar_line, motor)
    safety, health, remarks = _safety(config, lidar, drive, button, adc, note)
    if screen is not None:
        _trim(("actuation", "avoid", "lidar", "planner", "steering"))  # as what comes now needs room of its own while it is made
    link = _link(config, safety, wlan, remark)
    if screen is not None:
        _trim(("link",))
    if _TABLES_MADE in once:
        remarks.append("tables.bin was missing, or for another robot.json: making its tables took seconds of this start; make deploy puts it on the board")
    for remark in remarks + [doubt] * bool(doubt):
        link.log(1, remark)
    robot = _robot(config, avoid, lidar, drive, safety, health, link, screen, _goal(config, avoid, world))
    _arm(config, drive, link, (servos, left, right), enable, own)
    config.once = None
    return robot


def _trim(parts=()):
    """Let go of what the robot was made with, on the board only: the constructors, each part having been made, and the names of what only imports
    needed. The tables of names are emptied for it, as a dict gives room back only then. parts: those that have been made; () = all."""
    if sys.implementation.name == "micropython":
        gone = _IMPORT_ONLY.split(" ")
        lib = __file__[: -len(_THIS)]
        ours = [name for name, module in sys.modules.items() if module.__dict__.get("__file__", "").startswith(lib)]
        if parts:
            for name in ours:
                if name.split(".")[0] in parts:
                    for thing in sys.modules[name].__dict__.values():
                        _was_class(thing, ours)
            return
        for name, module in sys.modules.items():
            names = module.__dict__
            if "__path__" in names:  # a package: its modules are found without it, but later imports need its own names
                _shrink(names, [item for item in names.items() if type(item[1]) is not type(sys)])
            elif name in ours:
                _shrink(names, [item for item in names.items() if item[0] not in gone and not _was_class(item[1], ours)])
        _shrink(sys.modules, list(sys.modules.items()))


def _was_class(thing, ours):
    """Whether it is a class of one of our modules; it has no constructor from now on."""
    if type(thing) is not type or getattr(thing, "__module__", None) not in ours:
        return False
    try:
        del thing.__init__
        thing.__init__ = None  # in its place in the table: deleting alone does not let go of it
    except AttributeError:
        pass
    return True


def _shrink(table, kept):
    table.clear()
    table.update(kept)


def _watch(robot):
    import machine

    from safety.watchdog import begin

    begin(robot, machine)
    begin = None
    forget("safety.watchdog", "safety.survive")


def _keep(path):
    """Copy the robot.json by which the robot could be built, where it is another than before."""
    if _same(path, path + _GOOD):
        return
    block = bytearray(_BLOCK)
    try:
        with open(path, "rb") as source, open(path + _GOOD, "wb") as target:
            while count := source.readinto(block):
                target.write(memoryview(block)[:count])
    except OSError:
        pass  # a full disk keeps nobody from driving


def _same(one, other):
    """True if there are both files, and they are equal."""
    first, second = bytearray(_BLOCK), bytearray(_BLOCK)
    try:
        with open(one, "rb") as a, open(other, "rb") as b:
            count = 1
            while count:
                count = a.readinto(first)
                if b.readinto(second) != count or first != second:
                    return False
    except OSError:
        return False
    return True


def _load(path):
    from params.parse import load

    return load(path)


def _checked(values):
    from params.config import Config

    return Config(values)


def _map():
    """What goal.build.load() gives; None where there is no map. Its machine code comes with the other."""

    try:
        os.stat("map.bin")
    except OSError:
        return None
    from goal import build

    return build.load()


def _goal(config, avoid, world):
    if world is None:
        return None
    from goal import build

    goal = build.build(config, avoid, world)
    build = None
    forget("goal.build")
    return goal


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
    forget("actuation.wiring", "core.axles")
    return drive


def _link(config, safety, wlan, remark):
    import machine

    from link.start import start_link

    link = start_link(config, machine, safety, wlan, remark)
    start_link = None
    forget("link.start", "core.version")
    return link


def _lidar(config, line, motor):
    from lidar import Lidar

    return Lidar(line, motor, config)


def _trust(config):
    from perception.scan_trust import ScanTrust

    trust = ScanTrust(config)
    forget("perception.build")
    return trust


def _safety(config, lidar, drive, button, adc, note):
    """(Safety, Health, what is to be said). After any reset but the one by power it stands, and says what it knows of the reason."""
    import machine

    from safety.health import Health
    from safety.safety import Safety
    from safety.stop_button import StopButton

    once = config.once
    cause = machine.reset_cause()
    hung = cause == _WDT_RESET
    remarks = []
    if hung:
        from safety.survive import PARTS

        part = note[2] if note else 0
        remarks.append("the watchdog has reset the board; at work was: " + PARTS[part if part < len(PARTS) else 0])
    elif note is not None or cause != _POWER_ON:
        remarks.append("restarted without a wish to: its power may have dipped" if cause == _POWER_ON else "restarted")
    elif once["drive_autostart"]:
        from safety.remember import stopped

        if stopped():
            remarks.append("told to stop before its power went: it waits for a start")
    stands = remarks or not once["drive_autostart"]
    if button is not None:
        button = StopButton(button, once["pins_stop_closed"])
    health = Health(drive, adc, config)
    safety = Safety(lidar, drive, health, button, _trust(config), not stands, hung)
    return safety, health, remarks


def _arm(config, drive, link, chips, enable, own):
    """Where the board has an arm.json: the arm's servos beside those of the wheels."""
    try:
        os.stat("arm.json")
    except OSError:
        if own is not None:
            raise ValueError("pins.servo_enable is for a robot with an arm: put arm.json on the board, or set it to null")
        return
    from arm.build import add

    add(config, drive, link, chips, enable, own)
    forget("arm.build", "actuation.wiring")


def _screen(config, line):
    """Made while the heap is small: its texts are put together from more than stays."""
    from link.screen import Screen

    screen = Screen(line, config.screen_kind, config.screen_baud, config)
    unload("link.screen_build")
    return screen


def _robot(config, avoid, lidar, drive, safety, health, link, screen, goal):
    """The robot, with what it shows."""
    from robot import Robot

    robot = Robot(config, avoid, lidar, drive, safety, health, link, screen, goal)
    if config.once["drive_autostart"]:
        from safety.remember import Remember

        robot.remember = Remember()
    return robot
