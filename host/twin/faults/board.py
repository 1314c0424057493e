"""Faults inside the board: a part of the firmware hangs, is late or fails, the memory is used up, the clock wraps, the radio is flooded.

They act through the module `fault` of the emulated board, which is told by a file what to do; the firmware's own files stay as they are.
"""

from host import compat

from .base import Fault, board_file, named

PARTS = ("lidar", "avoid", "drive", "health", "link", "telemetry", "screen")
_DRIVE = 0x41  # type of the command
_SCREEN = {"screen.kind": "nextion"}
_WIFI = {"wifi.ssid": "net", "wifi.password": "12345678"}
_SAFETY = ("lidar", "avoid", "drive", "health")  # what fails in one of these ends in standing still; the rest is told, and the robot drives on


class Part(Fault):
    """What the board's module does from the beginning on. once: it is over with the next reset."""

    def __init__(self, kind, part="", once=False, **more):
        self.files = board_file(kind=kind, part=part, **more)
        self.changes = _SCREEN if part == "screen" else {}
        self._once = once

    def restarted(self):
        if self._once:
            self.levels = 0


for _part in PARTS:
    _what = {"avoid": "the planner", "link": "the link", "drive": "the drive"}.get(_part, "the " + _part)
    named(f"hang-{_part}", f"{_what} never comes back, once; time passes", 1500, 0, kind="hang", part=_part, once=True)(Part)
    named(
        f"exception-{_part}",
        f"{_what} raises an exception each time",
        100 if _part in _SAFETY else None,
        0 if _part in _SAFETY else None,
        kind="exception",
        part=_part,
    )(Part)
named("hang", "the planner never comes back, once: the same as hang-avoid", 1500, 0, kind="hang", part="avoid", once=True)(Part)
named("hang-hard", "the planner computes for ever, once: while True: pass", 1500, 0, kind="compute", part="avoid", once=True)(Part)
named("exception-stop", "the planner raises an exception, and stopping the motors raises one as well", 100, 0, kind="exception", part="avoid", also="stop")(
    Part
)
named("memory-error", "the link raises MemoryError each time", kind="memory", part="link")(Part)
named("memory-error-avoid", "the planner raises MemoryError each time", 100, 0, kind="memory", part="avoid")(Part)
named("heap", "something eats the heap but for crumbs; it is counted when the motors pause", 5000, 0, kind="heap", part="link")(Part)
named("slow", "each turn of the loop takes 400 ms more", 1000, 0, kind="slow", part="link", us=400_000)(Part)
named("slow-150", "each turn of the loop takes 150 ms more", 500, 0, kind="slow", part="link", us=150_000)(Part)


@named("flood", "300 datagrams a second from somebody without the key", rate=300)
@named("flood-10000", "10 000 datagrams a second from somebody without the key", rate=10_000)
class Flood(Fault):
    """timed: taking a datagram in and checking its tag takes its time."""

    changes = _WIFI

    def __init__(self, rate, timed=True):
        self.files = {**board_file(kind="flood", rate=rate, datagram=list(_stranger()), timed=timed), "network.key": bytes(range(32))}


def _stranger():
    """A command to stop, with a tag that is wrong."""
    compat.install()
    from link.frames import frame

    return frame(_DRIVE, (1).to_bytes(4, "little") + bytes((0, 0, 0, 0, 0, 90)) + b"stranger")


@named("clock-29", "the clock of microseconds starts a second before 2^29 and runs past it", ticks=1 << 29)
@named("clock-30", "the clock of microseconds starts a second before 2^30, where it begins again at 0", ticks=1 << 30)
class Clock(Fault):
    at_start = True
    watched_s = 60.0

    def __init__(self, ticks):
        self.clock_us = ticks - 1_000_000
