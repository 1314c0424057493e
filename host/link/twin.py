"""The twin as a link: it runs in a thread, and the firmware's USB serial line is the wire.

    twin:COURSE?width=550&gap=400&seed=3&mirror=1&reverse=1&angle=90&scale=1&mode=naws&speed=1&chip=1&engine=cpython&config=robot.json&record=FILE
        &fault=NAME@SECONDS&autostart=0&length=2500&side=1&start=0,0,90&goal=0,3000&arm=arm.json&screen=usart-gpu

    twin:house?map=FILE&door=600&walled=1&boxes=3&pocket=1&person=1&shuts=9&opens=20&lost=1&method=gap&errand=0&start=0,0,90&goal=0,3000

COURSE is one of the twin's, in any case, house with its map (docs/goals.md), or the file of a world; every option may be left out. speed is 1, real time, unless given; "max" is as fast as it goes.
autostart=0 waits for a start, as the robot does after power-up. What the others mean: `python -m host.twin --help`.
"""

import shutil
import threading
import time
from collections.abc import Callable
from pathlib import Path

from link import protocol

from .address import AddressError
from .base import Link

KEPT = Path("out") / "twin" / "robot.json"  # what was kept in the twin last

_TRUTH_S = 0.04
_FARTHEST = 100_000.0  # mm, of a box
_SCREEN_S = 0.2  # no picture of the screen more often


def _speed(text):
    return None if text == "max" else float(text)


def _flag(text):
    return bool(int(text))


def _fault(text):
    from host.twin.faults import make

    try:
        make(text)
    except ValueError as error:
        raise AddressError(f"twin option fault={text}: {error}") from None
    return text


def _start(text):
    x, y, heading = (float(v) for v in text.split(","))
    return x, y, heading


def _goal(text):
    x, y = (float(v) for v in text.split(","))
    return x, y


def _screen(text):
    from host.twin.screen import KINDS

    if text not in KINDS:
        raise AddressError(f"twin option screen={text}: there are {', '.join(KINDS)}")
    return text


OPTIONS: dict[str, Callable] = {
    "width": float, "gap": float, "seed": int, "mirror": _flag, "reverse": _flag, "angle": float, "scale": float, "mode": str, "engine": str,
    "speed": _speed, "chip": float, "config": str, "firmware": str, "record": str, "fault": _fault, "autostart": _flag,
    "length": float, "side": _flag, "start": _start, "goal": _goal, "arm": str,
    "screen": _screen,
}  # fmt: skip


def _door(text):
    return text if text in ("shut", "open") else float(text)


# Of the course house, see host.twin.house.Plan; errand=0: it waits to be told where to go.
HOUSE: dict[str, Callable] = {
    "map": str, "door": _door, "walled": _flag, "boxes": int, "pocket": _flag, "person": _flag, "shuts": float, "opens": float, "lost": _flag, "method": str, "errand": _flag,
}  # fmt: skip


def _house(arguments: dict) -> dict:
    """Those arguments with the house's own as the Plan that `host.twin.run.run` takes."""
    from host.twin.house import Plan

    plan = {name: arguments.pop(name) for name in HOUSE if name in arguments}
    plan |= {name: arguments.pop(name) for name in ("start", "goal") if name in arguments}
    by_hand = not plan.pop("errand", True)
    return {**arguments, "house": Plan(**plan, by_hand=by_hand)}


