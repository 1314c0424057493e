"""robot.json -> the attributes of a `Config`. Every complaint names the key, its value and what is allowed.

Needed at the start only. Keys are texts that go with it; names, as of functions and attributes, stay in the board's table of names for ever.
"""

import io
import json
import os
from array import array

from micropython import const

from params import schema
from params.values import ConfigError, attribute, disorder, key_of, number, refuse

_LARGEST = const(16384)

# What the loop asks for besides the live parameters
STAY = ("servos_trims", "servos_low", "servos_high", "motors_full_speed", "battery_divider1000")


def load(path="robot.json"):
    """The values in the file. OSError if it cannot be read, ConfigError as in read()."""
    if os.stat(path)[6] > _LARGEST:
        raise ConfigError("robot.json is larger than %d bytes: no settings need so many" % _LARGEST)
    with open(path) as file:
        try:
            text = file.read()
        except UnicodeError:
            raise ConfigError("robot.json is not text in UTF-8: write it again, or save it as UTF-8")
    return read(text)


def read(text):
    """The values in the text of robot.json, nested dicts. ConfigError, with the line, where it is not JSON."""
    stream = io.StringIO(text)
    try:
        values = json.load(stream)
    except (ValueError, RuntimeError) as error:  # RuntimeError: nested too deep
        # CPython counts the lines, MicroPython leaves the stream where it stopped reading.
        line = getattr(error, "lineno", 0) or 1 + text[: max(stream.tell() - 1, 0)].count("\n")
        raise ConfigError("robot.json is not JSON: look for a missing comma, quote or bracket in line %d or just before" % line)
    if type(values) is not dict or not values:
        raise ConfigError("robot.json must hold one object, { ... }, with settings in it")
    key = _doubled(text.encode())
    if key:
        raise ConfigError("robot.json has %s twice: which is meant? Take one out" % key.decode())
    return values


def _doubled(text):
    """The first key that an object of the JSON has twice, or None: json takes the last of them without a word. In bytes: each letter looked at
    would be a name for ever."""
    objects = []  # the keys of each that has begun
    at = 0
    while True:
        start = text.find(b'"', at)
        between = text[at:] if start < 0 else text[at:start]
        for bracket in between:
            if bracket in b"{[":
                objects.append([])
            elif bracket in b"}]":
                objects.pop()
        if start < 0:
            return None
        at = start + 1
        while text[at] != 34:  # the closing quote, and no escaped one
            at += 2 if text[at] == 92 else 1
        at += 1
        after = at
        while text[after] in b" \n\r\t":
            after += 1
        if text[after] == 58:  # a colon
            key = text[start:at]
            if key in objects[-1]:
                return key
            objects[-1].append(key)


def fill(config, values):
    """Set every attribute of the config from the values (nested dicts) or the defaults."""
    given = _flat(values)
    once = config.once = {}
    for row in schema.rows(schema.BOOT):
        key = row[0]
        value = _value(config, row, given.pop(key)) if key in given else _default(config, row)
        name = attribute(key) + _scale(row)[1]
        if name in STAY:
            setattr(config, name, value)
        else:
            once[name] = value
        if row[1] == "spacings":
            config.axles = len(value) + 1
    live = []
    limits = []
    for key, _, default, low, high, unit, _ in schema.rows(schema.LIVE):
        value = given.pop(key, default)
        if value is None and default is None:
            value = _by_length(key, once["robot_length"])
        setattr(config, attribute(key), number(key, value, low, high, unit, 1, False))
        # The very text under which the attribute is kept: an equal one would take room beside it for good.
        live += [name for name in config.__dict__ if name == attribute(key)]
        limits += low, high
    config.live = tuple(live)
    config.limits = array("h", limits)
    for key in given:
        _unknown(key, given[key])
    _together(config, once)


def _scale(row):
    return schema.SCALES[row[5]] if row[5] in schema.SCALES else (1, "")


def _default(config, row):
    key, kind, value = row[:3]
    if value is not None or kind == "pin":
        return _value(config, row, value)
    if key == "axles.first":
        return sum(config.axles_spacings) / 2
    step = 2 if kind == "pairs" else 1
    return array("h", [k * step for k in range(_length(config, kind))])


