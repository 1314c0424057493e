"""Writes what was tuned while the robot ran back to robot.json."""

import json
import os
import sys


def keep(config, path="robot.json"):
    """Write the live parameters and the servos' trims of a Config into the file; its other values stay as they are.

    The file is replaced whole, so that a cut of the supply leaves the old one or the new one. Takes some 10 kB for a moment: the robot
    should stand. OSError if the file cannot be read or written.
    """
    import schema

    with open(path) as file:
        values = json.load(file)
    for row in config.live:
        group, name = row[0].split(".")
        value = config.get(row[0])
        if value != row[2] or name in values.get(group, ()):
            values.setdefault(group, {})[name] = value
    if any(config.servos_trims) or "trims" in values.get("servos", ()):
        values.setdefault("servos", {})["trims"] = [_degrees(trim) for trim in config.servos_trims]
    with open(path + ".new", "w") as file:
        file.write(layout(values, schema.BOOT + schema.LIVE))
    os.rename(path + ".new", path)
    if sys.implementation.name == "micropython":
        del sys.modules["schema"]


def layout(values, rows):
    """Text of robot.json: nested dicts in the order of the rows of the schema, one value a line."""
    groups = []
    for row in rows:
        group = row[0].split(".")[0]
        if group in values and group not in groups:
            groups.append(group)
    return "{\n" + ",\n".join([_group(group, values[group], rows) for group in groups]) + "\n}\n"


def _group(group, content, rows):
    if type(content) is not dict:
        return '  "%s": %s' % (group, json.dumps(content))
    names = [row[0].split(".")[1] for row in rows if row[0].startswith(group + ".")]
    lines = ['    "%s": %s' % (name, json.dumps(content[name])) for name in names if name in content]
    return '  "%s": {\n%s\n  }' % (group, ",\n".join(lines))


def _degrees(tenths):
    return tenths // 10 if tenths % 10 == 0 else tenths / 10
