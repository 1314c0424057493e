"""What a person sees while the robot drives."""

from functools import cache
from math import degrees

from host import compat

from .simulation import Observer

WINDOWS = ("none", "green", "red", "blue", "yellow")
EVERY_US = 500_000


class Progress(Observer):
    """Prints a line twice a second, and whatever the firmware prints."""

    def __init__(self, out=print):
        self._out = out
        self._next = 0
        self._printed = b""
        self._crashed = False

    def step(self, simulation):
        if simulation.now < self._next:
            return
        self._next = simulation.now + EVERY_US
        body = simulation.body
        line = f"{simulation.now / 1e6:5.1f} s  x {body.x:5.0f}  y {body.y:5.0f}  heading {degrees(body.heading) % 360:4.0f}"
        line += f"  clearance {simulation.contact.clearance():4.0f} mm"
        if simulation.decisions:
            line += "  " + describe(simulation.decisions[-1])
        self._out(line)

    def serial(self, data):
        *lines, self._printed = (self._printed + data).split(b"\n")
        for line in lines:
            text = line.decode(errors="replace").strip()  # a piece of a binary message does not decode
            self._crashed = self._crashed or text.startswith("Traceback")  # which the result shows as the reason
            if text and text.isprintable() and "\ufffd" not in text and not self._crashed:
                self._out(f"         firmware: {text}")


def describe(decision):
    """A decision in words."""
    text = f"AF {decision.af / 10:5.1f}  AR {decision.ar / 10:5.1f}  V {decision.v:3d}"
    if 0 < decision.window < len(WINDOWS):
        text += f"  {WINDOWS[decision.window]}"
    if decision.zone < 10:
        text += f" zone {decision.zone}"
    why = reasons()
    return text + (f"  {why[decision.why]}" if decision.why < len(why) else "")


@cache
def reasons():
    """The firmware's texts for `why`."""
    compat.install()
    try:
        from link.reason_texts import REASONS
    except ImportError:
        return ()
    return REASONS


def summary_line(result):
    """The result in one line."""
    text = f"{result.course} {result.width_mm:g} mm, seed {result.seed}, {result.mode.upper()}, {result.engine}: {result.result}"
    text += f" in {result.time_s:.1f} s, least clearance {result.min_clearance_mm:.0f} mm, contacts {result.contacts},"
    text += f" touched by others {result.touched_by}," if result.touched_by else ""
    text += f" scrub {result.scrub_mm_s:.1f} mm/s, {result.decisions} decisions, computed in {result.wall_s:.1f} s"
    return text + (f"\nreason: {result.reason}" if result.reason else "")
