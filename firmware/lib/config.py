"""robot.json -> a checked Config. Every complaint names the key, its value and what is allowed."""

import io
import json
import sys
from array import array

_TRIMS = "servos.trims."
_UNIT_SUFFIXES = ("", "20", "1000")  # those of schema.SCALES

# Attributes of which the first must not exceed the second
_ORDER = (("windows_red", "windows_blue"), ("avoid_margin", "avoid_soft_margin"), ("battery_empty", "battery_low"))

class ConfigError(ValueError):
    """A value of robot.json, or one sent to `Config.set`, that the robot cannot use."""


def load(path="robot.json"):
    """Config from a file. OSError if it cannot be read, ConfigError if its content is no good."""
    with open(path) as file:
        return parse(file.read())


def parse(text):
    """Config from the text of robot.json. ConfigError, with the line, where it is not JSON."""
    stream = io.StringIO(text)
    try:
        values = json.load(stream)
    except ValueError as error:
        # CPython counts the lines, MicroPython leaves the stream where it stopped reading.
        line = getattr(error, "lineno", 0) or 1 + text[: max(stream.tell() - 1, 0)].count("\n")
        raise ConfigError("robot.json is not JSON: look for a missing comma, quote or bracket in line %d or just before" % line)
    return Config(values)


class Config:
    """All parameters as attributes: key lidar.baud is config.lidar_baud.

    values: what robot.json holds, as nested dicts; a missing key takes its default. ConfigError names the key that is wrong.

    Lengths are mm, angles 0.1 deg (degrees in the file), and the attributes of other units are told by schema.SCALES. Per-wheel values are
    array('h') in the order axle 1 left, axle 1 right, ...; everything the loop reads is an int.

    axles       number of axles
    live        schema.LIVE: the parameters that may change while the robot runs
    changes     counter of such changes, for those who keep something computed from a parameter
    """

    def __init__(self, values=None):
        # The table is let go at the end: of its 10 kB only the live rows are needed again on the board.
        import schema

        given = _flatten({} if values is None else values)
        self.changes = 0
        self.live = schema.LIVE
        for row in schema.BOOT:
            key = row[0]
            value = self._checked(row, given.pop(key), schema) if key in given else self._default(row, schema)
            setattr(self, _attribute(key) + _scale(row, schema)[1], value)
            if key == "axles.spacings":
                self.axles = len(value) + 1
        self._names = []
        for row in schema.LIVE:
            self._names.append(_attribute(row[0]))
            setattr(self, self._names[-1], _live(row, given.pop(row[0], row[2])))
        for key in given:
            _unknown(key, given[key], schema.BOOT + schema.LIVE)
        self._check_body()
        self._check_chips()
        self._check_pins()
        self._check_order()
        if sys.implementation.name == "micropython":
            del sys.modules["schema"]

    def get(self, key):
        """The value of a key, as its attribute holds it. ConfigError if there is no such key."""
        for unit in _UNIT_SUFFIXES:
            name = _attribute(key) + unit
            if hasattr(self, name):
                return getattr(self, name)
        raise ConfigError("unknown key %s" % key)

    def set(self, key, value):
        """Change a live parameter (value: int), or one wheel's trim, "servos.trims.0" and so on (value: degrees).

        ConfigError, and nothing changed, if it is neither or the value is not allowed.
        """
        if key.startswith(_TRIMS):
            self._trim(key, value)
            return
        index = self._index(key)
        if index < 0:
            raise ConfigError("%s cannot change while the robot runs: edit robot.json and restart" % key)
        if not self.tune(index, _live(self.live[index], value)):
            pairs = ["%s <= %s" % (_key(one), _key(other)) for one, other in _ORDER if self._names[index] in (one, other)]
            _refuse(key, value, "%s must hold" % " and ".join(pairs))

    def tune(self, index, value):
        """As set(), by the number of the row in `live`: True if the int `value` was taken. Allocates nothing."""
        if not 0 <= index < len(self.live):
            return False
        row = self.live[index]
        if not row[3] <= value <= row[4]:
            return False
        name = self._names[index]
        before = getattr(self, name)
        setattr(self, name, value)
        if self._disorder():
            setattr(self, name, before)
            return False
        self.changes += 1
        return True

    def _trim(self, key, value):
        wheels = ["%s%d" % (_TRIMS, k) for k in range(2 * self.axles)]
        if key not in wheels:
            _refuse(key, value, "the wheels are %s .. %s" % (wheels[0], wheels[-1]))
        self.servos_trims[wheels.index(key)] = _number(key, value, -20, 20, "deg", 10, False)
        self.changes += 1

    def _index(self, key):
        for index, row in enumerate(self.live):
            if row[0] == key:
                return index
        return -1

    def _default(self, row, schema):
        key, kind, value = row[:3]
        if value is not None:
            return self._checked(row, value, schema)
        if key == "axles.first":
            return sum(self.axles_spacings) / 2
        if kind == "pin":
            return None
        step = 2 if kind == "pairs" else 1
        return array("h", [k * step for k in range(self._length(kind))])

    def _length(self, kind):
        return self.axles if kind == "pairs" else 2 * self.axles

    def _checked(self, row, value, schema):
        """The value of a row as the attribute holds it."""
        key, kind, _, low, high, unit, _ = row
        if kind in ("wheels", "signs", "pairs"):
            return self._list(row, value, schema)
        if kind == "spacings":
            return _spacings(row, value, schema.MAX_AXLES)
        if kind == "flag":
            if type(value) is not bool:
                _refuse(key, value, "true or false is needed")
            return value
        if kind == "choice":
            if value not in low:
                _refuse(key, value, "allowed: " + ", ".join(low))
            return value
        if kind == "text":
            if type(value) is not str or len(value) > high:
                _refuse(key, value, "a text of at most %d characters is needed" % high)
            return value
        if kind == "pin":
            taken = schema.USB_PINS + schema.FLASH_PINS
            if value is not None and (type(value) is not int or not low <= value <= high or value in taken):
                _refuse(key, value, "null or a GPIO %d .. %d is needed, not 1, 3 (USB) or 6 .. 11 (flash)" % (low, high))
            return value
        if kind == "address":
            return _address(row, value)
        return _number(key, value, low, high, unit, _scale(row, schema)[0], kind == "number")

    def _list(self, row, value, schema):
        key, kind, _, low, high, unit, _ = row
        length = self._length(kind)
        if type(value) not in (list, tuple):
            value = [value] * length
        if len(value) != length:
            what = "axle" if kind == "pairs" else "wheel"
            _refuse(key, value, "%d values are needed, one for each %s, not %d" % (length, what, len(value)))
        if kind == "signs":
            for one in value:
                if one not in (1, -1):
                    _refuse(key, one, "1 or -1 is needed")
            return array("h", value)
        return array("h", [_number(key, one, low, high, unit, _scale(row, schema)[0], False) for one in value])

    def _check_body(self):
        if sum(self.axles_spacings) > self.robot_length:
            _refuse("axles.spacings", list(self.axles_spacings), "the sum must not exceed robot.length = %d mm" % self.robot_length)
        if self.axles_track > self.robot_width:
            _refuse("axles.track", self.axles_track, "it must not exceed robot.width = %d mm" % self.robot_width)

    def _check_chips(self):
        _distinct("servos.channels", self.servos_channels, 1)
        _distinct("motors.channels", self.motors_channels, 2)
        chips = (("servos.address", self.servos_address), ("motors.left", self.motors_left), ("motors.right", self.motors_right))
        for k in range(3):
            for earlier in chips[:k]:
                if earlier[1] == chips[k][1]:
                    _refuse(chips[k][0], "0x%02x" % chips[k][1], "already the address of %s" % earlier[0])

    def _check_pins(self):
        names = ["lidar_rx", "lidar_motor_pin", "i2c_scl", "i2c_sda", "pins_output_enable", "pins_stop_button", "pins_battery"]
        if self.screen_kind != "none":
            names += ["screen_tx", "screen_rx"]
            if self.screen_uart == self.lidar_uart:
                _refuse("screen.uart", self.screen_uart, "already the UART of the lidar")
        owners = {}
        for name in names:
            pin = getattr(self, name)
            if pin is not None and pin in owners:
                _refuse(_key(name), pin, "already the pin of %s" % _key(owners[pin]))
            owners[pin] = name

    def _check_order(self):
        disorder = self._disorder()
        if disorder:
            low, high = disorder
            _refuse(_key(low), getattr(self, low), "it must not exceed %s = %d" % (_key(high), getattr(self, high)))

    def _disorder(self):
        """The first two parameters that contradict one another, or None."""
        for pair in _ORDER:
            if getattr(self, pair[0]) > getattr(self, pair[1]):
                return pair
        return None


