"""The recording file: everything a run took in and gave out, with the time of each.

    file    = MAGIC record*
    MAGIC   = 89 47 53 52 0D 0A 1A 0A       "GSR" in the frame PNG uses, so that a transfer in text mode shows at once
    record  = stream u8 | time u64 | length u32 | payload | check u32          all little-endian

`time` is in microseconds since the run began and never wraps. `check` is the CRC-32 (zlib) of everything in the record before it.
The first record is the header, its payload a JSON object:

    format     1
    firmware   version of the firmware that ran; in the twin with + and the beginning of its sources' SHA-256
    robot      the text of robot.json, without the password of the WiFi; empty where it is not known
    source     address of what was recorded: twin:z?width=550&seed=3, serial:/dev/ttyUSB0, ...
    clock      whose time it is: "robot" (the firmware's own, from its start; only such a recording can be replayed) or "host"
    reasons    the English texts that a decision's `why` points into
    notes      object; whatever else the writer wants known, by name

The streams that follow, in order of time:

    1 lidar       bytes from the lidar; the time is that at which the first of them has arrived, the others follow at the line's rate
    2 registers   one I2C write: address u8, then the bytes written (register number first); the time is that of its end
    3 telemetry   bytes the robot sent on its link or printed, see firmware/lib/link/protocol.py
    4 decision    one decision of the firmware, see `Decision`
    5 pose        true pose of the body (twin only), see `Pose`
    6 event       UTF-8 text: touched a wall, stopped by hand, lost the link, ...
    7 command     bytes sent to the robot on its link
    8 inputs      what the robot's inputs showed from then on, see `Inputs`
    9 uart        bytes the robot sent on another UART (its screen): GPIO u8, then the bytes
    10 read       one I2C read: address u8, then the bytes the chip answered; the time is that of its end
    11 screen     bytes from the screen; the time is that at which the first of them has arrived
    255 end       the recording was closed properly; nothing follows

Each record is one write, handed to the operating system before `write` returns: a process that dies loses nothing. A file cut
anywhere is read up to the last whole record, and `Reader.cut` then says where it was cut. Behind damage reading goes on at the next record
whose check matches, and `Reader.damage` says what was left out.
"""

import json
import math
import mmap
import os
import re
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from enum import IntEnum
from pathlib import Path
from typing import NamedTuple

MAGIC = b"\x89GSR\r\n\x1a\n"
FORMAT = 1
LARGEST = 1 << 24  # bytes of payload; a longer length can only be damage
FOUND_AGAIN = 1 << 16  # bytes of payload of the first record taken after damage; only a header is longer, and bounds are what keeps the search short
_HOUR_US = 3_600_000_000  # the longest gap over which records are found again

_PREFIX = struct.Struct("<BQI")
_CHECK = struct.Struct("<I")


class Stream(IntEnum):
    """What a record carries."""

    HEADER = 0
    LIDAR = 1
    REGISTERS = 2
    TELEMETRY = 3
    DECISION = 4
    POSE = 5
    EVENT = 6
    COMMAND = 7
    INPUTS = 8
    UART = 9
    READ = 10
    SCREEN = 11
    END = 255


class RecordingError(Exception):
    """The file cannot be written or is no recording; the text says what to do."""


class Record(NamedTuple):
    """One record: time in us since the run began, stream, payload."""

    time_us: int
    stream: int
    data: bytes


class Decision(NamedTuple):
    """What `Avoid` decided, in the firmware's own units.

    number: the firmware's counter of decisions. af, ar: 0.1 deg. v: 0..180. mode, window, zone, why: see firmware/lib/avoid.py.
    free: mm. block_x, block_y: body frame, mm, 32767 when nothing blocks. time_us: when; that of its record, so it is not packed.
    """

    number: int
    af: int
    ar: int
    v: int
    mode: int
    window: int
    zone: int
    free: int
    block_x: int
    block_y: int
    why: int
    time_us: int = 0

    def pack(self) -> bytes:
        return _DECISION.pack(*self[:-1])

    @classmethod
    def unpack(cls, data: bytes) -> "Decision":
        return cls(*_DECISION.unpack(data))


class Pose(NamedTuple):
    """True pose of the body's centre in the world: x, y in mm, heading in degrees clockwise from +y."""

    x: float
    y: float
    heading: float

    def pack(self) -> bytes:
        return _POSE.pack(*self)

    @classmethod
    def unpack(cls, data: bytes) -> "Pose":
        return cls(*_POSE.unpack(data))


