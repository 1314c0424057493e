"""A recording as MCAP, with the schemas Foxglove knows.

    topic          schema                    content
    /scan          foxglove.LaserScan        one revolution, in the frame `body`
    /pose          foxglove.PoseInFrame      where the robot really was (recordings of the twin), in the frame `world`
    /odometry      foxglove.PoseInFrame      where it thought it was, in the frame `odometry`
    /tf            foxglove.FrameTransform   one tree: world -> odometry -> body; world is left out where the true pose is not known
    /points        foxglove.PointCloud       the points of the windows, each in its window's colour
    /scene         foxglove.SceneUpdate      the body, its windows, its wheels as they are turned, the steering that was chosen as far as it is free, and the
                                             walls of a course of the twin
    /decision      gapseeker.decision        JSON, for plots: af, ar (deg), v, window, zone, free (mm), why in words, ...
    /wheels        gapseeker.wheels          JSON: ten angles (deg) and speeds (mm/s)
    /health        gapseeker.health          JSON
    /log           foxglove.Log              events and what the robot logged

Times are those of the recording, from 0. robot.json is an attachment; where the recording comes from is metadata.
"""

import json
from collections.abc import Callable
from pathlib import Path

from host.recording import Reader, Stream
from params import schema
from params.values import ConfigError

from . import frames, plan, shapes
from .scans import Scan, ScanReader, evenly
from .timeline import timeline, word
from .topics import Topics


class Exporter:
    """Puts the scans and messages of a recording on their topics.

    robot: robot.json as a dict. reasons: texts of a decision's `why`.
    """

    def __init__(self, topics: Topics, robot: dict, reasons: tuple[str, ...]):
        self._topics = topics
        self._lidar = robot.get("lidar", {})
        self._reasons = reasons
        self._true: tuple[float, float, float] | None = None  # the latest true pose, and the latest believed one
        self._believed: tuple[float, float, float] | None = None
        self._places = wheel_places(robot.get("axles", {}))
        self._margins = margins(robot)
        self._size = 0.0, 0.0
        self._takers: dict[str, Callable] = {
            "truth": self._truth, "pose": self._odometry, "points": self._points, "scan": self._told_scan, "decision": self._decision,
            "wheels": self._wheels, "health": self._numbers, "event": self._event, "text": self._event, "log": self._log,
            "world": self._world, "hello": self._hello, "names": self._names,
        }  # fmt: skip

    def message(self, moment: float, message: dict) -> None:
        """One message at `moment` s; one of a type that has no topic is left out."""
        taker = self._takers.get(message["type"])
        if taker:
            taker(moment, message)

    def scan(self, moment: float, scan: Scan) -> None:
        """One revolution."""
        ranges, signals = evenly(scan)
        self._topics.write("/scan", moment, shapes.laser_scan(ranges, signals, self._lidar.get("x", 0), self._lidar.get("y", 0)))

    def body(self, moment: float, width: float, length: float) -> None:
        """The size of the body, mm."""
        self._size = width, length
        self._topics.write("/scene", moment, shapes.body(width, length))
        self._topics.write("/scene", moment, shapes.windows(width, length, self._margins(length)))

    def _truth(self, moment, message):
        self._true = where = message["x"], message["y"], message["heading"]
        self._topics.write("/pose", moment, shapes.pose("world", *where))
        believed = self._believed or (0.0, 0.0, 0.0)
        # What is believed of the body stays; where that frame lies in the world makes up for its error.
        self._topics.write("/tf", moment, shapes.transform("world", "odometry", *frames.parent_of(where, believed)))
        if self._believed is None:
            self._topics.write("/tf", moment, shapes.transform("odometry", "body", *believed))

    def _odometry(self, moment, message):
        self._believed = where = message["x"], message["y"], message["heading"]
        self._topics.write("/odometry", moment, shapes.pose("odometry", *where))
        self._topics.write("/tf", moment, shapes.transform("odometry", "body", *where))
        if self._true:
            self._topics.write("/tf", moment, shapes.transform("world", "odometry", *frames.parent_of(self._true, where)))

    def _points(self, moment, message):
        self._topics.write("/points", moment, shapes.points(message["x"], message["y"], message["window"]))

    def _told_scan(self, moment, message):
        times = message.get("times") or [0.0]
        turn = times[-1] - times[0]  # the robot's clock wraps: then it is not known how long the turn took
        self.scan(moment - turn / 2 if 0 < turn < 1 else moment, Scan(message["bearings"], message["distances"], [0] * len(message["bearings"])))

    def _decision(self, moment, message):
        number = message["why"]
        self._topics.write_json("decision", moment, {**message, "why": word(self._reasons, number), "why_number": number})
        if self._places and self._size[0]:
            span = self._places[0][1] - self._places[-1][1]
            way = plan.way(message["af"], message["ar"], message["v"], message["free"], span)
            self._topics.write("/scene", moment, shapes.plan(way, *self._size))

    def _numbers(self, moment, message):
        self._topics.write_json(message["type"], moment, message)

    def _wheels(self, moment, message):
        self._numbers(moment, message)
        if len(self._places) == len(message["angles"]):
            self._topics.write("/scene", moment, shapes.wheels(self._places, message["angles"]))

    def _event(self, moment, message):
        self._topics.write("/log", moment, shapes.log(0, message["text"]))

    def _log(self, moment, message):
        self._topics.write("/log", moment, shapes.log(message["level"], message["text"]))

    def _world(self, moment, message):
        self._topics.write("/scene", moment, shapes.walls(message["walls"]))

    def _hello(self, moment, message):
        self._places = wheel_places(message) or self._places
        if "width" in message and "length" in message:
            self.body(moment, message["width"], message["length"])

    def _names(self, moment, message):
        self._reasons = tuple(message["reasons"])


