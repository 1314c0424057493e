"""What can be known to be wrong before a run begins: said at once, not after 60 s in which nothing could move.

One place for the command line, for `host.link.twin` and so for the page of the monitor.
"""

import os
import shutil
from pathlib import Path

from . import courses, worlds
from .arm import Arm
from .arm import read as read_arm
from .process import ENGINES
from .run import load_config
from .vehicle import Vehicle
from .world import World

SHAPE = ("width", "gap", "seed", "mirror", "reverse", "angle", "scale", "length", "side", "start", "goal")
ENOUGH_MB = 50  # a minute of driving is recorded in 3 to 6 MB


def check(arguments):
    """Look over the arguments of `run.run`, a dict. ValueError says in one sentence what cannot be."""
    course, width, gap = arguments["course"], arguments.get("width"), arguments.get("gap")
    if worlds.is_file(course):
        for name in ("width", "gap", "reverse", "mirror", "side", "length"):
            if arguments.get(name):
                raise ValueError(f"{name} is for the courses; {course} is as its file says")
        if arguments.get("angle", 90) != 90:
            raise ValueError(f"an angle is for the bend; {course} is as its file says")
    if course == "random" and width not in (None, courses.DEFAULT_WIDTH["random"]):
        raise ValueError("a width is for the passages; of random the gap between its boxes is chosen")
    if course != "random" and gap is not None:
        raise ValueError(f"a gap is for random, whose boxes lie so far apart; {course} has a width")
    if (speed := arguments.get("speed")) is not None and not 0.01 <= speed <= 1000:
        raise ValueError(f"speed {speed:g} is out of range; 0.01 to 1000, or max, is accepted")
    engine = arguments.get("engine", ENGINES[0])
    if engine not in ENGINES:
        raise ValueError(f"engine {engine!r} is not known; engines are {', '.join(ENGINES)}")
    shape = {name: arguments[name] for name in SHAPE if arguments.get(name) is not None}
    layout = courses.make(course, **shape)
    vehicle = Vehicle.from_settings(load_config(arguments.get("config"), arguments.get("mode"), arguments.get("changes")))
    _body(vehicle, layout)
    _arm(arguments.get("arm"), vehicle)
    if arguments.get("record"):
        _file(Path(arguments["record"]), "recording")
        room(Path(arguments["record"]).parent)


def picture(path, option="--picture", ends=(".png", ".svg", ".pdf")):
    """A file in which the picture of a run can be drawn, checked before the run. ValueError says what is wrong."""
    path = Path(path)
    if path.suffix.lower() not in ends:
        raise ValueError(f"{option} {path}: the name must end in {' or '.join((', '.join(ends[:-1]), ends[-1]) if ends[1:] else ends)}")
    if path.is_dir():
        raise ValueError(f"{option} {path}: this is a folder; name a file in it")
    if not path.absolute().parent.is_dir():
        raise ValueError(f"{option} {path}: there is no folder {path.parent}; name a file in a folder that exists")
    if not os.access(path if path.exists() else path.absolute().parent, os.W_OK):
        raise ValueError(f"{option} {path}: it cannot be written there; name a file in a folder you may write to")


def room(folder, megabytes=ENOUGH_MB):
    """ValueError unless the disk of a folder, which may have to be made first, has room for a recording."""
    folder = Path(folder).absolute()
    while not folder.exists():
        folder = folder.parent
    free = shutil.disk_usage(folder).free // 1_000_000
    if free < megabytes:
        raise ValueError(f"the disk of {folder} has {free} MB left, {megabytes} are needed: make room, or do not record (--no-record)")


def _arm(path, vehicle):
    """ValueError for an arm that cannot be, or has no room on the servos' chip."""
    if path is None:
        return
    taken = sorted(set(Arm(read_arm(path) or {}).channels) & set(vehicle.servo_channels))
    if taken:
        free = [str(k) for k in range(16) if k not in vehicle.servo_channels]
        raise ValueError(f"{path}: servos.channels: output {taken[0]} of the servos' chip is a wheel's; free are {', '.join(free) or 'none'}")


def _body(vehicle, layout):
    """ValueError for a body that cannot be, or cannot be in this course."""
    if vehicle.axles[0] > vehicle.length / 2 or vehicle.axles[-1] < -vehicle.length / 2:
        end = "ahead of the nose" if vehicle.axles[0] > vehicle.length / 2 else "behind the tail"
        beyond = max(vehicle.axles[0], -vehicle.axles[-1]) - vehicle.length / 2
        raise ValueError(f"an axle lies {beyond:g} mm {end}: look at robot.length, axles.spacings and axles.first")
    if vehicle.width >= layout.width:
        raise ValueError(f"a body {vehicle.width:g} mm wide does not fit into {layout.name} with its {layout.width:g} mm")
    x, y, heading = layout.start
    overlap = -World(layout.segments).clearance(x, y, heading, vehicle.width / 2, vehicle.length / 2)[0]
    if overlap > 0:
        raise ValueError(f"the body of {vehicle.length:g} x {vehicle.width:g} mm stands in a wall at its start in {layout.name}: choose another start")


def _file(path, what):
    if path.exists():
        raise ValueError(f"{path} exists already: give another name, or remove it first; a {what} is never overwritten")