class Inputs(NamedTuple):
    """What the robot can read besides the lidar.

    levels: of the input pins, bit = GPIO. battery: the ADC's reading, 0..65535 over 3.3 V. addresses: I2C addresses that acknowledge.
    """

    levels: int
    battery: int
    addresses: tuple[int, ...]

    def pack(self) -> bytes:
        return _INPUTS.pack(self.levels, self.battery) + bytes(self.addresses)

    @classmethod
    def unpack(cls, data: bytes) -> "Inputs":
        levels, battery = _INPUTS.unpack_from(data)
        return cls(levels, battery, tuple(data[_INPUTS.size :]))


_DECISION = struct.Struct("<IhhBBBBhhhB")
_INPUTS = struct.Struct("<QH")
_POSE = struct.Struct("<ddd")
_INPUTS_MOST = _INPUTS.size + 128  # there are no more I2C addresses

# Whether a payload can be one of its stream's; others hold any bytes
_FITS: dict[int, Callable[[bytes], bool]] = {
    Stream.REGISTERS: lambda data: len(data) >= 1,
    Stream.DECISION: lambda data: len(data) == _DECISION.size,
    Stream.POSE: lambda data: len(data) == _POSE.size and all(map(math.isfinite, _POSE.unpack(data))),
    Stream.INPUTS: lambda data: _INPUTS.size <= len(data) <= _INPUTS_MOST,
    Stream.UART: lambda data: len(data) >= 1,
    Stream.READ: lambda data: len(data) >= 1,
    Stream.END: lambda data: not data,
}


@dataclass(frozen=True)
class Header:
    """What holds for the whole recording; the fields are those of the header record (module docstring)."""

    firmware: str
    robot: str
    source: str
    clock: str = "robot"
    reasons: tuple[str, ...] = ()
    notes: dict = field(default_factory=dict)

    def pack(self) -> bytes:
        fields = {**vars(self), "reasons": list(self.reasons)}
        return json.dumps({"format": FORMAT, **fields}, ensure_ascii=False).encode()

    @classmethod
    def unpack(cls, data: bytes) -> "Header":
        """Raises RecordingError if it is none."""
        try:
            fields = json.loads(data)
            version = fields.pop("format")
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise RecordingError(f"its header, from byte {len(MAGIC)} on, is not one of a recording") from None
        if version != FORMAT:
            raise RecordingError(f"recording format {version}, this version reads {FORMAT}: use the Gapseeker that recorded it")
        kinds = {"firmware": str, "robot": str, "source": str, "clock": str, "reasons": list, "notes": dict}
        for name, kind in kinds.items():
            if not isinstance(fields.get(name), kind):
                raise RecordingError(f"its header, from byte {len(MAGIC)} on, lacks {name}, or it is no {kind.__name__}")
        known = {name: fields[name] for name in kinds}
        return cls(**{**known, "reasons": tuple(str(reason) for reason in fields["reasons"])})


def without_secrets(robot: str) -> str:
    """The text of a robot.json with an empty WiFi password, else as it was. Recordings are passed on; the password is not to be."""
    text = re.sub(r'("password"\s*:\s*)"(?:[^"\\]|\\.)*"', r'\1""', robot, flags=re.DOTALL)
    try:
        settings = json.loads(text)
        network = settings.get("wifi")
        if not isinstance(network, dict) or not network.get("password"):
            return text
    except (ValueError, AttributeError, RecursionError):
        return text
    network["password"] = ""  # written in a way of its own, with escapes or as a number
    return json.dumps(settings, indent=2)


class Writer:
    """Writes a new recording; a context manager.

    Raises RecordingError if the file exists (a recording is never overwritten) or its folder cannot be made.
    """

    def __init__(self, path: str | Path, header: Header):
        self.path = Path(path)
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = open(self.path, "xb")
        except FileExistsError:
            raise RecordingError(f"{path} exists already: give another name, or remove it first") from None
        except OSError as error:
            raise RecordingError(f"cannot record into {path}: {error.strerror}; choose a folder you may write to") from None
        self._file.write(MAGIC)
        self._last_us = 0
        self.write(Stream.HEADER, 0, replace(header, robot=without_secrets(header.robot)).pack())

    def write(self, stream: int, time_us: int, data: bytes) -> None:
        """Append one record; time_us >= 0. It is with the operating system when this returns."""
        self._last_us = max(self._last_us, time_us)
        body = _PREFIX.pack(stream, time_us, len(data)) + data
        self._file.write(body + _CHECK.pack(zlib.crc32(body)))
        self._file.flush()

    def event(self, time_us: int, text: str) -> None:
        """Append a remark in words."""
        self.write(Stream.EVENT, time_us, text.encode())

    @property
    def closed(self) -> bool:
        return self._file.closed

    def abandon(self) -> None:
        """Close it without the mark of the end, as after a write that failed: the reader says where it was cut."""
        try:
            self._file.close()
        except OSError:
            pass  # the rest of a record; the file is closed all the same

    def close(self) -> None:
        """Mark the end and see that it is on the disk. Calling it again does nothing."""
        if self._file.closed:
            return
        self.write(Stream.END, self._last_us, b"")
        os.fsync(self._file.fileno())
        self._file.close()

    def __enter__(self) -> "Writer":
        return self

    def __exit__(self, *_) -> None:
        self.close()


