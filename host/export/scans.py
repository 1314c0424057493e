"""Recorded lidar bytes -> whole revolutions, through the firmware's own parser."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, field

from host.recording import Record
from lidar import Lidar
from params.config import Config

QUARTER_MM = 0.25
_MEASUREMENT = b"\x61\xad"  # in a frame's header, before the number of parameter bytes


@dataclass
class Scan:
    """One revolution. began: s, when its first frame came in. bearings: degrees, body frame. distances: mm, 0 where nothing came back. signals: 0..255."""

    bearings: list[float] = field(default_factory=list)
    distances: list[float] = field(default_factory=list)
    signals: list[int] = field(default_factory=list)
    began: float | None = None


def _distances(points: bytearray) -> bytes:
    """The distances among a frame's points (1 byte of signal strength, 2 of distance each), bytes as sent."""
    kept = bytearray(points)
    del kept[::3]
    return bytes(kept)


class _Wire:
    """Recorded bytes as the UART the parser reads."""

    def __init__(self):
        self.waiting = b""
        self._read = bytearray()

    def any(self) -> int:
        return len(self.waiting)

    def readinto(self, buffer) -> int:
        count = min(len(buffer), len(self.waiting))
        buffer[:count] = self.waiting[:count]
        self._read += self.waiting[:count]
        self.waiting = self.waiting[count:]
        return count

    def signals(self, distances: list[int]) -> list[int]:
        """Signal strengths of the frame that the parser just took, known by its distances (quarter mm): the firmware itself has no use for them."""
        wanted = b"".join(b"%c%c" % (distance >> 8, distance & 255) for distance in distances)
        size = 3 * len(distances)
        at = self._read.find(_MEASUREMENT)
        while at >= 0:
            # Behind the header and speed, offset and start angle; the Delta-2D has an end angle besides.
            for begin in (at + 9, at + 11):
                points = self._read[begin : begin + size]
                if len(points) == size and _distances(points) == wanted:
                    del self._read[: begin + size]
                    return list(points[::3])
            at = self._read.find(_MEASUREMENT, at + 1)
        return [0] * len(distances)


class ScanReader:
    """Gathers frames into revolutions. robot: text of robot.json, which says where the lidar's zero is and how it turns."""

    def __init__(self, robot: str):
        config = Config(json.loads(robot))
        self._wire = _Wire()
        self._lidar = Lidar(self._wire, None, config)
        self._frames = config.lidar_frames
        self._scan = Scan()
        self._count = 0

    def take(self, record: Record) -> Iterator[Scan]:
        """The revolutions that a lidar record completes."""
        self._wire.waiting += record.data
        lidar = self._lidar
        while lidar.poll(record.time_us & 0x3FFFFFFF):
            scan = self._scan
            if scan.began is None:
                scan.began = record.time_us / 1e6
            scan.bearings += [bearing / 10 for bearing in lidar.bearings[: lidar.n]]
            scan.distances += [distance * QUARTER_MM for distance in lidar.distances[: lidar.n]]
            scan.signals += self._wire.signals(list(lidar.distances[: lidar.n]))
            self._count += 1
            if self._count == self._frames:
                yield scan
                self._scan, self._count = Scan(), 0


def evenly(scan: Scan) -> tuple[list[float], list[float]]:
    """(distances in m, signals) in as many even steps as there are points, from -pi counter-clockwise; infinite where nothing came back.

    The schema of a scan knows only even steps, while the number of points of the lidar's frames changes with its speed.
    """
    count = len(scan.bearings)
    ranges = [float("inf")] * count
    signals = [0.0] * count
    for bearing, distance, signal in zip(scan.bearings, scan.distances, scan.signals):
        place = round((180 - bearing) * count / 360) % count
        if distance and distance / 1000 < ranges[place]:
            ranges[place] = distance / 1000
            signals[place] = float(signal)
    return ranges, signals
