"""What a person sees while the robot drives."""

from functools import cache
from math import degrees

from host import compat

from .simulation import Observer

WINDOWS = ("none", "green", "red", "blue", "yellow")
EVERY_US, SOON_US = 2_000_000, 300_000  # from one line to the next: the longest time, and the shortest


HEADER = (
    "   time      x      y  heading  clearance     AF     AR    V  why",
    "      s     mm     mm      deg         mm    deg    deg       (90 stands)",
)


class Progress(Observer):
    """Prints a line when the robot does something else, and every two seconds; before, a header with units; and whatever the firmware prints."""

    def __init__(self, out=print):
        self._out = out
        self._next = 0
        self._soon = 0
        self._why = None
        self._headed = False
        self._printed = b""
        self._crashed = False

    def step(self, simulation):
        decision = simulation.decisions[-1] if simulation.decisions else None
        why = None if decision is None else decision.why
        now = simulation.now
        if decision is None and self._headed or now < self._next and (why == self._why or now < self._soon):
            return
        self._next, self._soon, self._why = now + EVERY_US, now + SOON_US, why
        if not self._headed:
            self._headed = True
            for line in HEADER:
                self._out(line)
        body = simulation.body
        line = f"{now / 1e6:7.1f}{body.x:7.0f}{body.y:7.0f}{degrees(body.heading) % 360:9.0f}{simulation.contact.clearance():11.0f}"
        self._out(line + ("  the firmware starts" if decision is None else describe(decision)))

    def serial(self, data):
        *lines, self._printed = (self._printed + data).split(b"\n")
        for line in lines:
            text = line.decode(errors="replace").strip()  # a piece of a binary message does not decode
            self._crashed = self._crashed or text.startswith("Traceback")  # which the result shows as the reason
            if text and text.isprintable() and "\ufffd" not in text and not self._crashed:
                self._out(f"         firmware: {text}")


def describe(decision):
    """A decision under the HEADER: AF, AR, V, and why in words."""
    why = reasons()
    said = why[decision.why] if decision.why < len(why) else ""
    return f"{decision.af / 10:7.0f}{decision.ar / 10:7.0f}{decision.v:5d}  {said}"


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
