"""The power budget of a robot.json: what each supply has to give. Figures of parts are typical ones from data sheets; those of motors and servos must be yours."""

from dataclasses import dataclass

# Ampere (usual, most): of one part. Lidar: vendor's data sheet, running and starting. Servo: MG996R class, moving without load and held at its end
# stop. Motor: a small geared motor, rolling and held. ESP32: with the radio sending. PWM chip with its outputs unloaded.
LIDAR, ESP32, CHIP, SCREEN = (0.5, 0.6), (0.12, 0.5), (0.01, 0.01), (0.15, 0.3)
SERVO, MOTOR = (0.5, 2.5), (0.3, 1.2)
MOVING = 0.5  # share of the servos that move at the same time in a usual turn
BRIDGE_DROP = 2.0  # volts lost in an L298N at small currents


@dataclass(frozen=True)
class Supply:
    """name, volts; parts: [(what, how many, A usual, A most)]."""

    name: str
    volts: str
    parts: list

    @property
    def usual(self):
        return sum(count * usual for _, count, usual, _ in self.parts)

    @property
    def most(self):
        return sum(count * most for _, count, _, most in self.parts)


def supplies(wired, servo=SERVO, motor=MOTOR):
    """The supplies of a wiring.Wiring. servo, motor: (A usual, A most) of one."""
    wheels = 2 * wired.axles
    logic = [("ESP32 board", 1, *ESP32), ("lidar", 1, *LIDAR), ("PWM chip", 3, *CHIP)]
    if wired.screen != "none":
        logic.append(("screen", 1, *SCREEN))
    return [
        Supply("logic", "5 V", logic),
        Supply("servos", "6 V", [("servo", wheels, servo[0] * MOVING, servo[1])]),
        Supply("motors", "battery", [("motor", wheels, *motor)]),
    ]


def text(wired, servo=SERVO, motor=MOTOR):
    """The budget as Markdown."""
    out = ["| supply | part | number | usual, A | most, A |", "|---|---|---|---|---|"]
    for supply in supplies(wired, servo, motor):
        for what, count, usual, most in supply.parts:
            out.append(f"| {supply.name}, {supply.volts} | {what} | {count} | {count * usual:.2f} | {count * most:.2f} |")
        out.append(f"| | **together** | | **{supply.usual:.1f}** | **{supply.most:.1f}** |")
    return "\n".join(out) + "\n"
