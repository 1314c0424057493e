"""arm.json -> an Armed in the place of the Drive's Outputs. Needed once, at the start: then it is unloaded. What it may say is in docs/arm.md."""

import json
import os
from array import array
from time import ticks_us

from micropython import const

from actuation.wiring import counts
from arm.armed import Armed
from core.crc16 import crc16

_LARGEST = const(8192)  # bytes of arm.json
_MOST = const(12)
_FAR = const(320)  # deg: set points are 0.01 deg in 16 bits
_FAST = const(3000)  # deg/s


def add(config, drive, link, chips, enable, own):
    """Give the robot its arm. chips: (servos, left, right); enable, own: output enable of all, and of the servos alone, Pins or None. ValueError names what is wrong."""
    if os.stat("arm.json")[6] > _LARGEST:
        refuse("it is larger than %d bytes" % _LARGEST)
    try:
        with open("arm.json") as file:
            values = json.load(file)
    except (ValueError, RuntimeError):
        refuse("it is not JSON, or cut off: put it on the board again")
    armed = Armed(chips[0], chips[1], chips[2], enable, config)
    _take(armed, values, list(config.once["servos_channels"]), config.servos_oscillator, chips[0].prescale)
    _begin(armed, link, chips[0], own, values.get("while_driving") is True)
    drive.outputs = armed
    link.arm = armed
    link.stop = armed.stop
    link.again = armed.again
    return armed


def _begin(self, link, servo, own, while_driving):
    """The fields of an Armed that stands still, without power."""
    self.link = link
    self._link_stop = link.stop  # the bound methods: the names of classes are let go after the start
    self._link_again = link.again
    self.servo = servo
    self._own = own
    self.while_driving = while_driving
    self.state = self.why = self.woken = 0
    self.heard_us = self.began_us = self._told_us = ticks_us()
    self.file = None
    self._kept = self._own_on = False


def refuse(words):
    raise ValueError("arm.json: " + words)


def _take(self, values, wheels, oscillator, prescale):
    """The fields that come from arm.json. wheels: channels that are theirs."""
    servos = values.get("servos") if type(values) is dict else None
    joints = values.get("joints", []) if servos else []
    rows = joints + values.get("extra", []) if type(joints) is list else []
    count = len(rows)
    if type(servos) is not dict or not 1 <= count <= _MOST:
        refuse("joints, 1 .. %d with extra, and servos are needed" % _MOST)
    channels = _numbers(servos, "channels", count, None, 0, 15)
    free = [k for k in range(16) if k not in wheels]
    for k in range(count):
        if channels[k] in wheels:
            refuse("servos.channels: output %d of the servos' chip is a wheel's; free are %s" % (channels[k], ", ".join([str(one) for one in free]) or "none"))
        if channels[k] in channels[:k] or channels[k] != int(channels[k]):
            refuse("servos.channels: whole numbers, each once, are needed")
    zeros = _numbers(servos, "zeros_deg", count, 0, -_FAR, _FAR)
    directions = _numbers(servos, "directions", count, 1, -1, 1)
    rest = _numbers(servos, "rest_deg", count, None, -_FAR, _FAR)
    low_us, high_us = (_number(servos.get(key, default), key, 300, 2700) for key, default in (("pulse_low_us", 500), ("pulse_high_us", 2500)))
    span = _number(servos.get("range_deg", 180), "range_deg", 20, 720)
    if high_us - low_us < 100:
        refuse("servos: pulse_high_us must lie 100 above pulse_low_us")
    self.angles = array("h", [round(100 * one) for one in rest])
    self.rest = array("h", self.angles)
    self.before = array("h", bytes(2 + 4 * count))
    self.after = array("h", self.before)
    self.limits = array("h")
    self._lines_of_arm = array("i")
    self._pulse = bytearray(5)
    self.sent = array("h", bytes(2 * count))
    middle = counts(round((low_us + high_us) / 2), prescale, oscillator, 32768)
    slope = counts(round(high_us - low_us), prescale, oscillator, 32768) / (100 * span)
    for k in range(count):
        row = rows[k]
        if type(row) is not dict:
            refuse("joints and extra: an object each, { ... }, is needed")
        low, high = (_number(row.get(key), key, -_FAR, _FAR) for key in ("low_deg", "high_deg"))
        if low >= high or low < zeros[k] - span / 2 - 0.001 or high > zeros[k] + span / 2 + 0.001 or not low <= rest[k] <= high:
            refuse("joint %d: low_deg < high_deg, both within its servo's range, and rest_deg between them are needed" % (k + 1))
        self.limits.extend(array("h", [round(100 * low), round(100 * high), round(10 * _number(row.get("speed_deg_s"), "speed_deg_s", 1, _FAST))]))
        gain = round(slope) * (1 if directions[k] > 0 else -1)
        self._lines_of_arm.extend(array("i", [middle + 16384 - round(100 * zeros[k]) * gain, gain, 6 + 4 * int(channels[k])]))
    self.ident = ident(values.get("name", "arm"), self.limits)


def ident(name, limits):
    """What tells an arm from another: a trajectory for other limits is none for this one."""
    data = str(name).encode()
    for value in limits:
        data += bytes((value & 255, value >> 8 & 255))
    return crc16(data, 0, len(data))


def _numbers(values, key, count, default, low, high):
    found = values.get(key, None if default is None else [default] * count)
    if type(found) is not list or len(found) != count:
        refuse("servos.%s: a list of %d numbers is needed" % (key, count))
    return [_number(one, "servos." + key, low, high) for one in found]


def _number(value, key, low, high):
    if type(value) not in (int, float) or not low <= value <= high:
        refuse("%s = %s: a number %s .. %s is needed" % (key, json.dumps(value), low, high))
    return value
