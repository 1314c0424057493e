"""What a page may ask: each command's name, and whose part it is. A new panel's commands get a row here, and nothing else of the server changes.

TO_ROBOT    handed on over the link: (link, what). Refused where the link takes none, as a recording does.
HERE        answered by this computer: (station, what) -> message for the asker alone, or None.

what: the page's JSON object. KeyError, TypeError and ValueError become a message `refused` to the page that asked.
"""

from collections.abc import Callable
from functools import lru_cache

from host.link.base import Link


def _drive(link: Link, what: dict) -> None:
    link.drive(what["what"], float(what.get("af", 0)), float(what.get("ar", 0)), float(what.get("v", 90)))


def _twin(station):
    link = station.link
    if not hasattr(link, "set_pace"):
        raise ValueError("only the twin can be slowed, stopped in time, or have a box put in its way")
    return link


def _pace(station, what: dict) -> None:
    _twin(station).set_pace(None if what.get("speed") is None else float(what["speed"]), what.get("paused"), bool(what.get("step")))


def _box(station, what: dict) -> None:
    _twin(station).put_box(float(what["x"]), float(what["y"]), float(what["size"]))


def _touch(station, what: dict) -> None:
    _twin(station).touch(float(what["x"]), float(what["y"]))


def _arm(link: Link, what: dict) -> None:
    angles = [float(angle) for angle in what.get("angles", ())][:12]
    link.arm(str(what["what"]), approach=bool(what.get("approach")), joint=int(what.get("joint", 0)), angle=float(what.get("angle", 0)), angles=angles)


def _reach(link: Link, what: dict) -> None:
    data = bytes.fromhex(str(what["data"]))
    if len(data) > 190:
        raise ValueError("a piece of a trajectory has at most 190 bytes")
    link.reach(int(what["offset"]), data)


def _reaches() -> dict:
    """The trajectories in out/arm/; the page chooses among them, and names no file."""
    from host.arm.page import listing

    return listing()


@lru_cache(maxsize=1)
def _courses() -> dict:
    """What the twin can be asked for: its courses with their walls, for small pictures, and what can fail."""
    from host.link.twin import world_of
    from host.twin import courses, faults

    sizes = {name: ("gap", 100, 1500, 500) if name == "random" else ("width", 260, 3000, courses.DEFAULT_WIDTH.get(name, 550)) for name in courses.NAMES}
    return {
        "type": "courses",
        "list": [{"name": name, "walls": world_of(courses.make(name))["walls"], "size": sizes[name]} for name in courses.NAMES],
        "faults": [{"name": kind.name, "text": kind.text} for kind in sorted(faults.KINDS.values(), key=lambda kind: kind.name)],
    }


TO_ROBOT: dict[str, Callable[[Link, dict], None]] = {
    "drive": _drive,
    "tune": lambda link, what: link.tune(str(what["key"]), what["value"]),
    "keep": lambda link, what: link.keep(),
    "list": lambda link, what: link.request_parameters(),
    "watch": lambda link, what: link.watch(bool(what.get("scan")), bool(what.get("candidates")), bool(what.get("turns"))),
    "restart": lambda link, what: link.restart(),
    "go": lambda link, what: link.go(str(what["what"]), float(what.get("x", 0)), float(what.get("y", 0)), float(what.get("heading", 0))),
    "arm": _arm,
    "reach": _reach,
    "point": lambda link, what: link.point(int(what["wheel"]), float(what["angle"])),
}

HERE: dict[str, Callable] = {
    "compare": lambda station, what: station.compare(str(what.get("path") or "")),
    "run_again": lambda station, what: station.run_again(dict(what.get("set") or {})),
    "reaches": lambda station, what: _reaches(),
    "courses": lambda station, what: _courses(),
    "pace": _pace,
    "box": _box,
    "touch": _touch,
}