def _scale(row, schema):
    return schema.SCALES[row[5]] if row[5] in schema.SCALES else (1, "")


def _live(row, value):
    return _number(row[0], value, row[3], row[4], row[5], 1, False)


def _attribute(key):
    return key.replace(".", "_")


def _key(attribute):
    return attribute.replace("_", ".", 1)


def _flatten(values):
    if type(values) is not dict:
        raise ConfigError("robot.json must hold one object, { ... }")
    flat = {}
    for group, content in values.items():
        if type(content) is dict:
            for key, value in content.items():
                flat["%s.%s" % (group, key)] = value
        else:
            flat[group] = content
    return flat


def _refuse(key, value, needed):
    raise ConfigError("%s = %s: %s" % (key, json.dumps(value), needed))


def _unknown(key, value, rows):
    group = key.split(".")[0]
    names = [row[0].split(".")[-1] for row in rows if row[0].split(".")[0] == group]
    if not names:
        names = []
        for row in rows:
            name = row[0].split(".")[0]
            if name not in names:
                names.append(name)
        raise ConfigError("unknown key %s: robot.json has %s" % (group, ", ".join(names)))
    if key == group:
        _refuse(key, value, "an object is needed, { ... }")
    raise ConfigError("unknown key %s: %s has %s" % (key, group, ", ".join(names)))


