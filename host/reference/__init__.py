"""Reference pages made from the firmware's own words: docs/robot-json.md from the table that the robot checks its file by (firmware/lib/params/schema.py),
docs/protocol.md from the page of the wire format (firmware/lib/link/protocol.py)."""

from host import compat
from host.twin import image

PAGE = image.ROOT / "docs" / "robot-json.md"
PROTOCOL = image.ROOT / "docs" / "protocol.md"

# What each group is about, in the order of the page
GROUPS = {
    "mode": "How the axles steer.",
    "robot": "The body, seen from above.",
    "axles": "Where the wheels are. Wheels are counted from the front: axle 1 left, axle 1 right, axle 2 left, and so on.",
    "lidar": "How the lidar is connected and mounted.",
    "i2c": "The bus of the three PWM chips.",
    "servos": "The chip of the steering servos, and each wheel's calibration. `trims`, `low`, `high` can be set on the page while the wheel turns.",
    "motors": "The chips of the drive motors.",
    "pins": "Single wires.",
    "battery": "The battery's voltage, through a divider.",
    "drive": "How fast, and when it starts.",
    "windows": "How near is near. The windows are drawn in [planner.md](planner.md#the-words).",
    "avoid": "How the steering is chosen.",
    "goal": "Driving to a place on a map of the house; without a map all of it is left out.",
    "screen": "A serial touch screen on the robot: [screen.md](screen.md).",
    "wifi": "Telemetry and commands over WiFi: [monitor.md](monitor.md).",
}
HEAD = """# robot.json

The one file a builder edits. It lies on the board; `make flash` puts [firmware/robot.json](../firmware/robot.json) there the first time and never replaces it
afterwards. What is left out has its default, what is unknown or out of range is refused with its key, its value and what is allowed. [Examples](../examples/README.md)
for robots of 2 to 8 axles are driven in the tests; `{wiring} FILE` draws the wiring of one.

*At once* means that the page can change it while the robot runs, and *Keep* writes it into the file on the board. All else counts from the next start. Lengths are mm,
angles degrees clockwise.

<!-- Made by `{command}` from firmware/lib/params/schema.py: change it there. -->
"""
KINDS = {
    "int": "whole number", "number": "number", "flag": "true or false", "choice": "one of these", "text": "text", "pin": "GPIO or null", "address": "I2C address",
    "spacings": "list", "wheels": "number, or one a wheel", "signs": "1 or -1, or one a wheel", "pairs": "one an axle", "sectors": "list of [from, to]", "needed": "GPIO",
}  # fmt: skip
FINE = ("deg", "r/s", "times")  # units of which the robot counts parts
NEEDED = ("lidar.rx", "i2c.scl", "i2c.sda")
UNSAID = {
    "axles.first": "half the sum of the spacings", "servos.channels": "0, 1, 2, ...", "motors.channels": "0, 2, 4, ...", "windows.look_ahead": "1.5 x robot.length",
    "avoid.margin": "1.5 % of robot.length, at least 9", "avoid.soft_margin": "5 % of robot.length, at least 30",
}  # fmt: skip


def text():
    """The page."""
    compat.install()
    from params import schema

    groups: dict[str, list] = {}
    for live, table in ((False, schema.BOOT), (True, schema.LIVE)):
        for row in schema.rows(table):
            groups.setdefault(row[0].partition(".")[0], []).append((row, live and "next start" not in row[6]))
    out = [HEAD.format(wiring="python -m host.wiring", command="python -m host.reference")]
    for group in [*GROUPS, *(name for name in groups if name not in GROUPS)]:
        out.append(f"## {group}\n\n{GROUPS.get(group, '')}\n")
        out.append("| key | what it is | value | default | unit | at once |\n|---|---|---|---|---|---|")
        out += [_row(row, at_once) for row, at_once in groups[group]]
        out.append("")
    return "\n".join(out)


PROTOCOL_HEAD = """# The protocol

What goes between robot and laptop, the same over USB serial (115200 baud) and UDP (port 9750). The laptop's side is [host/link](../host/link/base.py): every message there is a dict, and
`python -m host.monitor --text` prints them. A recording holds these very bytes: [recording.md](recording.md).

<!-- Made by `python -m host.reference` from firmware/lib/link/protocol.py: change it there. -->
"""


def protocol():
    """The page of the wire format."""
    compat.install()
    from link import protocol

    first, _, rest = protocol.__doc__.strip().partition("\n\n")
    second, _, rest = rest.partition("\n\n")  # to those who read the source
    return f"{PROTOCOL_HEAD}\n{first}\n\n```text\n{rest.strip()}\n```\n"


def pages():
    """{path: text} of all pages made here."""
    return {PAGE: text(), PROTOCOL: protocol()}


def _row(row, at_once):
    key, kind, default, low, high, unit, meaning = row
    name = key.partition(".")[2] or key
    if kind == "int" and unit in FINE:
        kind = "number"
    if kind == "pin" and key in NEEDED:
        kind = "needed"
    return f"| `{name}` | {meaning} | {_value(kind, low, high)} | {_default(key, default)} | {unit} | {'yes' if at_once else ''} |"


def _value(kind, low, high):
    if kind == "choice":
        return ", ".join(f"`{one}`" for one in low)
    if kind == "text":
        return f"text, at most {high} characters"
    what = KINDS[kind]
    return f"{what}, {low} .. {high}" if low is not None else what


def _default(key, default):
    if default is None:
        return UNSAID.get(key, "null")
    if isinstance(default, bool):
        return "true" if default else "false"
    return '""' if default == "" else str(default)
