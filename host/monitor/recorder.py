"""Records a link: its bytes both ways, and where the twin really was, with the time of this computer."""

import json
import threading
import time
from pathlib import Path

from host import recording
from host.link.base import Link
from host.recording import Pose, Stream


class LinkRecorder:
    """Records from its making until `close`. Raises RecordingError if the file cannot be written.

    known: the latest message of each type; parameters: {key: message}. What they tell of robot.json is put into the header.
    trouble: called once with a sentence when nothing more can be written (a full disk); the link goes on without.
    """

    def __init__(self, path: str | Path, link: Link, source: str, known: dict, parameters: dict, trouble=lambda text: None):
        hello = known.get("hello", {})
        robot = settings_told(hello, parameters)
        header = recording.Header(
            firmware=str(hello.get("firmware", "unknown")),
            robot=json.dumps(robot, indent=2) if robot else "",
            source=source,
            clock="host",
            reasons=tuple(known.get("names", {}).get("reasons", ())),
            notes={"hello": hello, "robot": "as far as the robot tells it over its link; the rest are the defaults"},
        )
        self.path = Path(path)
        self._link = link
        self._trouble = trouble
        self._writer = recording.Writer(path, header)
        self._began = time.monotonic()
        self._lock = threading.Lock()
        link.taps.append(self._tap)

    def message(self, message: dict) -> None:
        """A message of the link that is not among its bytes."""
        if message["type"] == "ended":
            self._write(Stream.EVENT, message["text"].encode())
        elif message["type"] == "truth":
            self._write(Stream.POSE, Pose(message["x"], message["y"], message["heading"]).pack())

    def close(self) -> None:
        if self._tap in self._link.taps:
            self._link.taps.remove(self._tap)
        with self._lock:
            try:
                self._writer.close()
            except OSError:
                pass  # what is there can be read all the same

    def _tap(self, direction: str, data: bytes) -> None:
        self._write(Stream.TELEMETRY if direction == "in" else Stream.COMMAND, data)

    def _write(self, stream: Stream, data: bytes) -> None:
        with self._lock:
            if self._writer.closed:
                return
            try:
                self._writer.write(stream, int((time.monotonic() - self._began) * 1e6), data)
                return
            except OSError as error:
                text = f"recording into {self.path} has ended: {error.strerror}"
                self._writer.abandon()
        self._trouble(text)


def settings_told(hello: dict, parameters: dict) -> dict:
    """robot.json as a dict, as far as a robot's HELLO and PARAMETERs tell it; {} before there was any."""
    settings: dict = {}
    for name, key in (
        ("width", "robot.width"), ("length", "robot.length"), ("track", "axles.track"), ("spacings", "axles.spacings"), ("first", "axles.first"),
        ("full_speed", "motors.full_speed"),
    ):  # fmt: skip
        if name in hello:
            _put(settings, key, hello[name])
    for name, value in zip(("lidar.x", "lidar.y"), hello.get("lidar", ())):
        _put(settings, name, value)
    trims = {}
    for key, message in parameters.items():
        if key.startswith("servos.trims."):
            trims[int(key.rpartition(".")[2])] = message["value"]
        elif key.count(".") == 1:
            _put(settings, key, message["value"])
    if trims and sorted(trims) == list(range(len(trims))):
        _put(settings, "servos.trims", [trims[wheel] for wheel in range(len(trims))])
    return settings


def _put(settings: dict, key: str, value) -> None:
    section, _, name = key.partition(".")
    settings.setdefault(section, {})[name] = value
