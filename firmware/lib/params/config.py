"""The parameters of the robot while it runs. What robot.json may say is checked by parse.py, at the start only."""

from core.unload import forget


class Config:
    """All parameters as attributes: key lidar.baud is config.lidar_baud.

    values: what robot.json holds, as nested dicts; a missing key takes its default. ConfigError names the key that is wrong.

    Lengths are mm, angles 0.1 deg (degrees in the file), and the attributes of other units are told by schema.SCALES. Per-wheel values are
    array('h') in the order axle 1 left, axle 1 right, ...; everything the loop reads is an int.

    axles       number of axles
    live        attribute of each parameter that may change while the robot runs, in the order of schema.LIVE
    limits      array 'h', its low and high one after the other
    changes     counter of such changes, for those who keep something computed from a parameter
    once        dict of what only the start asks for, by attribute; None after the start: then the live ones and those of parse.STAY are left
    """

    once = None

    def __init__(self, values=None):
        # Table and checks are large and are let go at the end: the board keeps the values.
        from params.parse import fill

        self.changes = 0
        fill(self, {} if values is None else values)
        forget("params.parse", "params.schema", "params.values")

    def __getattr__(self, name):
        if self.once is None or name not in self.once:
            raise AttributeError(name)
        return self.once[name]
