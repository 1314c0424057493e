"""One run of the twin from Python: what the command line, the experiments and the bench call."""

import json
import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from itertools import pairwise
from math import degrees, radians
from pathlib import Path
from typing import Any

import numpy as np

from . import arm as arms
from . import best as best_times
from . import courses, faults, image, process, wire, worlds
from .errand import Errand
from .house import build as house_of
from .pace import Pace
from .process import FirmwareStopped, Process
from .recorder import Observers, Recorder
from .simulation import BLOCKED, PASS, TIMEOUT, Observer, Simulation
from .vehicle import Vehicle

MODES = ("aws", "naws")
STANDS = 90  # V


@dataclass
class Result:
    """What a run gave.

    track: (n, 4) time s, x mm, y mm, heading deg (clockwise from +y), not more often than 100 a second. log: the
    decisions, see `host.recording.Decision`. contacts: by the robot's own motion; touched_by: how often a box that moves met the robot while it stood.
    first_motion_s: when the first motor register was switched on. stops: how often the motors were off between then and the end. reversals: how often the decided speed
    changed its sign. path_mm: way of the body's centre. steering_deg: sum of the changes of AF and AR decided.
    touches: (time s, x, y, heading deg) where each contact of its own began. fault: what it showed of its fault. glass: what its screen shows (screen.Glass), None without one. recording: file of the
    recording, if there is one. lost: why it broke off, if it did.
    """

    course: str
    width_mm: float
    gap_mm: float
    seed: int
    mode: str
    engine: str
    result: str
    reason: str
    time_s: float
    min_clearance_mm: float
    contacts: int
    touched_by: int
    scrub_mm_s: float
    decisions: int
    first_motion_s: float | None
    stops: int
    reversals: int
    path_mm: float
    steering_deg: float
    wall_s: float
    overflows: int
    recording: str | None
    lost: str
    track: np.ndarray = field(repr=False)
    log: list = field(repr=False)
    touches: list = field(repr=False)
    fault: faults.Outcome | None
    layout: courses.Course = field(repr=False)
    vehicle: Vehicle = field(repr=False)
    house: dict | None = None
    errand: object = field(repr=False, default=None)
    glass: Any = field(default=None, repr=False)

    def against_best(self):
        """{best_s, time_over_best}: the least time from this start (see `best`), and how many times that it took from the first motor register on. None where no way leads
        to the goal; the second also where the run did not get there."""
        x, y, heading = self.track[0, 1:]
        least = best_times.seconds(self.layout, self.vehicle, (x, y, radians(heading)), self.vehicle.cruise)
        over = None
        if self.result == PASS and least and self.first_motion_s is not None:
            over = round((self.time_s - self.first_motion_s) / least, 3)
        return {"best_s": least, "time_over_best": over}

    def summary(self, best=False):
        """The figures as a dict that JSON can hold. best: with those of against_best(), which for a new course takes a second or some."""
        out = {}
        for name, value in vars(self).items():
            if name in ("house", "errand", "track", "log", "touches", "fault", "layout", "vehicle", "lost", "glass"):
                continue
            out[name] = round(value, 3) if isinstance(value, float) else value
        if best:
            out |= self.against_best()
        if self.fault is not None:
            out |= vars(self.fault)
        if self.house is not None:
            out |= self.house
        return out


