"""settings.py: changes that count at once and can be kept."""

import json
import os

from params.config import Config
from params.settings import Settings

PATH = "test_settings_robot.json"


def make(trims=(0, 0, 0, 0)):
    """Config of a robot with two axles."""
    return Config({"axles": {"spacings": [200]}, "servos": {"trims": trims}})


class Drive:
    stands = True
    stops = 0

    def stop(self):
        self.stops += 1

    def point(self, wheel, angle):
        return self.stands


def keep(before, changes, trims=(0, 0, 0, 0)):
    """The text of the file `before` with the changes kept."""
    with open(PATH, "w") as file:
        file.write(before)
    try:
        settings = Settings(make(trims), Drive(), {}, PATH)
        for key, value in changes:
            settings.tune(key, value)
        settings.keep()
        with open(PATH) as file:
            text = file.read()
    finally:
        os.remove(PATH)
    json.loads(text)
    return text


def refused(call, *arguments):
    """The text of the ValueError."""
    try:
        call(*arguments)
    except ValueError as error:
        return str(error)
    assert False, "not refused"


BEFORE = """{
  "mode": "AWS",
  "wifi": {"ssid": "a \\"b\\" {c}, d", "port": 9750},
  "servos": {
    "trims": [1, 2, 3, 4],
    "channels": [0, 1,
                 2, 3]
  },
  "avoid": { "accept":150,
    "margin" : 15 }
}
"""


def test_only_what_was_changed_changes():
    text = keep(BEFORE, (("avoid.margin", 20),))
    assert text == BEFORE.replace('"margin" : 15', '"margin" : 20')
    text = keep(BEFORE, (("avoid.accept", 99), ("avoid.margin", 7), ("avoid.margin", 8)))
    assert text == BEFORE.replace("150", "99").replace("15 }", "8 }")
    assert keep(BEFORE, ()) == BEFORE


def test_what_is_missing_is_added():
    text = keep(BEFORE, (("avoid.soft_margin", 30), ("servos.rate", 200), ("windows.red", 9), ("windows.blue", 50)))
    expected = BEFORE.replace("15 }", '15,\n    "soft_margin": 30 }').replace("3]\n  }", '3],\n    "rate": 200\n  }')
    assert text == expected[:-3] + ',\n  "windows": {"blue": 50, "red": 9}\n}\n'
    assert json.loads(keep("{}", (("drive.cruise", 100),))) == {"drive": {"cruise": 100}}
    assert json.loads(keep('{"drive": {}}', (("drive.cruise", 100),))) == {"drive": {"cruise": 100}}


def test_a_trim_of_one_wheel():
    text = keep(BEFORE, (("servos.trims.2", -5),), (1, 2, 3, 4))
    assert text == BEFORE.replace("[1, 2, 3, 4]", "[1, 2, -5, 4]")
    text = keep('{"servos": {"trims": 2}}', (("servos.trims.0", 7),), (2, 2, 2, 2))
    assert json.loads(text) == {"servos": {"trims": [7, 2, 2, 2]}}
    text = keep("{}", (("servos.trims.3", 1.5), ("servos.trims.1", -0.3)))
    assert json.loads(text) == {"servos": {"trims": [0, -0.3, 0, 1.5]}}


def test_a_file_that_is_no_longer_json_stays():
    for broken in ('{"avoid": {"margin": 15}', '{"avoid": {"margin" 15}}', "", '{"avoid": {"margin": "15}}'):
        with open(PATH, "w") as file:
            file.write(broken)
        settings = Settings(make(), Drive(), {}, PATH)
        settings.tune("avoid.margin", 20)
        assert "not JSON" in refused(settings.keep)
        with open(PATH) as file:
            assert file.read() == broken
    os.remove(PATH)


def test_a_refused_value_is_not_kept():
    changed = {}
    settings = Settings(make(), Drive(), changed, PATH)
    assert "0 .. 100" in refused(settings.tune, "avoid.margin", 999)
    assert changed == {}


def test_a_missing_file_is_said():
    assert "cannot be written" in refused(Settings(make(), Drive(), {}, "missing/robot.json").keep)


def test_pointing_needs_a_robot_that_stands():
    drive = Drive()
    settings = Settings(make(), drive, {}, PATH)
    settings.point(0, 100)
    drive.stands = False
    assert "must stand" in refused(settings.point, 0, 100)


def test_margins_count_from_the_next_start():
    settings = Settings(make(), Drive(), {}, PATH)
    assert settings.tune("drive.cruise", 100) == ""
    for key, value in (("avoid.margin", 5), ("avoid.soft_margin", 40), ("windows.look_ahead", 800)):
        assert "next start" in settings.tune(key, value)
