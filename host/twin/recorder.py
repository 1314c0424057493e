"""Writes a run of the twin into a recording (format: `host.recording`)."""

import hashlib
import itertools
import os
import time
from math import degrees
from pathlib import Path

from host import recording
from host.recording import Stream

from . import image
from .console import reasons
from .simulation import Observer

POSE_US = 20_000  # no more poses than one in this time
OUT = image.ROOT / "out" / "ended-badly"
KEPT = 100  # newest recordings that are left there: a sweep of failing runs must not fill the disk

_number = itertools.count(1)  # of the recordings of this process


def sources_digest(firmware):
    """SHA-256 (hex) of the firmware's sources: a replay with the same ones must give the same decisions."""
    digest = hashlib.sha256()
    for path in [Path(firmware) / "main.py", *sorted((Path(firmware) / "lib").rglob("*.py"))]:
        digest.update(path.relative_to(firmware).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def version(firmware):
    """Version and sources of a firmware: 0.1.0+a6b104efa42a."""
    try:
        text = (Path(firmware) / "lib" / "core" / "version.py").read_text()
        number = text.split('VERSION = "')[1].split('"')[0]
    except (OSError, IndexError):
        number = "0"
    return f"{number}+{sources_digest(firmware)[:12]}"


class Recorder(Observer):
    """Records all that goes into and comes out of the firmware.

    writer: recording.Writer; None records nothing. kept: whether the file stays even if the run ended well. lost: why the recording broke off, in
    words, "" if it did not: the run goes on without. Of several observers this must be the first to be told, so that it sees the inputs as the firmware did.
    """

    def __init__(self, writer, kept=True):
        self._writer = writer
        self.lost = ""
        self._now = 0
        self._inputs = None
        self._next_pose = 0
        self._kept = kept

    @classmethod
    def begin(cls, path, robot, source, firmware, notes):
        """Open a recording for one run.

        path: file to write; None: one in OUT that `finish` keeps only if the run ends badly. robot: text of robot.json. source: address
        of the course. firmware: folder of the firmware. notes: dict of what else is worth knowing.
        """
        kept = path is not None
        if not kept:
            name = "".join(letter if letter.isalnum() else "-" for letter in source.removeprefix("twin:"))
            path = OUT / f"{time.strftime('%Y%m%d-%H%M%S')}-{name}-{os.getpid()}-{next(_number)}.rec"
        header = recording.Header(
            firmware=version(firmware),
            robot=robot,
            source=source,
            reasons=tuple(reasons()),
            notes=notes,
        )
        try:
            return cls(recording.Writer(path, header), kept)
        except (OSError, recording.RecordingError) as error:
            if kept:
                raise recording.RecordingError(str(error)) from None
            return cls(None, kept)  # nobody asked for one

    def _write(self, stream, time, data):
        if self._writer is None or self.lost:
            return
        try:
            self._writer.write(stream, time, data)
        except OSError as error:
            self._broke_off(error)

    def _broke_off(self, error):
        self.lost = f"the recording {self._writer.path} broke off after {self._now / 1e6:.1f} s: {error.strerror}"
        self._writer.abandon()

    def lidar(self, time, data):
        self._write(Stream.LIDAR, int(time), data)

    def registers(self, time, address, data):
        self._write(Stream.REGISTERS, int(time), bytes((address,)) + data)

    def read(self, time, address, data):
        self._write(Stream.READ, int(time), bytes((address,)) + data)

    def decision(self, decision):
        self._write(Stream.DECISION, int(decision.time_us), decision.pack())

    def uart(self, time, gpio, data):
        self._write(Stream.UART, int(time), bytes((gpio,)) + data)

    def screen(self, time, data):
        self._write(Stream.SCREEN, int(time), data)

    def serial(self, data):
        self._write(Stream.TELEMETRY, self._now, data)

    def command(self, data):
        """Bytes about to be sent to the board's serial line, after the `step` that has just been told."""
        self._write(Stream.COMMAND, self._now, data)

    def step(self, simulation):
        self._now = int(simulation.now)
        electronics, body = simulation.electronics, simulation.body
        inputs = recording.Inputs(electronics.levels, electronics.battery_reading, tuple(electronics.addresses))
        if inputs != self._inputs:
            self._inputs = inputs
            self._write(Stream.INPUTS, self._now, inputs.pack())
        if self._now >= self._next_pose:
            self._next_pose = self._now + POSE_US
            self._write(Stream.POSE, self._now, recording.Pose(body.x, body.y, degrees(body.heading)).pack())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        """A run that broke off leaves its recording, unless it never began."""
        if self._writer is None:
            return
        self._close()
        if not self._now:
            self._writer.path.unlink(missing_ok=True)

    def _close(self):
        try:
            self._writer.close()
        except OSError as error:
            self._broke_off(error)

    def finish(self, result, reason, badly):
        """Say how the run ended and complete the file; returns its path, or None if nobody wants it.

        badly: whether this is an end worth looking into.
        """
        if self._writer is None:
            return None
        self._write(Stream.EVENT, self._now, (f"{result}: {reason}" if reason else result).encode())
        self._close()
        path = self._writer.path
        if self._kept:
            return path
        if not badly:
            path.unlink(missing_ok=True)
            return None
        for old in sorted(path.parent.glob("*.rec"))[:-KEPT]:  # the names begin with the time
            old.unlink(missing_ok=True)
        return path


class Observers(Observer):
    """Tells several watches, in their order."""

    def __init__(self, *watches):
        self._watches = watches

    def board(self, folder):
        for watch in self._watches:
            watch.board(folder)

    def lidar(self, time, data):
        for watch in self._watches:
            watch.lidar(time, data)

    def registers(self, time, address, data):
        for watch in self._watches:
            watch.registers(time, address, data)

    def read(self, time, address, data):
        for watch in self._watches:
            watch.read(time, address, data)

    def decision(self, decision):
        for watch in self._watches:
            watch.decision(decision)

    def uart(self, time, gpio, data):
        for watch in self._watches:
            watch.uart(time, gpio, data)

    def screen(self, time, data):
        for watch in self._watches:
            watch.screen(time, data)

    def reset(self, time, cause):
        for watch in self._watches:
            watch.reset(time, cause)

    def serial(self, data):
        for watch in self._watches:
            watch.serial(data)

    def step(self, simulation):
        for watch in self._watches:
            watch.step(simulation)

    def commands(self):
        return b"".join(watch.commands() for watch in self._watches)

    def command(self, data):
        for watch in self._watches:
            watch.command(data)
