"""The parameters of the robot while it runs. What robot.json may say is checked by config_checks.py, at the start only."""

import json

from core.unload import unload

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
    from params.parse import read

    return Config(read(text))


class Config:
    """All parameters as attributes: key lidar.baud is config.lidar_baud.

    values: what robot.json holds, as nested dicts; a missing key takes its default. ConfigError names the key that is wrong.

    Lengths are mm, angles 0.1 deg (degrees in the file), and the attributes of other units are told by schema.SCALES. Per-wheel values are
    array('h') in the order axle 1 left, axle 1 right, ...; everything the loop reads is an int.

    axles       number of axles
    live        attribute of each parameter that may change while the robot runs, in the order of schema.LIVE
    limits      array 'h', its low and high one after the other; units: its unit
    changes     counter of such changes, for those who keep something computed from a parameter
    """

    def __init__(self, values=None):
        # Table and checks are large and are let go at the end: the board keeps the values and what tuning needs.
        from params.parse import fill

        self.changes = 0
        self.live = self.units = ()
        fill(self, {} if values is None else values)
        unload("params.parse", "params.schema")

    def get(self, key):
        """The value of a key, as its attribute holds it. ConfigError if there is no such key."""
        for unit in ("", "20", "1000"):  # those of schema.SCALES
            name = attribute(key) + unit
            if hasattr(self, name):
                return getattr(self, name)
        raise ConfigError("unknown key %s" % key)

    def set(self, key, value):
        """Change a live parameter (value: int), or one wheel's trim, "servos.trims.0" and so on (value: degrees).

        ConfigError, and nothing changed, if it is neither or the value is not allowed.
        """
        if key.startswith("servos.trims."):
            self._trim(key, value)
            return
        index = self._index(key)
        if index < 0:
            raise ConfigError("%s cannot change while the robot runs: edit robot.json and restart" % key)
        low, high = self.limits[2 * index], self.limits[2 * index + 1]
        if not self.tune(index, number(key, value, low, high, self.units[index], 1, False)):
            pairs = ["%s <= %s" % (key_of(one), key_of(other)) for one, other in _ORDER if self.live[index] in (one, other)]
            refuse(key, value, "%s must hold" % " and ".join(pairs))

    def tune(self, index, value):
        """As set(), by its number in `live`: True if the int `value` was taken. Allocates nothing."""
        if not 0 <= index < len(self.live):
            return False
        if not self.limits[2 * index] <= value <= self.limits[2 * index + 1]:
            return False
        name = self.live[index]
        before = getattr(self, name)
        setattr(self, name, value)
        if self.disorder():
            setattr(self, name, before)
            return False
        self.changes += 1
        return True

    def _trim(self, key, value):
        wheels = ["servos.trims.%d" % k for k in range(2 * self.axles)]
        if key not in wheels:
            refuse(key, value, "the wheels are %s .. %s" % (wheels[0], wheels[-1]))
        self.servos_trims[wheels.index(key)] = number(key, value, -20, 20, "deg", 10, False)
        self.changes += 1

    def _index(self, key):
        name = attribute(key)
        return self.live.index(name) if name in self.live else -1

    def disorder(self):
        """The first two parameters that contradict one another, or None."""
        for pair in _ORDER:
            if getattr(self, pair[0]) > getattr(self, pair[1]):
                return pair
        return None


def attribute(key):
    """The attribute of a key, but for its unit."""
    return key.replace(".", "_")


def key_of(name):
    """The key of an attribute."""
    return name.replace("_", ".", 1)


def refuse(key, value, needed):
    """Raise a ConfigError that says what is needed."""
    raise ConfigError("%s = %s: %s" % (key, json.dumps(value), needed))


def number(key, value, low, high, unit, factor, fraction):
    """The value times factor, as an int; as it is where a fraction is wanted. ConfigError if it is no number within low .. high."""
    good = type(value) in (int, float) and low <= value <= high
    if good and not fraction and factor == 1:
        good = value == int(value)
    if not good:
        what = "a number" if fraction or factor > 1 else "a whole number"
        refuse(key, value, ("%s %s .. %s %s" % (what, low, high, unit)).rstrip() + " is needed")
    if fraction:
        return value
    return round(value * factor)
