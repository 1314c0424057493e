"""settings.py: changes that count at once and can be kept."""

import json
import os

from settings import Settings

PATH = "test_settings_robot.json"


class Config:
    axles = 2

    def __init__(self):
        self.values = {}

    def set(self, key, value):
        if value == 999:
            raise ValueError("%s = 999: 0 .. 100 is needed" % key)
        self.values[key] = value


class Drive:
    stands = True

    def point(self, wheel, angle):
        return self.stands


def keep(before, changes):
    """The file before with the changes kept: (its values, its text)."""
    with open(PATH, "w") as file:
        file.write(before)
    try:
        settings = Settings(Config(), Drive(), PATH)
        for key, value in changes:
            settings.tune(key, value)
        settings.keep()
        with open(PATH) as file:
            text = file.read()
    finally:
        os.remove(PATH)
    return json.loads(text), text


def refused(call, *arguments):
    """The text of the ValueError."""
    try:
        call(*arguments)
    except ValueError as error:
        return str(error)
    assert False, "not refused"


def test_only_what_was_changed_changes():
    values, text = keep('{"mode": "AWS", "avoid": {"margin": 15, "accept": 150}}', (("avoid.margin", 20), ("drive.cruise", 100)))
    assert values == {"mode": "AWS", "avoid": {"margin": 20, "accept": 150}, "drive": {"cruise": 100}}
    assert '    "margin": 20' in text.split("\n") or '    "margin": 20,' in text.split("\n")


def test_a_trim_of_one_wheel():
    values, _ = keep('{"servos": {"trims": [1, 2, 3, 4]}}', (("servos.trims.2", -5),))
    assert values == {"servos": {"trims": [1, 2, -5, 4]}}
    values, _ = keep('{"servos": {"trims": 2}}', (("servos.trims.0", 7),))
    assert values == {"servos": {"trims": [7, 2, 2, 2]}}
    values, _ = keep("{}", (("servos.trims.3", 1.5),))
    assert values == {"servos": {"trims": [0, 0, 0, 1.5]}}


def test_a_refused_value_is_not_kept():
    settings = Settings(Config(), Drive(), PATH)
    assert "0 .. 100" in refused(settings.tune, "avoid.margin", 999)
    assert settings._changed == {}


def test_a_missing_file_is_said():
    assert "cannot be written" in refused(Settings(Config(), Drive(), "missing/robot.json").keep)


def test_pointing_needs_a_robot_that_stands():
    drive = Drive()
    settings = Settings(Config(), drive, PATH)
    settings.point(0, 100)
    drive.stands = False
    assert "must stand" in refused(settings.point, 0, 100)
