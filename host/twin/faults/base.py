"""What every fault has in common: when it begins, what it may touch, and what is measured of it."""

import json
from dataclasses import dataclass

FIRST_S = 4.0  # without a time of its own a fault begins once so much has passed and the motors are on
WATCHED_S = 20.0  # after its beginning; then the run is over
BEGUN = 63  # no pin of an ESP32: this level tells the board's module `fault` that the fault has begun
NEVER = float("inf")


@dataclass
class Outcome:
    """What a run showed of its fault.

    fault_at_s: when it began, None if the run was over before. still_ms: from then until the motors were off, and stayed off for Fault.rest_s or until
    the firmware's end; None: never. Off means off in the registers, or output enable high or floating. touched_after: contacts with a wall that
    began after it. driven_after_s: for how long motors were on after it.
    """

    fault: str
    fault_at_s: float | None
    still_ms: float | None
    touched_after: int
    driven_after_s: float


class Fault:
    """A part that fails. The base class is the run in which nothing does.

    changes: {"section.key": value} put over robot.json. files: {name: bytes} on the board beside it. clock_us: what the board's clock shows at the
    start. at_start: the fault is there from the beginning. left_behind: {name: bytes} on the board when the fault resets it. forgets: its reset is a loss of power.
    began: us, None before. watched_s: after it the run is over. rest_s: motors off for so long count as still; a pause to swing the wheels is mostly
    shorter. levels: bits of input pins that the fault sets. wake: us; when it wants to be asked next, if that is sooner than anything else happens.
    """

    changes: dict = {}
    files: dict = {}
    left_behind: dict = {}
    forgets = False
    clock_us = 0
    at_start = False
    watched_s = WATCHED_S
    rest_s = 1.0
    levels = 0
    wake = NEVER
    began: float | None = None
    name = ""
    _reset = 0

    def prepare(self, name, at_s=None):
        """The name that it is listed under, and when it begins (s; None: when the robot drives)."""
        self.name = name
        self._at = 0.0 if at_s is None and self.at_start else None if at_s is None else at_s * 1e6
        if self._at is not None:
            self.wake = self._at

    def begin(self, simulation):
        """The fault begins."""

    def go_on(self, simulation):
        """Called whenever the firmware has let time pass, from the beginning of the fault on."""

    def distort(self, time, data):
        """What the lidar's line makes of a frame (bytes) once the fault has begun."""
        return data

    def pin(self, time, gpio, level):
        """An output pin has changed."""

    def reset(self, cause):
        """The fault resets the processor; cause as machine.reset_cause() tells it afterwards."""
        self._reset = cause

    # What the twin calls

    def look(self, simulation):
        """Time has passed, to simulation.now."""
        if not self.name:
            return
        now = simulation.now
        if self.began is None:
            if now < (FIRST_S * 1e6 if self._at is None else self._at) or self._at is None and not simulation.electronics.motors_on:
                return
            self.began = now
            self.wake = NEVER
            self.levels |= 1 << BEGUN
            self._touched = len(simulation.contact.touches)
            self.begin(simulation)
        if now >= self.began + self.watched_s * 1e6:
            simulation.stop("timeout", f"{self.watched_s:g} s have passed since the fault")
        self.go_on(simulation)

    def frame(self, time, data):
        """Bytes of a frame as they go on the lidar's line."""
        return data if self.began is None else self.distort(time, data)

    def take_reset(self):
        """The cause of the reset that the fault wants now, 0 = none."""
        cause, self._reset = self._reset, 0
        return cause

    def restarted(self):
        """The board has begun a new life."""

    def outcome(self, simulation, ended):
        """The Outcome. ended: True when the firmware has come to its end, so that the motors stay as they are."""
        if self.began is None:
            return Outcome(self.name, None, None, 0, 0.0)
        still = None
        driven = 0.0
        for start, end, on in _periods(simulation.electronics.switched, self.began, simulation.body.now):
            if on:
                driven += end - start
            elif still is None and (end - start >= self.rest_s * 1e6 or ended and end == simulation.body.now):
                still = start - self.began
        return Outcome(
            self.name,
            round(self.began / 1e6, 3),
            None if still is None else round(still / 1e3, 1),
            len(simulation.contact.touches) - self._touched,
            round(driven / 1e6, 2),
        )


def board_file(**what):
    """Files that tell the board's module `fault` what to do; see its `load`."""
    return {"fault.json": json.dumps(what).encode()}


def _periods(switched, began, now):
    """[(start, end, on)] of the motors from the beginning of a fault. switched: [(time, on)] of each change, off before the first."""
    on = False
    start = began
    for time, turned_on in switched:
        if time > began:
            yield start, time, on
            start = time
        on = turned_on
    yield start, max(now, start), on


@dataclass(frozen=True)
class Kind:
    """A fault that can be asked for.

    text: what it does, in one line. within_ms: how soon the robot promises to stand still; None: it drives on, and touches nothing.
    again_s: for so long at most it drives after that, as long as the fault is there and nobody tells it to; None: as it likes.
    """

    name: str
    text: str
    within_ms: int | None
    again_s: float | None
    make: type
    settings: dict

    @property
    def module(self):
        """Name of the file that it is in."""
        return self.make.__module__.rpartition(".")[2]


KINDS: dict[str, Kind] = {}


def named(name, text, within_ms=None, again_s=None, **settings):
    """Class decorator: lists the fault under a name. settings: what its __init__ is given."""

    def keep(made):
        KINDS[name] = Kind(name, text, within_ms, again_s, made, settings)
        return made

    return keep
