"""Changes a parameter while the robot runs. Loaded when a person asks for it, then let go."""

from params.values import attribute, disorder, key_of, number, refuse


def change(config, key, value):
    """Set a live parameter (value: int), or one wheel's trim, "servos.trims.0" and so on (value: degrees), of a Config.

    ConfigError, and nothing changed, if it is neither or the value is not allowed.
    """
    if key.startswith("servos.trims."):
        _trim(config, key, value)
    else:
        _live(config, key, value)
    config.changes += 1


def _live(config, key, value):
    name = attribute(key)
    if name not in config.live:
        refuse(key, value, "it cannot change while the robot runs: edit robot.json and restart")
    index = 2 * config.live.index(name)
    new = number(key, value, config.limits[index], config.limits[index + 1], "", 1, False)
    old = getattr(config, name)
    setattr(config, name, new)
    pair = disorder(config)
    if pair:
        setattr(config, name, old)
        refuse(key, value, "%s <= %s must hold" % (key_of(pair[0]), key_of(pair[1])))


def _trim(config, key, value):
    wheels = ["servos.trims.%d" % k for k in range(2 * config.axles)]
    if key not in wheels:
        refuse(key, value, "the wheels are %s .. %s" % (wheels[0], wheels[-1]))
    config.servos_trims[wheels.index(key)] = number(key, value, -20, 20, "deg", 10, False)
