"""Faults of the PWM chips and of the bus to them, of output enable, and of the processor's supply."""

from .base import NEVER, Fault, board_file, named

POWER_ON, HARD_RESET = 1, 2  # as machine.reset_cause() tells them; of a brown-out nothing better than power-on can be relied on
BUS_STUCK = 62  # like BEGUN no pin: SDA is held low, so that every transfer waits for the driver's time-out
_PULSES = 9  # of SCL let go of a chip that waits for them


def _chip(simulation, which):
    vehicle = simulation.vehicle
    return {"servos": vehicle.servo_chip, "left": vehicle.left_chip, "right": vehicle.right_chip}[which]


@named("chip-gone", "the left motors' chip answers no more, and goes on with what it heard last", within_ms=250, again_s=0, which="left")
@named("chip-gone-servos", "the servos' chip answers no more", within_ms=250, again_s=0, which="servos")
class Gone(Fault):
    def __init__(self, which):
        self._which = which

    def begin(self, simulation):
        del simulation.electronics.chips[_chip(simulation, self._which)]


@named("chip-reset", "the left motors' chip loses its registers once", within_ms=100, which="left")
@named("chip-reset-servos", "the servos' chip loses its registers once", within_ms=100, which="servos")
@named("chip-resets", "the left motors' chip loses its registers every 1.1 s", within_ms=3300, again_s=0, which="left", every_us=1_100_000, rest_s=1.0)
class Resets(Fault):
    def __init__(self, which, every_us=NEVER, rest_s=0.3):
        self._which = which
        self._every = every_us
        self.rest_s = rest_s  # where nothing is broken afterwards it stops, finds its wheels and goes on: no whole second

    def begin(self, simulation):
        self.wake = simulation.now

    def go_on(self, simulation):
        if simulation.now >= self.wake:
            self.wake += self._every
            simulation.electronics.brown_out(simulation.now, _chip(simulation, self._which))


@named("i2c-stuck", "a chip holds SDA low until it has seen nine pulses of SCL; the driver waits for its time-out", within_ms=250)
@named("i2c-dead", "SDA is shorted to ground for good; the driver waits for its time-out", within_ms=250, again_s=0, pulses=NEVER)
class Bus(Fault):
    files = board_file(kind="bus")

    def __init__(self, pulses=_PULSES):
        self._left = pulses

    def begin(self, simulation):
        self._scl = simulation.vehicle.scl
        self._chips = dict(simulation.electronics.chips)
        self.levels |= 1 << BUS_STUCK
        simulation.electronics.chips.clear()
        simulation.electronics.sda_held = True

    def pin(self, time, gpio, level):
        if self.began is not None and gpio == self._scl and level:
            self._left -= 1

    def go_on(self, simulation):
        if self._left <= 0 and self._chips:
            self.levels &= ~(1 << BUS_STUCK)
            simulation.electronics.sda_held = False
            simulation.electronics.chips.update(self._chips)
            self._chips = {}


@named("reset", "somebody presses the board's reset button", within_ms=1, again_s=0, cause=HARD_RESET)
@named("brown-out", "the processor's supply dips and it starts anew; the chips keep their registers", within_ms=1, again_s=0, cause=POWER_ON)
@named("oe-open", "output enable is not wired, and the processor resets while the motors are on", within_ms=1000, again_s=0, cause=HARD_RESET, wired=False)
@named("oe-open-json", "as oe-open, and robot.json is empty by then", within_ms=1000, again_s=0, cause=HARD_RESET, wired=False, robot=b"")
class Processor(Fault):
    def __init__(self, cause, wired=True, robot=None):
        self._cause, self._wired, self._robot = cause, wired, robot

    def begin(self, simulation):
        if not self._wired:
            simulation.electronics.lose_output_enable(simulation.now)
        if self._robot is not None:
            self.left_behind = {"robot.json": self._robot}
        self.reset(self._cause)


@named("battery-off", "the wire of the battery's divider comes off", volts=((0.0, 0.0),))
@named("battery-low", "the battery gets low, 6.4 V", volts=((0.0, 6.4),))
@named("battery-empty", "the battery gets empty, 5.5 V", within_ms=5000, again_s=0, volts=((0.0, 5.5),))
@named("battery-latch", "the battery is empty, and after 6 s the divider's wire comes off", within_ms=5000, again_s=0, volts=((0.0, 5.5), (6.0, 0.0)))
class Battery(Fault):
    def __init__(self, volts):
        self._volts = volts

    def go_on(self, simulation):
        for after, volts in self._volts:
            if simulation.now >= self.began + after * 1e6:
                simulation.electronics.battery_volts = volts