def run(
    course="Z",
    width=None,
    gap=500.0,
    seed=0,
    mode=None,
    engine="micropython",
    speed=None,
    config=None,
    watch=None,
    mirror=False,
    reverse=False,
    angle=90.0,
    scale=1.0,
    changes=None,
    firmware=image.FIRMWARE,
    limit_s=None,
    record=None,
    heap=None,
    chip=None,
    clock_us=0,
    fault=None,
    length=None,
    side=False,
    start=None,
    goal=None,
    arm=None,
    house=None,
):
    """Drive one course; returns a Result.

    course, width, gap, mirror, reverse, angle, scale, length, side, start, goal: see `courses.make`. seed: of the robot's imperfections and the noise; other than 0
    it perturbs the start as well. mode: "aws" or "naws", None as robot.json says. speed: factor on real time, None = as fast as
    possible. config: path of robot.json, or a dict. changes: {"section.key": value} put over it; the robot drives off by itself
    unless they say {"drive.autostart": False}. watch: simulation.Observer, told what
    happens; KeyboardInterrupt and FirmwareStopped end the run, not the caller. limit_s: ends the run after so long, where it would be 60 s, or 200 in a world from a file.
    heap, clock_us: of the board, see `Process`. chip: factor on the speed of an ESP32, math.inf = computing takes no time, None = process.CHIP.
    house: house.Plan, for the course house. arm: path of arm.json, or a dict, of a robot with an arm.
    fault: what fails, NAME or NAME@SECONDS, see `faults`; the run then ends 20 s after that at the latest.
    record: file for a recording of the run; None records into out/ended-badly/ and keeps that only if the run ends badly; False never records.
    """
    began = time.monotonic()
    chip = process.CHIP if chip is None else chip
    failing = faults.make(fault)
    settings = load_config(config, mode, {**starting(firmware), **failing.changes, **(changes or {})})
    vehicle = Vehicle.from_settings(settings)
    shape = dict(gap=gap, seed=seed, mirror=mirror, reverse=reverse, angle=angle, scale=scale, length=length, side=side, start=start, goal=goal)
    layout, errand, watch = _world(course, width, shape, house, failing, watch or Observer())
    course = layout.name if isinstance(course, courses.Course) else course
    text = json.dumps(settings)
    arm, files, notes = _with_arm(arm, dict(failing.files), {"engine": engine, "chip": str(chip)})
    address = _address(course, layout, chip, shape) + (f"&fault={fault}" if fault else "")
    with ExitStack() as stack:
        recorder = None
        if record is not False:
            recorder = stack.enter_context(Recorder.begin(record, text, address, firmware, notes))
            watch = Observers(recorder, watch)
        simulation = Simulation(layout, vehicle, seed, watch, fault=failing, arm=arm)
        if limit_s:
            simulation.limit = simulation.limit_us = max(simulation.limit, limit_s * 1e6)
        child = Process(engine, text, watch.serial, firmware, heap, chip, failing.clock_us or clock_us, files)
        stack.callback(child.close)
        watch.board(child.folder)
        ended, over = _watched(simulation, child, watch, speed, limit_s, failing)
        child.close()  # what it printed last belongs to the recording
        badly = ended and simulation.result != PASS
        kept = recorder.finish(simulation.result, simulation.reason, badly) if recorder else None
    figures = dict(
        fault=failing.outcome(simulation, over) if fault else None,
        course=course,
        width_mm=layout.width,
        gap_mm=gap,
        seed=seed,
        mode=settings.get("mode", "AWS").lower(),
        engine=engine,
        wall_s=time.monotonic() - began,
        **_kept(kept, recorder),
        **({"house": errand.facts(simulation), "errand": errand} if errand else {}),
    )
    return _result(simulation, layout, vehicle, figures)


def _with_arm(arm, files, notes):
    """(arms.Arm or None, the board's files, notes of the recording)."""
    settings = arms.read(arm)
    if settings is None:
        return None, files, notes
    text = json.dumps(settings)
    return arms.Arm(settings), files | {"arm.json": text.encode()}, notes | {"arm": text}


def _kept(kept, recorder):
    return {"recording": str(kept) if kept else None, "lost": recorder.lost if recorder else ""}


def _world(course, width, shape, house, failing, watch):
    """(Course, Errand where it is a house, who is told what happens). The house's map is put on the board."""
    if house is None:
        return courses.make(course, width, **shape), None, watch
    built = house_of(house, shape["seed"])
    failing.files = {**failing.files, "map.bin": built.map_bytes}
    errand = Errand(built, house)
    return built.course, errand, Observers(errand, watch)


def _watched(simulation, child, watch, speed, limit_s, failing):
    """Drive; returns (False if a person ended it, True if the firmware did)."""
    try:
        return _drive(simulation, child, watch, speed, limit_s), False
    except FirmwareStopped as stopped:
        if failing.began is not None:
            simulation.go_on(failing.began + failing.watched_s * 1e6)  # the chips do what they were told last
        simulation.result, simulation.reason = BLOCKED, str(stopped)
        return True, True
    except KeyboardInterrupt:
        simulation.stop(TIMEOUT, "interrupted")
        return False, False


def _address(course, layout, chip, shape):
    """The run as an address: twin:z?width=550&seed=3."""
    usual = dict(width=None, gap=500, seed=0, mirror=False, reverse=False, angle=90, scale=1, length=None, side=False, start=None, goal=None, chip=process.CHIP)
    given = dict(width=None if worlds.is_file(course) else layout.width, **shape, chip=chip)
    place = str(Path(course).resolve()) if worlds.is_file(course) else course.lower()
    return f"twin:{place}?" + "&".join(f"{name}={_text(value)}" for name, value in given.items() if value != usual[name])


