"""What a person changes while the robot runs, and keeps: live parameters and servo trims."""

from core.unload import unload


class Settings:
    """Applies changes to a Config at once, and writes them to robot.json when asked.

    config: Config; drive: has `stop()` and `point(wheel, angle)`; changed: dict of what has been tuned since the start, kept by whoever made
    this. path: the robot.json that the config was read from.

    Loaded when somebody changes something, and let go after (link/requests.py).
    """

    def __init__(self, config, drive, changed, path="robot.json"):
        self._config = config
        self._drive = drive
        self._path = path
        self._changed = changed

    def tune(self, key, value):
        """Change a parameter, value as in robot.json. ValueError tells what is allowed; nothing is changed then.

        Returns what there is to say about it: margins and look-ahead count from the next start.
        """
        self._drive.stop()  # loading the code for it takes longer than a turn of the loop may
        try:
            from params.change import change
            from params.next_start import NEXT_START

            change(self._config, key, value)
        finally:
            change = None
            unload("params.change", "params.values", "params.next_start")
        self._changed[key] = value
        return "counts from the next start: keep it, then restart" if key in NEXT_START else ""

    def point(self, wheel, angle):
        """Turn one wheel alone, 0.1 deg. ValueError unless the robot stands."""
        if not self._drive.point(wheel, angle):
            raise ValueError("wheel %d, %d (0.1 deg): the robot must stand, and the angle be within 900" % (wheel, angle))

    def keep(self):
        """Write what was changed to robot.json; everything else in it stays. ValueError if that fails: the old file is whole then.

        The robot stands meanwhile.
        """
        self._drive.stop()
        try:
            from params.json_patch import keep

            keep(self._path, self._changed, self._config.servos_trims)
        except OSError as error:
            raise ValueError("%s cannot be written: %s" % (self._path, error)) from None
        finally:
            keep = None
            unload("params.json_patch")