class Reader:
    """Reads a recording: `header`, then the other records by iteration (as often as wanted).

    After an iteration `cut` is None for a file that was closed properly, else a sentence saying where and how it ends. `damage` lists, in
    words, what was left out so far because it was damaged; it grows while one iterates.
    Raises RecordingError if the file is missing, is no recording, or is cut within its header.
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        self.cut: str | None = None
        self.damage: list[str] = []
        try:
            with open(self.path, "rb") as file:
                if file.read(len(MAGIC)) != MAGIC:
                    raise RecordingError(f"{path} is no recording: it does not begin with the recording mark")
                first, trouble = _record(file)
                self._start = file.tell()
        except OSError as error:
            raise RecordingError(f"cannot read {path}: {error.strerror}") from None
        if first is None or first.stream != Stream.HEADER:
            raise RecordingError(f"{path} holds nothing to read: {trouble or 'its header is missing'}")
        try:
            self.header = Header.unpack(first.data)
        except RecordingError as error:
            raise RecordingError(f"{path}: {error}") from None

    def __iter__(self) -> Iterator[Record]:
        self.cut = None
        self.damage = []
        last_us = 0
        with open(self.path, "rb") as file:
            file.seek(self._start)
            while True:
                at = file.tell()
                record, trouble = _record(file)
                if record is None:
                    again = _found_again(file, at + 1, last_us)
                    if again is None:
                        self.cut = trouble
                        return
                    self.damage.append(f"damaged at byte {at}: {again - at} bytes were left out, after {last_us / 1e6:.3f} s")
                    file.seek(again)
                elif not _FITS.get(record.stream, _anything)(record.data):
                    self.damage.append(f"damaged at byte {at}: a record of stream {record.stream} with {len(record.data)} bytes cannot be; it was left out")
                elif record.stream == Stream.END:
                    return
                else:
                    last_us = max(last_us, record.time_us)
                    yield record

    def stream(self, stream: int) -> Iterator[Record]:
        """The records of one stream."""
        return (record for record in self if record.stream == stream)


def _anything(data: bytes) -> bool:
    return True


def _record(file) -> tuple[Record | None, str]:
    """(the record at which the file stands, ""), or (None, what is wrong there)."""
    at = file.tell()
    prefix = file.read(_PREFIX.size)
    if len(prefix) == _PREFIX.size:
        stream, time_us, length = _PREFIX.unpack(prefix)
        if length > LARGEST:
            return None, f"damaged at byte {at}: a record of {length} bytes cannot be"
        rest = file.read(length + _CHECK.size)
        if len(rest) == length + _CHECK.size:
            data = rest[:length]
            if _CHECK.unpack(rest[length:])[0] == zlib.crc32(data, zlib.crc32(prefix)):
                return Record(time_us, stream, data), ""
            return None, f"damaged at byte {at}: the record's check does not match"
    return None, f"cut off at byte {at}" + ("" if prefix else ", after a whole record")


def _found_again(file, start: int, last_us: int) -> int | None:
    """The first byte from `start` on at which a whole record begins; None if there is none.

    Any byte may be the first of one. Looked at closely are those that begin with the number of a stream and a time of the hour after the last
    one read, whose upper half has few values; what then also has the right check is a record.
    """
    if start >= os.fstat(file.fileno()).st_size:
        return None
    earliest = max(0, last_us - 1_000_000)  # what arrives together is not always written in order
    uppers = {struct.pack("<I", time >> 32 & 0xFFFFFFFF) for time in (earliest, last_us + _HOUR_US)}
    streams = b"".join(re.escape(bytes([stream])) for stream in Stream if stream != Stream.HEADER)
    begins = re.compile(b"(?=[" + streams + b"].{4}(?:" + b"|".join(map(re.escape, uppers)) + b"))", re.DOTALL)
    with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        for found in begins.finditer(content, start):
            at = found.start()
            if at + _PREFIX.size > len(content):
                return None
            _, time_us, length = _PREFIX.unpack_from(content, at)
            end = at + _PREFIX.size + length
            if length <= FOUND_AGAIN and end + _CHECK.size <= len(content) and earliest <= time_us <= last_us + _HOUR_US:
                if _CHECK.unpack_from(content, end)[0] == zlib.crc32(content[at:end]):
                    return at
    return None