def _text(value):
    return ",".join(f"{v:g}" for v in value) if isinstance(value, tuple) else f"{value:g}"


def starting(firmware):
    """The changes to robot.json with which the firmware in the folder drives off by itself. Older ones always did, and do not know the word."""
    schema = Path(firmware) / "lib" / "params" / "schema.py"
    return {"drive.autostart": True} if schema.exists() and "drive.autostart" in schema.read_text() else {}


def load_config(config=None, mode=None, changes=None):
    """robot.json as a dict, with the mode and the changes put over it. ValueError names the file and what is wrong."""
    if isinstance(config, dict):
        settings = json.loads(json.dumps(config))
    else:
        path = Path(config or image.FIRMWARE / "robot.json")
        try:
            settings = json.loads(path.read_text())
        except OSError as error:
            raise ValueError(f"{path} cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise ValueError(f"{path} is not JSON: {error}") from None
        if not isinstance(settings, dict):
            raise ValueError(f"{path} must hold a JSON object")
    if mode is not None:
        if mode.lower() not in MODES:
            raise ValueError(f"mode {mode!r} is not known; modes are {', '.join(MODES)}")
        settings["mode"] = mode.upper()
    for name, value in (changes or {}).items():
        *sections, key = name.split(".")
        place = settings
        for section in sections:
            place = place.setdefault(section, {})
        place[key] = value
    return settings


def _drive(simulation, child, watch, speed, limit_s):
    """True when the run came to its own end, False when the limit cut it."""
    pace = speed if isinstance(speed, Pace) else Pace(speed)
    while simulation.result is None:
        request = child.receive()
        answer = simulation.serve(request)
        watch.step(simulation)
        while not pace.wait(simulation.now):
            watch.step(simulation)
        if limit_s and simulation.now > limit_s * 1e6:
            simulation.stop(TIMEOUT, f"{limit_s:g} s are over")
            return False
        commands = watch.commands()
        if commands:
            watch.command(commands)
            child.send_serial(commands)
        if simulation.result is not None:
            break
        if cause := simulation.fault.take_reset():
            child.leave(simulation.fault.left_behind)
            request = child.reset(cause, forget=simulation.fault.forgets)
            simulation.serve(request)
        if request.kind == wire.RESET:
            child.restart()
            simulation.fault.restarted()
        else:
            child.answer(*answer)
    return True


def _motion(simulation, track):
    """Figures of how it drove."""
    began = [time for time, on in simulation.electronics.switched if on]
    driven = [decision for decision in simulation.decisions if decision.v != STANDS]
    pairs = list(pairwise(driven))
    return dict(
        first_motion_s=began[0] / 1e6 if began else None,
        stops=max(len(began) - 1, 0),
        reversals=sum((one.v > STANDS) != (other.v > STANDS) for one, other in pairs),
        path_mm=float(np.hypot(*np.diff(track[:, 1:3], axis=0).T).sum()),
        steering_deg=sum(abs(one.af - other.af) + abs(one.ar - other.ar) for one, other in pairs) / 10,
    )


def _result(simulation, layout, vehicle, figures):
    body = simulation.body
    times, poses = body.times[: body.count], body.poses[: body.count]
    keep = np.unique(np.searchsorted(times, np.arange(0, times[-1] + 1e4, 1e4)).clip(0, body.count - 1))
    track = np.column_stack([times[keep] / 1e6, poses[keep, :2], np.degrees(poses[keep, 2])])
    return Result(
        **figures,
        **_motion(simulation, track),
        result=simulation.result,
        reason=simulation.reason,
        time_s=float(body.now) / 1e6,
        min_clearance_mm=float(min(simulation.contact.nearest, simulation.met.nearest)),
        contacts=len(simulation.contact.touches) + len(simulation.met.touches),
        touched_by=len(simulation.met.touched_by),
        scrub_mm_s=float(body.mean_scrub),
        decisions=simulation.decisions[-1].number if simulation.decisions else 0,
        overflows=simulation.overflows,
        track=track,
        log=simulation.decisions,
        touches=[(t.time / 1e6, t.x, t.y, degrees(t.heading)) for t in simulation.contact.touches + simulation.met.touches],
        layout=layout,
        vehicle=vehicle,
        glass=simulation.screen and simulation.screen.glass,
    )