def arguments_of(course: str, options: dict) -> dict:
    """Arguments of `host.twin.run.run`. Raises AddressError for a course or an option that does not exist."""
    from host.twin import courses, worlds

    house = course.lower() == "house"
    known = {**OPTIONS, **HOUSE} if house else OPTIONS
    names = {name.lower(): name for name in (*courses.NAMES, "house")}
    if course.lower() not in names and not worlds.is_file(course):
        raise AddressError(f"twin:{course}: courses are {', '.join(courses.NAMES)}, or the file of a world")
    arguments = {"course": names.get(course.lower(), course), "speed": 1.0}
    for key, text in options.items():
        if key not in known:
            raise AddressError(f"twin option {key!r}: there are {', '.join(known)}")
        try:
            arguments[key] = known[key](text)
        except AddressError:
            raise
        except ValueError:
            raise AddressError(f"twin option {key}={text}: a number is needed") from None
    changes: dict = {}
    if not arguments.pop("autostart", True):
        changes["drive.autostart"] = False
    if screen := arguments.pop("screen", None):
        changes["screen.kind"] = screen
    if changes:
        arguments["changes"] = changes
    return _house(arguments) if house else arguments


def world_of(course) -> dict:
    """Message `world` for a Course of the twin."""
    return {"type": "world", "walls": _rounded(course.segments), "course": course.name}


def _rounded(segments) -> list[list[float]]:
    return [[round(float(v), 1) for v in segment] for segment in segments]


