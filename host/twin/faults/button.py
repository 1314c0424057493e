"""The stop button, pressed in ways that ask something of the firmware; and its wire."""

from .base import NEVER, Fault, named

_POWER_ON, _HARD_RESET = 1, 2  # as machine.reset_cause() tells it


@named("button-held", "the stop button is pressed and held", within_ms=100, again_s=0, script=((0, True),))
@named("button-short", "the stop button is pressed for 0.2 s", within_ms=100, again_s=0, script=((0, True), (0.2, False)))
@named(
    "button-bounce",
    "the stop button is pressed for 3 s; its contact opens for 20 ms at the start and once in between",
    within_ms=100,
    again_s=0,
    script=((0, True), (0.02, False), (0.04, True), (1.5, False), (1.52, True), (3, False)),
)
@named(
    "button-wire",
    "a bad contact of the wire: closed for 20 ms, and for 1.2 s three seconds later",
    within_ms=100,
    again_s=0,
    script=((0, True), (0.02, False), (3, True), (4.2, False)),
)
class Button(Fault):
    def __init__(self, script):
        self._script = list(script)

    def begin(self, simulation):
        self._start = self.wake = simulation.now

    def go_on(self, simulation):
        while simulation.now >= self.wake:
            simulation.electronics.stop_pressed = self._script.pop(0)[1]
            self.wake = self._start + self._script[0][0] * 1e6 if self._script else NEVER


@named("button-off", "the wire of the stop button comes off; a second later somebody presses it")
class Wire(Fault):
    def begin(self, simulation):
        self._start = simulation.now
        simulation.electronics.stop_wired = False

    def go_on(self, simulation):
        simulation.electronics.stop_pressed = simulation.now > self._start + 1e6


@named("button-reset", "the stop button is pressed for 0.3 s; two seconds later somebody presses the board's reset button", within_ms=100, again_s=0)
@named("button-power", "the stop button is pressed for 0.3 s; two seconds later the power is switched off and on", 100, 0, cause=_POWER_ON)
class PressedAndReset(Fault):
    _done = False

    def __init__(self, cause=_HARD_RESET):
        self._cause = cause
        self.forgets = cause == _POWER_ON

    def go_on(self, simulation):
        after = simulation.now - self._start
        simulation.electronics.stop_pressed = after < 0.3e6
        if after > 2e6 and not self._done:
            self._done = True
            self.reset(self._cause)

    def begin(self, simulation):
        self._start = simulation.now
