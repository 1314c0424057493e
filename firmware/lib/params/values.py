"""What is said of a value that cannot be used; for robot.json at the start, and for tuning."""

import json


class ConfigError(ValueError):
    """A value of robot.json, or one that a person sent, that the robot cannot use."""


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


# Attributes of which the first must not exceed the second
_ORDER = (("windows_red", "windows_blue"), ("avoid_margin", "avoid_soft_margin"), ("battery_empty", "battery_low"))


def disorder(config):
    """The first two parameters that contradict one another, or None."""
    for pair in _ORDER:
        if getattr(config, pair[0]) > getattr(config, pair[1]):
            return pair
    return None
