"""What a person changes while the robot runs, and keeps: live parameters and servo trims."""

import json
import os


class Settings:
    """Applies changes to a Config at once, and writes them to robot.json when asked.

    config: has `get(key)` and `set(key, value)`, which raise ValueError with a text; drive: has `stop()` and `point(wheel, angle)`;
    avoid: has `configure()` and `envelopes`. path: the robot.json that the config was read from.
    """

    def __init__(self, config, drive, avoid, path="robot.json"):
        self._config = config
        self._drive = drive
        self._avoid = avoid
        self._path = path
        self._changed = {}

    def tune(self, key, value):
        """Change a parameter, value as in robot.json. ValueError tells what is allowed; nothing is changed then.

        The robot stands while the planner makes tables anew.
        """
        config = self._config
        before = None if key.startswith("servos.trims.") else config.get(key)
        config.set(key, value)
        if self._avoid.envelopes.outdated(config):
            self._drive.stop()
            try:
                self._avoid.configure()
            except MemoryError:
                config.set(key, before)
                self._avoid.configure()
                raise ValueError("%s: no memory to make the planner's tables anew; try again, or edit robot.json and restart" % key) from None
        self._changed[key] = value

    def point(self, wheel, angle):
        """Turn one wheel alone, 0.1 deg. ValueError unless the robot stands."""
        if not self._drive.point(wheel, angle):
            raise ValueError("wheel %d, %d (0.1 deg): the robot must stand, and the angle be within 900" % (wheel, angle))

    def keep(self):
        """Write what was changed to robot.json; everything else in it stays. ValueError if that fails: the old file is whole then."""
        try:
            with open(self._path) as file:
                values = json.load(file)
            for key in sorted(self._changed):
                _put(values, key, self._changed[key], self._config)
            # A new file first: a robot switched off in the middle must find the old one or the new one.
            part = self._path + ".new"
            with open(part, "w") as file:
                _write(file, values)
            os.rename(part, self._path)
        except OSError as error:
            raise ValueError("%s cannot be written: %s" % (self._path, error)) from None


def _put(values, key, value, config):
    """Set a dotted key in nested dicts; servos.trims.3 is item 3 of the list servos.trims."""
    place = values
    names = key.split(".")
    for name in names[:-1]:
        if type(place.get(name)) not in (dict, list):
            # A single trim may stand for all wheels; written out, each can have its own.
            place[name] = [place.get(name, 0)] * (2 * config.axles) if name == "trims" else {}
        place = place[name]
    place[int(names[-1]) if type(place) is list else names[-1]] = value


def _write(file, values):
    """JSON as people write robot.json: a line for each key of a group."""
    file.write("{\n")
    groups = list(values)
    for group in groups:
        content = values[group]
        if type(content) is dict:
            text = ",\n".join(["    %s: %s" % (json.dumps(key), json.dumps(content[key])) for key in content])
            text = "{\n%s\n  }" % text
        else:
            text = json.dumps(content)
        file.write("  %s: %s%s\n" % (json.dumps(group), text, "" if group == groups[-1] else ","))
    file.write("}\n")