def _by_length(key, length):
    """Default of a live parameter that goes with the body: what is known of the surroundings gets coarser with it, and its ends swing farther."""
    if key == "windows.look_ahead":
        return length * 3 // 2
    return max(length * 3 // 200, 9) if key == "avoid.margin" else max(length // 20, 30)


def _length(config, kind):
    return config.axles if kind == "pairs" else 2 * config.axles


def _value(config, row, value):
    """The value of a row as the attribute holds it."""
    key, kind, _, low, high, unit, _ = row
    if kind in ("wheels", "signs", "pairs"):
        return _list(config, row, value)
    if kind == "spacings":
        most = schema.MAX_AXLES
        if type(value) not in (list, tuple) or not 1 <= len(value) < most:
            needed = "a list of 1 .. %d numbers is needed (%d axles at most: two wheels on each, 16 channels on a chip)"
            refuse(key, value, needed % (most - 1, most))
        return tuple([number(key, one, low, high, unit, 1, False) for one in value])
    if kind == "sectors":
        if type(value) not in (list, tuple) or len(value) > 8:
            refuse(key, value, "a list of up to 8 sectors [from, to] is needed")
        for one in value:
            pair = type(one) in (list, tuple) and len(one) == 2 and type(one[0]) is int and type(one[1]) is int
            if not pair or not low <= one[0] < one[1] <= high:
                refuse(key, one, "[from, to] is needed, degrees %d .. %d, clockwise" % (low, high))
        return tuple([edge for one in value for edge in one])
    if kind == "flag":
        if type(value) is not bool:
            refuse(key, value, "true or false is needed")
        return value
    if kind == "choice":
        if value not in low:
            refuse(key, value, "allowed: " + ", ".join(low))
        return value
    if kind == "text":
        if type(value) is not str or len(value) > high:
            refuse(key, value, "a text of at most %d characters is needed" % high)
        if key == "wifi.password" and 0 < len(value) < 8:
            refuse(key, "*" * len(value), "8 to 63 characters, or none for an open network")
        return value
    if kind == "pin":
        taken = schema.USB_PINS + schema.FLASH_PINS
        if value is None and key in ("lidar.rx", "i2c.scl", "i2c.sda"):  # nothing drives without
            refuse(key, value, "a GPIO is needed")
        if value is not None and (type(value) is not int or not low <= value <= high or value in taken):
            refuse(key, value, "null or a GPIO %d .. %d is needed, not 1, 3 (USB) or 6 .. 11 (flash)" % (low, high))
        return value
    if kind == "address":
        return _address(row, value)
    return number(key, value, low, high, unit, _scale(row)[0], kind == "number")


def _list(config, row, value):
    key, kind, _, low, high, unit, _ = row
    length = _length(config, kind)
    if type(value) not in (list, tuple):
        value = [value] * length
    if len(value) != length:
        what = "axle" if kind == "pairs" else "wheel"
        refuse(key, value, "%d values are needed, one for each %s, not %d" % (length, what, len(value)))
    if kind == "signs":
        for one in value:
            if one not in (1, -1):
                refuse(key, one, "1 or -1 is needed")
        return array("h", value)
    return array("h", [number(key, one, low, high, unit, _scale(row)[0], False) for one in value])


def _address(row, value):
    key, _, _, low, high, _, _ = row
    address = value
    if type(value) is str:
        try:
            address = int(value, 0)
        except ValueError:
            address = None
    if type(address) is not int or not int(low, 0) <= address <= int(high, 0) or address == 0x70:
        refuse(key, value, "an address %s .. %s but not 0x70 is needed" % (low, high))
    return address


def _together(config, once):
    """What no single value tells: whether they go together."""
    spacings = once["axles_spacings"]
    if sum(spacings) > once["robot_length"]:
        refuse("axles.spacings", list(spacings), "the sum must not exceed robot.length = %d mm" % once["robot_length"])
    if once["axles_track"] > once["robot_width"]:
        refuse("axles.track", once["axles_track"], "it must not exceed robot.width = %d mm" % once["robot_width"])
    # What is remembered reaches 1.75 body lengths: a lidar that reads nothing nearer than that is a blind one.
    for most, what in ((once["lidar_far"], "lidar.far"), (once["robot_length"] * 7 // 4, "1.75 robot.length")):
        if once["lidar_near"] >= most:
            refuse("lidar.near", once["lidar_near"], "it must be less than %s = %d mm, or nothing is seen" % (what, most))
    _distinct("servos.channels", once["servos_channels"], 1)
    _distinct("motors.channels", once["motors_channels"], 2)
    chips = ("servos.address", "motors.left", "motors.right")
    for k in range(3):
        address = once[attribute(chips[k])]
        for other in chips[:k]:
            if once[attribute(other)] == address:
                refuse(chips[k], "0x%02x" % address, "already the address of %s" % other)
    names = "lidar_rx lidar_motor_pin i2c_scl i2c_sda pins_output_enable pins_servo_enable pins_stop_button pins_battery"
    if once["screen_kind"] != "none":
        names += " screen_tx screen_rx"
        if once["screen_uart"] == once["lidar_uart"]:
            refuse("screen.uart", once["screen_uart"], "already the UART of the lidar")
    owners = {}
    for name in names.split(" "):
        pin = once[name]
        if pin is not None and pin in owners:
            refuse(key_of(name), pin, "already the pin of %s" % key_of(owners[pin]))
        owners[pin] = name
    pair = disorder(config)
    if pair:
        low, high = pair
        refuse(key_of(low), getattr(config, low), "it must not exceed %s = %d" % (key_of(high), getattr(config, high)))


def _flat(values):
    """{group: {name: value}} -> {"group.name": value}."""
    if type(values) is not dict:
        raise ConfigError("robot.json must hold one object, { ... }")
    flat = {}
    for group, content in values.items():
        if type(content) is dict and (content or group != "mode"):
            for key, value in content.items():
                flat["%s.%s" % (group, key)] = value
        else:
            flat[group] = content
    return flat


def _unknown(key, value):
    group = key.split(".")[0]
    groups = []
    names = []
    for row in schema.rows(schema.BOOT, schema.LIVE):
        first, _, name = row[0].partition(".")
        if first not in groups:
            groups.append(first)
        if first == group:
            names.append(name)
    if not names:
        raise ConfigError("unknown key %s: robot.json has %s" % (group, ", ".join(groups)))
    if key == group:
        refuse(key, value, "an object is needed, { ... }")
    raise ConfigError("unknown key %s: %s has %s" % (key, group, ", ".join(names)))


def _distinct(key, channels, width):
    taken = {}
    for channel in channels:
        for output in range(channel, channel + width):
            if output in taken or output > 15:
                refuse(key, list(channels), "output %d is used twice" % output if output in taken else "outputs end at 15")
            taken[output] = True
