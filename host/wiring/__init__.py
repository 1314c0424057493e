"""What has to be joined to what, by robot.json: the pins of the ESP32, the outputs of the PWM chips, the supplies. `python -m host.wiring` prints and draws it."""

import json
from dataclasses import dataclass

from host import compat
from host.twin import image
from host.twin.run import load_config

PAGE = image.ROOT / "docs" / "wiring.md"
DRAWING = image.ROOT / "docs" / "wiring.svg"
MOTORS_OF_A_MODULE = 2  # an L298N has two bridges


@dataclass(frozen=True)
class Wire:
    """One GPIO of the ESP32. key: of robot.json. kind: signal, bus. note: what is needed besides, "" for nothing."""

    gpio: int
    device: str
    terminal: str
    key: str
    note: str = ""


@dataclass(frozen=True)
class Wiring:
    """All of it. axles: how many. pins: [Wire], in the order of the drawing. servos: [(output, wheel)] of the servos' chip; motors: {side: [(IN1 output, IN2 output, wheel)]}.

    chips: {"servos" or side: I2C address}. screen: kind, "none" for none.
    """

    axles: int
    pins: list
    servos: list
    motors: dict
    chips: dict
    screen: str

    @property
    def modules(self):
        """L298N modules of each side."""
        return -(-self.axles // MOTORS_OF_A_MODULE)


def wiring(config=None):
    """The Wiring of a robot.json, a path or a dict (None: the default one). ValueError names the file and the key that is wrong."""
    values = load_config(config)
    compat.install()
    from params.config import Config

    try:
        c = Config(values)
    except ValueError as error:
        raise ValueError(f"{config or image.FIRMWARE / 'robot.json'}: {error}") from None
    names = [f"axle {k // 2 + 1} {('left', 'right')[k % 2]}" for k in range(2 * c.axles)]
    motors = {}
    for side, name in enumerate(("left", "right")):
        rows = []
        for axle, output in enumerate(c.motors_channels):
            pair = (output, output + 1) if c.motors_directions[2 * axle + side] > 0 else (output + 1, output)
            rows.append((*pair, names[2 * axle + side]))
        motors[name] = rows
    return Wiring(
        axles=c.axles,
        pins=_pins(c),
        servos=sorted(zip(c.servos_channels, names, strict=True)),
        motors=motors,
        chips={"servos": c.servos_address, "left": c.motors_left, "right": c.motors_right},
        screen=c.screen_kind,
    )


def _pins(c):
    rows = [
        (c.lidar_rx, "lidar", "TX", "lidar.rx", "3.3 V logic: joined directly"),
        (c.lidar_motor_pin, "lidar motor driver", "gate", "lidar.motor_pin", "a transistor with a diode across the motor: the pin cannot feed it"),
        (c.pins_stop_button, "stop button", "contact", "pins.stop_button", "the other contact to GND"),
        (c.pins_battery, "battery divider", "middle", "pins.battery", f"battery voltage / {c.battery_divider1000 / 1000:g}: at most 3.1 V at the pin"),
        (c.i2c_scl, "PWM chips", "SCL", "i2c.scl", "2.2 to 4.7 kOhm to 3.3 V, once for all chips"),
        (c.i2c_sda, "PWM chips", "SDA", "i2c.sda", "2.2 to 4.7 kOhm to 3.3 V, once for all chips"),
        (c.pins_output_enable, "PWM chips", "OE", "pins.output_enable", "10 kOhm to 3.3 V: outputs stay off while the ESP32 starts"),
    ]
    if c.screen_kind != "none":
        rows += [(c.screen_tx, "screen", "RX", "screen.tx", ""), (c.screen_rx, "screen", "TX", "screen.rx", "")]
    return [Wire(*row) for row in rows if row[0] is not None]


def table(wired):
    """The pins and the outputs of a Wiring as Markdown."""
    out = ["| GPIO | goes to | there | besides | robot.json |", "|---|---|---|---|---|"]
    out += [f"| {wire.gpio} | {wire.device} | {wire.terminal} | {wire.note} | `{wire.key}` |" for wire in wired.pins]
    out += ["", f"| output of 0x{wired.chips['servos']:02x} | servo of |", "|---|---|"]
    out += [f"| {output} | {wheel} |" for output, wheel in wired.servos]
    left, right = wired.motors["left"], wired.motors["right"]
    out += ["", f"| IN1, IN2 | of 0x{wired.chips['left']:02x}: motor of | of 0x{wired.chips['right']:02x}: motor of |", "|---|---|---|"]
    if [row[:2] for row in left] == [row[:2] for row in right]:
        out += [f"| {a}, {b} | {wheel} | {other} |" for (a, b, wheel), (_, _, other) in zip(left, right, strict=True)]
    else:
        out += [f"| {a}, {b} | {wheel} | |" for a, b, wheel in left] + [f"| {a}, {b} | | {wheel} |" for a, b, wheel in right]
    return "\n".join(out) + "\n"


def as_json(wired):
    """The Wiring for programs."""
    return json.dumps({**vars(wired), "pins": [vars(wire) for wire in wired.pins]}, indent=2)
