"""Each function takes hostile bytes in; it returns if all went as declared, and raises whatever should not have come out."""

import copy
import json
import struct
import tempfile
import zlib
from pathlib import Path

from host import recording
from host.link import messages
from host.link.base import Link
from host.link.playback import story
from host.recording import Stream
from link import frames
from params import parse, schema
from params.config import Config
from params.values import ConfigError

FIRMWARE = Path(__file__).resolve().parents[2] / "firmware"
DEFAULT = json.loads((FIRMWARE / "robot.json").read_text())
KEYS = [row[0] for row in schema.rows(schema.BOOT, schema.LIVE)] + ["mode", "robot", "drive", "unknown", "avoid.unknown", "motors.full_speed.x"]
frame = frames.frame


class _Link(Link):
    def _send(self, data):
        pass

    def hear(self, data):
        self._receive(data)


def wire(pieces: list[bytes]) -> None:
    """Bytes from the robot, in these pieces; then a good frame, which must still be heard."""
    link = _Link("")
    for piece in pieces:
        link.hear(piece)
    while link.get(0):
        pass
    link.hear(bytes(1500))  # the end of what was begun
    link.hear(frame(8, b"\0still here"))
    heard = []
    while message := link.get(0):
        json.dumps(message, allow_nan=False)
        heard.append(message)
    assert any(message.get("text") == "still here" for message in heard)


def message(kind: int, payload: bytes) -> None:
    """One payload; what comes out must be JSON as the browser reads it."""
    told = messages.decode(kind, payload)
    if told is not None:
        assert told["type"] in ("hello", "decision", "wheels", "points", "scan", "health", "parameter", "log", "pose", "candidates", "reply", "names")
        json.dumps(told, allow_nan=False)


def recording_of(records, header: bytes) -> bytes:
    """A recording's bytes: (stream, time, payload) each with the right check."""
    out = bytearray(recording.MAGIC)
    for stream, time_us, data in [(0, 0, header), *records]:
        body = struct.pack("<BQI", stream, time_us, len(data)) + data
        out += body + struct.pack("<I", zlib.crc32(body))
    return bytes(out)


_SAMPLE = [
    (Stream.LIDAR, 1000, bytes(range(200))),
    (Stream.POSE, 2000, recording.Pose(1.0, 2.0, 3.0).pack()),
    (Stream.INPUTS, 2500, recording.Inputs(5, 6, (64, 65)).pack()),
    (Stream.TELEMETRY, 3000, frame(8, b"\0text") + frame(9, bytes(16))),
    (Stream.DECISION, 4000, recording.Decision(1, 2, 3, 90, 1, 1, 1, 100, 0, 0, 1).pack()),
    (Stream.REGISTERS, 5000, b"\x40\x06\0\0"),
    (Stream.READ, 6000, b"\x40\0"),
    (Stream.EVENT, 7000, "größer".encode()),
    (Stream.END, 8000, b""),
]


def whole_recording(records=None) -> bytes:
    header = recording.Header("1", json.dumps(DEFAULT), "twin:z?width=600", "robot", ("free",), {})
    return recording_of(_SAMPLE if records is None else records, header.pack())


def read_recording(content: bytes, folder: Path | None = None) -> None:
    """Bytes as a recording: read, played, taken as a tape, exported as a table. RecordingError is what it may answer, with a place."""
    from host.export import to_csv
    from host.replay.tape import Tape

    if folder is None:
        with tempfile.TemporaryDirectory() as made:
            return read_recording(content, Path(made))
    path = folder / "a.rec"
    path.write_bytes(content)
    try:
        reader = recording.Reader(path)
    except recording.RecordingError as error:
        assert str(path) in str(error)
        return None
    for record in reader:
        assert len(record.data) <= len(content)
    for _, told in story(reader):
        json.dumps(told, allow_nan=False)
    to_csv.export(reader, folder / "a.csv")
    try:
        Tape(reader)
    except recording.RecordingError:
        pass
    return None


def robot_json(changes: dict) -> None:
    """The default robot.json with {"section.key": value} put over it. ConfigError is what it may answer."""
    settings = copy.deepcopy(DEFAULT)
    for key, value in changes.items():
        section, dot, name = key.partition(".")
        if not dot:
            settings[section] = value
        elif isinstance(settings.setdefault(section, {}), dict):
            settings[section][name] = value
    try:
        Config(settings)
    except ConfigError as error:
        assert str(error)


def robot_text(content: bytes) -> None:
    """The bytes of a robot.json, as the robot loads it. ConfigError is what it may answer."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.json"
        path.write_bytes(content)
        try:
            Config(parse.load(str(path)))
        except ConfigError as error:
            assert str(error)