class TwinLink(Link):
    """twin:COURSE[?OPTIONS]. Raises AddressError for a course or an option that does not exist."""

    def __init__(self, address: str, course: str, options: dict, begin: bool = True):
        super().__init__(address)
        from host.twin.check import check
        from host.twin.pace import Pace

        arguments = arguments_of(course, options)
        try:
            if "house" not in arguments:
                check(arguments)
        except ValueError as error:
            raise AddressError(f"{address}: {error}") from None
        self.pace = arguments["speed"] = Pace(arguments["speed"])
        self._outgoing: list[bytes] = []
        self._guard = threading.Lock()
        self._open = True
        self._told = False
        self._touches: list[tuple[float, float]] = []
        self._shown, self._shown_s = -1, 0.0  # of the screen: what was told of it last, and when
        self._held = "drive.autostart" in arguments.get("changes", {})  # a person drives it, or has stopped it, or has not started it yet
        self._looked = 0.0
        self._folder: Path | None = None
        self._box_wanted: tuple[float, float, float] | None = None
        self._box = (0.0, 0.0, 0.0)
        watch = _observer(self._receive, self._outgo, self._look, self._board)
        self._thread = threading.Thread(target=self._run, args=(arguments, watch), daemon=True)
        self._begun = False
        if begin:
            self.begin()

    def begin(self) -> None:
        with self._guard:
            if self._begun:
                return
            self._begun = True
        self._thread.start()
        self._tell_pace()
        self.greet()

    def kept(self) -> str:
        """The twin's board is gone after its run: what it kept is copied to where the next run can be told to read it."""
        if self._folder is None:
            return ""
        KEPT.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(self._folder / "robot.json", KEPT)
        return str(KEPT)

    def set_pace(self, speed: float | None = None, paused: bool | None = None, step: bool = False) -> None:
        """Slow motion (speed, factor on real time), a pause, or one decision and a pause; tells `pace`."""
        if speed is not None:
            if not 0.01 <= speed <= 100:
                raise ValueError(f"speed {speed:g}: 0.01 to 100 times real time")
            self.pace.speed = speed
        if step:
            self.pace.step()
        elif paused is not None:
            self.pace.pause() if paused else self.pace.go_on()
        self._tell_pace()

    def put_box(self, x: float, y: float, size: float) -> None:
        """A box, `size` mm, into the robot's way (0: none); tells `box`, and a `text` if it stays where it was."""
        if size and not 40 <= size <= 400:
            raise ValueError(f"a box of {size:g} mm: 40 to 400 mm")
        if not (abs(x) <= _FARTHEST and abs(y) <= _FARTHEST):
            raise ValueError(f"a box at {x:g}, {y:g} mm: at most {_FARTHEST / 1000:g} m away")
        self._box_wanted = (x, y, size)

    def touch(self, x: float, y: float) -> None:
        """A finger on the robot's screen, pixels from its upper left."""
        self._touches.append((x, y))

    def _look_at_screen(self, simulation) -> None:
        """Touch it, and tell `screen` when it looks different."""
        screen = simulation.screen
        if screen is None:
            return
        while self._touches:
            screen.touch(simulation.now, *self._touches.pop(0))
        now = time.monotonic()
        if screen.glass.changes != self._shown and now - self._shown_s >= _SCREEN_S:
            self._shown, self._shown_s = screen.glass.changes, now
            wide, high = screen.glass.image.size
            self._put({"type": "screen", "png": screen.glass.png(), "wide": wide, "high": high})

    def _tell_pace(self) -> None:
        self._put({"type": "pace", "speed": self.pace.speed, "paused": self.pace.paused})

    def _take(self, kind: int, sequence: int, payload: bytes) -> None:
        super()._take(kind, sequence, payload)
        if kind == protocol.DECISION:
            before = self.pace.paused
            self.pace.decided()
            if self.pace.paused != before:
                self._looked = 0.0  # where the robot is now is told at once
                self._tell_pace()

    def _move_box(self, simulation) -> None:
        wanted, self._box_wanted = self._box_wanted, None
        if wanted is None:
            return
        try:
            simulation.put_box(*wanted)
            self._box = wanted
        except ValueError as error:
            self._put({"type": "text", "text": str(error)})
        x, y, size = self._box
        self._put({"type": "box", "x": x, "y": y, "size": size})

    def close(self) -> None:
        self._open = False
        if self._begun:
            self._thread.join(5)

    def drive(self, what: str, af: float = 0, ar: float = 0, v: float = 90) -> None:
        super().drive(what, af, ar, v)
        self._held = what != "auto"

    def _run(self, arguments: dict, watch) -> None:
        from host.twin.run import run
        from host.version import python

        try:
            result = run(**arguments, watch=watch)
        except Exception as error:  # whatever goes wrong in there ends the link, and is told
            self._end(f"the twin could not run: {error}")
            return
        text = f"{result.result} after {result.time_s:.1f} s, least clearance {result.min_clearance_mm:.0f} mm, contacts {result.contacts}"
        text += f" ({result.reason})" if result.reason else ""
        text += f"; {result.lost}" if result.lost else ""
        self._end(text + (f"; recorded, to replay it: {python()} -m host.replay {result.recording}" if result.recording else ""))

    def _send(self, data: bytes) -> None:
        with self._guard:
            self._outgoing.append(data)

    def _outgo(self) -> bytes:
        if not self._outgoing:
            return b""
        with self._guard:
            data, self._outgoing = b"".join(self._outgoing), []
        return data

    def _board(self, folder: Path) -> None:
        self._folder = folder

    def _look(self, simulation) -> None:
        """Tell the world once, and where the robot really is."""
        if not self._open:
            raise KeyboardInterrupt  # the twin's way to be told to end
        self._move_box(simulation)
        self._look_at_screen(simulation)
        simulation.endless = self._held  # by hand a run never ends
        if self._held:
            # The time that a course may take is the robot's, not the person's.
            simulation.limit = simulation.now + simulation.limit_us
        if not self._told:
            self._told = True
            self._put(world_of(simulation.course))
        now = time.monotonic()
        if now - self._looked >= _TRUTH_S:
            self._looked = now
            body = simulation.body
            if (moving := simulation.scene.moving) is not None:
                self._put({"type": "moving", "walls": _rounded(moving)})
            self._put({
                "type": "truth", "x": round(float(body.x), 1), "y": round(float(body.y), 1), "heading": round(float(body.heading) * 57.29578, 2),
                "clearance": round(float(simulation.contact.clearance()), 1), "time": simulation.now / 1e6,
            })  # fmt: skip


def _observer(receive, outgo, look, board):
    """An Observer of the twin that passes bytes on, both ways. receive(bytes), outgo() -> bytes, look(simulation), board(folder)."""
    from host.twin import Observer

    class Passing(Observer):
        def board(self, folder):
            board(folder)

        def serial(self, data):
            receive(data)

        def commands(self):
            return outgo()

        def step(self, simulation):
            look(simulation)

    return Passing()