def wheel_places(axles: dict) -> list[tuple[float, float]]:
    """(x, y) in the body, mm, of the wheels, left and right of each axle from the front; [] where the axles are not told in full.

    axles: the section of robot.json, or a HELLO, which names its keys alike.
    """
    spacings, track, first = (axles.get(name) for name in ("spacings", "track", "first"))
    if not isinstance(spacings, list) or not isinstance(track, int | float) or not all(isinstance(one, int | float) for one in spacings):
        return []
    y = first if isinstance(first, int | float) else sum(spacings) / 2
    places = []
    for spacing in (0, *spacings):
        y -= spacing
        places += [(-track / 2, y), (track / 2, y)]
    return places


def margins(robot: dict) -> Callable[[float], dict[str, tuple[float, float]]]:
    """The windows' margins (mm beside, mm ahead and behind) for a body's length; what robot.json does not say has its default."""
    given = robot.get("windows", {})

    def found(length):
        values = {row[0]: row[2] for row in schema.rows(schema.LIVE)}
        red, blue, side, ahead = (given.get(name, values[f"windows.{name}"]) for name in ("red", "blue", "side", "look_ahead"))
        return {"red": (red, red), "blue": (blue, blue), "yellow": (side, length * 3 // 2 if ahead is None else ahead)}

    return found


def export(reader: Reader, target: Path, lacks: list[str] | None = None) -> int:
    """Write the whole recording; returns the number of messages. lacks: takes sentences about what the recording does not have."""
    lacks = [] if lacks is None else lacks
    header = reader.header
    robot = _settings(header.robot, lacks)
    with open(target, "wb") as file:
        topics = Topics(file)
        attached = {"robot.json": header.robot.encode()} if header.robot else {}
        topics.describe({"source": header.source, "firmware": header.firmware, "clock": header.clock}, attached)
        exporter = Exporter(topics, robot, header.reasons)
        size = robot.get("robot", {})
        if "width" in size and "length" in size:
            exporter.body(0, size["width"], size["length"])
        scans = _scan_reader(header.robot) if robot else None
        if scans is None:
            lacks.append("what the bytes of the lidar need to become scans; /scan holds what the robot told, if somebody asked it to")
        else:
            for record in reader.stream(Stream.LIDAR):
                for scan in scans.take(record):
                    end = record.time_us / 1e6
                    # The schema has one time for all beams: in the middle the error is half as large, and of either sign.
                    exporter.scan((scan.began + end) / 2 if scan.began is not None else end, scan)
        for moment, message in timeline(reader):
            exporter.message(moment, message)
        topics.finish()
        if "/pose" not in topics.names:
            lacks.append("the true pose, which only the twin knows: /tf is the odometry's")
        if "/scan" not in topics.names:
            lacks.append("scans: they are told to whoever asks for raw scans")
        return topics.count


def _settings(text: str, lacks: list[str]) -> dict:
    """robot.json as a dict of sections; {} where it is missing or no such thing."""
    try:
        robot = json.loads(text)
        sections = {name: section for name, section in robot.items() if isinstance(section, dict)}
    except (ValueError, AttributeError, RecursionError):
        lacks.append("robot.json" + (": what it has is none" if text else ""))
        return {}
    sizes = sections.get("robot", {}), sections.get("lidar", {})
    for section, names in zip(sizes, (("width", "length"), ("x", "y"))):
        for name in names:
            if name in section and not isinstance(section[name], int | float):
                lacks.append(f"a number for {name} in robot.json")
                del section[name]
    return sections


def _scan_reader(robot: str) -> ScanReader | None:
    """None where robot.json is not what this firmware takes, or not all of it is known."""
    try:
        return ScanReader(robot)
    except ConfigError:
        return None