def _number(key, value, low, high, unit, factor, fraction):
    good = type(value) in (int, float) and low <= value <= high
    if good and not fraction and factor == 1:
        good = value == int(value)
    if not good:
        what = "a number" if fraction or factor > 1 else "a whole number"
        _refuse(key, value, ("%s %s .. %s %s" % (what, low, high, unit)).rstrip() + " is needed")
    if fraction:
        return value
    return round(value * factor)


def _spacings(row, value, most):
    key, _, _, low, high, unit, _ = row
    if type(value) not in (list, tuple) or not 1 <= len(value) < most:
        _refuse(key, value, "a list of 1 .. %d numbers is needed (%d axles at most: two wheels on each, 16 channels on a chip)" % (most - 1, most))
    return tuple([_number(key, one, low, high, unit, 1, False) for one in value])


def _address(row, value):
    key, _, _, low, high, _, _ = row
    number = value
    if type(value) is str:
        try:
            number = int(value, 0)
        except ValueError:
            number = None
    if type(number) is not int or not low <= number <= high or number == 0x70:
        _refuse(key, value, "an address 0x%02x .. 0x%02x but not 0x70 is needed" % (low, high))
    return number


def _distinct(key, channels, width):
    taken = {}
    for channel in channels:
        for output in range(channel, channel + width):
            if output in taken or output > 15:
                _refuse(key, list(channels), "output %d is used twice" % output if output in taken else "outputs end at 15")
            taken[output] = True
