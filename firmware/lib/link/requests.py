"""Commands that are given now and then: change a parameter, keep, point a wheel, restart. Loaded when the first comes, let go after."""

import json
import struct

from micropython import const

from core.unload import forget
from params.settings import Settings

forget("params.settings")  # what has been taken from it stays

_TUNE = const(0x42)
_KEEP = const(0x43)
_POINT = const(0x46)
_RESTART = const(0x48)
_GO = const(0x49)
_AUTO = const(1)
_MANUAL = const(2)


def carry_out(link, kind, payload, robot, driven):
    """Do what the command asks; returns the text of its REPLY. ValueError when it cannot be done, with a text for the person.

    payload: without the tag; the counter is its first 4 bytes. link: the Link. driven: whether the motors were on when
    the command came.
    """
    if kind >= _GO:
        from goal.orders import obey

        forget("goal.orders")
        return obey(robot, kind, payload)
    if kind == _POINT:
        link.stop()  # whoever turns wheels does not want it to drive
    if kind == _POINT and driven or kind == _RESTART and robot.drive.v256:
        raise ValueError("it must stand for that: stop it first")
    settings = Settings(link.config, robot.drive, link.changed)
    if kind == _TUNE:
        return _tune(settings, bytes(payload[4:]).decode())
    if kind == _KEEP:
        settings.keep()
    elif kind == _POINT:
        if len(payload) < 7:
            raise ValueError("%d bytes are too few" % len(payload))
        settings.point(*struct.unpack_from("<Bh", payload, 4))
    elif kind == _RESTART:
        link.stop()
        link.restarting = True
    return ""


def refuse_to_drive(payload):
    """Raise a ValueError that says what is wrong with a DRIVE."""
    if len(payload) < 10:
        raise ValueError("%d bytes are too few" % len(payload))
    what, af, ar, v = struct.unpack_from("<BhhB", payload, 4)
    if what == _AUTO:
        raise ValueError("the stop button is pressed: let it go first")
    if what != _MANUAL:
        raise ValueError("drive %d: 0 stop, 1 auto, 2 manual" % what)
    if -900 <= af <= 900 and -900 <= ar <= 900 and v <= 180:
        raise ValueError("stopped, or somebody else drives it: let go for a moment, also of the stop button, then drive on")
    raise ValueError("AF %d, AR %d (0.1 deg, up to 900 either way), V %d (0 to 180)" % (af, ar, v))


def _tune(settings, text):
    key, equals, value = text.partition("=")
    if not equals:
        raise ValueError("write key=value")
    try:
        value = json.loads(value)
    except ValueError:
        raise ValueError("%s: %s is no value as in JSON" % (key, value)) from None
    return settings.tune(key.strip(), value)


def restart(robot):
    """Restart; nothing must turn meanwhile. Does not return on the board."""
    import machine

    robot.off()
    machine.reset()
