"""settings.py: changes that count at once and can be kept."""

import json
import os

from settings import Settings

PATH = "test_settings_robot.json"


class Config:
    axles = 2

    def __init__(self):
        self.values = {}

    def get(self, key):
        return self.values.get(key, 15)

    def set(self, key, value):
        if value == 999:
            raise ValueError("%s = 999: 0 .. 100 is needed" % key)
        self.values[key] = value


class Drive:
    stands = True
    stops = 0

    def stop(self):
        self.stops += 1

    def point(self, wheel, angle):
        return self.stands


class Avoid:
    """Planner whose tables depend on avoid.margin."""

    memory = True
    made_with = 15

    def __init__(self, config=None):
        self.config = config
        self.envelopes = self

    def outdated(self, config):
        return self.config is not None and config.get("avoid.margin") != self.made_with

    def configure(self):
        if self.outdated(self.config):
            if not self.memory:
                raise MemoryError("memory allocation failed")
            self.made_with = self.config.get("avoid.margin")


def keep(before, changes):
    """The file before with the changes kept: (its values, its text)."""
    with open(PATH, "w") as file:
        file.write(before)
    try:
        settings = Settings(Config(), Drive(), Avoid(), PATH)
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
    settings = Settings(Config(), Drive(), Avoid(), PATH)
    assert "0 .. 100" in refused(settings.tune, "avoid.margin", 999)
    assert settings._changed == {}


def test_a_missing_file_is_said():
    assert "cannot be written" in refused(Settings(Config(), Drive(), Avoid(), "missing/robot.json").keep)


def test_pointing_needs_a_robot_that_stands():
    drive = Drive()
    settings = Settings(Config(), drive, Avoid(), PATH)
    settings.point(0, 100)
    drive.stands = False
    assert "must stand" in refused(settings.point, 0, 100)


def test_the_robot_stands_while_tables_are_made_anew():
    config, drive = Config(), Drive()
    avoid = Avoid(config)
    settings = Settings(config, drive, avoid, PATH)
    settings.tune("drive.cruise", 100)
    assert drive.stops == 0
    settings.tune("avoid.margin", 20)
    assert drive.stops == 1 and avoid.made_with == 20


def test_without_memory_for_the_tables_nothing_changes():
    config = Config()
    avoid = Avoid(config)
    avoid.memory = False
    settings = Settings(config, Drive(), avoid, PATH)
    assert "avoid.margin: no memory" in refused(settings.tune, "avoid.margin", 20)
    assert config.get("avoid.margin") == 15 and settings._changed == {}
