"""What a person changes while the robot runs, and keeps: live parameters and servo trims."""

import json


class Settings:
    """Applies changes to a Config at once, and writes them to robot.json when asked.

    config: has `get(key)` and `set(key, value)`, which raise ValueError with a text, and `servos_trims`; drive: has `stop()` and `point(wheel, angle)`;
    avoid: has `configure()` and `candidates`; room: Room. path: the robot.json that the config was read from.
    """

    def __init__(self, config, drive, avoid, room, path="robot.json"):
        self._config = config
        self._drive = drive
        self._avoid = avoid
        self.room = room
        self._path = path
        self._changed = {}

    def tune(self, key, value):
        """Change a parameter, value as in robot.json. ValueError tells what is allowed; nothing is changed then.

        The robot stands while the planner makes tables anew.
        """
        config = self._config
        before = None if key.startswith("servos.trims.") else config.get(key)
        config.set(key, value)
        if self._avoid.candidates.outdated(config):
            self._drive.stop()
            with self.room.lend():
                if not self._configured():
                    config.set(key, before)
                    self._avoid.configure()
                    raise ValueError("%s: no memory to make the planner's tables anew; edit robot.json and restart" % key)
        self._changed[key] = value

    def _configured(self):
        """Whether there was memory for it; the error, which holds on to some, is gone at the end."""
        try:
            self._avoid.configure()
        except MemoryError:
            return False
        return True

    def point(self, wheel, angle):
        """Turn one wheel alone, 0.1 deg. ValueError unless the robot stands."""
        if not self._drive.point(wheel, angle):
            raise ValueError("wheel %d, %d (0.1 deg): the robot must stand, and the angle be within 900" % (wheel, angle))

    def keep(self):
        """Write what was changed to robot.json; everything else in it stays. ValueError if that fails: the old file is whole then.

        The robot stands while the flash memory is written.
        """
        self._drive.stop()
        changed = {}
        for key, value in self._changed.items():
            if key.startswith("servos.trims."):
                # A single trim may stand for all wheels; written out, each can have its own.
                key, value = "servos.trims", [trim / 10 if trim % 10 else trim // 10 for trim in self._config.servos_trims]
            changed[key] = json.dumps(value)
        try:
            with self.room.lend("params.json_patch"):
                from params.json_patch import keep

                keep(self._path, changed)
                del keep
        except OSError as error:
            raise ValueError("%s cannot be written: %s" % (self._path, error)) from None
