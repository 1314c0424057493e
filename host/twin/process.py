"""The process that runs the firmware, and the lockstep channel to it. The message format is in board/lockstep.py."""

import os
import select
import shutil
import struct
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from . import image

ENGINES = ("micropython", "cpython")
ADVANCE, READ, FLUSH, RESET = 1, 2, 3, 4
I2C_WRITE, PIN, PWM_DUTY, PWM_FREQUENCY, UART_OUTPUT = 1, 2, 3, 4, 5
REPLY, SHORT, PAYLOAD, CHUNKS = 1024, 256, 176, 4
# Words of 64 bits take twice the room of the board's; the 32-bit port will tell it exactly.
HEAP = "320k"
SILENCE_S = 20.0

_REQUEST = struct.Struct("<IBBHqq11iI")
_EVENT = struct.Struct("<qBBH")
_WITH_DATA = (I2C_WRITE, UART_OUTPUT)


class FirmwareStopped(Exception):
    """The firmware ended or crashed, or no longer lets time pass; the message says which."""


@dataclass
class Request:
    """One message of the firmware. events: [(time, kind, where, value, data)]."""

    kind: int
    address: int
    size: int
    now: int
    target: int
    probe: tuple
    overflows: int
    events: list


class Process:
    """The firmware in a process of its own.

    config_text: the robot.json that it finds. on_serial(bytes) gets what it prints.
    """

    def __init__(self, engine, config_text, on_serial, firmware=image.FIRMWARE):
        self._on_serial = on_serial
        self._errors = b""
        self._said = b""
        self._folder = tempfile.mkdtemp(prefix="gapseeker-")
        (Path(self._folder) / "robot.json").write_text(config_text)
        to_board, self._to_board = os.pipe()
        self._from_board, from_board = os.pipe()
        try:
            self._child = subprocess.Popen(
                self._command(engine, to_board, from_board, Path(firmware)),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                pass_fds=(to_board, from_board),
                cwd=self._folder,
                process_group=0,
                bufsize=0,
                env={**os.environ, "PYTHONHASHSEED": "0"},
            )
        except BaseException:
            shutil.rmtree(self._folder)
            raise
        finally:
            os.close(to_board)
            os.close(from_board)
        os.set_blocking(self._child.stdin.fileno(), False)
        self._poll = select.poll()
        self._readers = {}
        for descriptor, reader in (
            (self._from_board, self._read_request),
            (self._child.stdout.fileno(), self._read_serial),
            (self._child.stderr.fileno(), self._read_errors),
        ):
            self._poll.register(descriptor, select.POLLIN)
            self._readers[descriptor] = reader
        self._gathered = b""
        self._asked = FLUSH  # kind of the latest request
        self._closed = False

    def receive(self):
        """The next request. FirmwareStopped when none will come."""
        while len(self._gathered) < _REQUEST.size or len(self._gathered) < int.from_bytes(self._gathered[:4], "little"):
            ready = self._poll.poll(SILENCE_S * 1000)
            if not ready:
                raise FirmwareStopped(f"the firmware computed for {SILENCE_S:g} s without letting time pass: an endless loop?")
            for descriptor, _ in ready:
                if not self._readers[descriptor]():
                    self._poll.unregister(descriptor)
                    del self._readers[descriptor]
            if self._from_board not in self._readers:
                raise FirmwareStopped(self._last_words())
        data, self._gathered = self._gathered, b""
        _, kind, address, size, now, target, *probe, overflows = _REQUEST.unpack_from(data)
        self._asked = kind
        return Request(kind, address, size, now, target, tuple(probe), overflows, list(_events(data)))

    def answer(self, horizon, levels, addresses, adc, chunks=(), payload=b""):
        """Answer the request. chunks, to ADVANCE only: [(time of the first byte, bytes, GPIO, baud rate)]."""
        words = [horizon, levels, _mask(addresses, 0), _mask(addresses, 60), adc, len(chunks)]
        for time, data, gpio, baud in chunks:
            words += (time, len(data), gpio, baud)
            payload += data
        head = struct.pack(f"<{len(words)}q", *words)
        try:
            os.write(self._to_board, (head.ljust(PAYLOAD, b"\0") + payload).ljust(REPLY if self._asked == ADVANCE else SHORT, b"\0"))
        except BrokenPipeError:
            pass  # the next receive says why

    def send_serial(self, data):
        """Bytes to the board's USB serial line; what a board that does not read has no room for is lost."""
        try:
            os.write(self._child.stdin.fileno(), data)
        except (BrokenPipeError, BlockingIOError):
            pass

    def close(self):
        """End the process and remove its files."""
        if self._closed:
            return
        self._closed = True
        self._child.kill()
        self._child.wait()
        while self._read_serial():
            pass
        os.close(self._to_board)
        self._child.stdin.close()
        os.close(self._from_board)
        self._child.stdout.close()
        self._child.stderr.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _command(self, engine, to_board, from_board, firmware):
        descriptors = [str(to_board), str(from_board)]
        if engine == "micropython":
            board, firmware = image.compiled(firmware)
            # Short names, as on the board: the interpreter keeps each module's path in the heap.
            for name, place in (("board", board), ("lib", firmware / "lib"), ("main.mpy", firmware / "main.mpy"), ("bootstrap.mpy", board / "bootstrap.mpy")):
                (Path(self._folder) / name).symlink_to(place)
            return [*image.micropython(), "-X", f"heapsize={HEAP}", "-m", "bootstrap", *descriptors]
        command = [sys.executable, "-E", "-S", str(image.BOARD.parent / "bootstrap_cpython.py"), *descriptors]
        return [*command, str(image.BOARD), str(firmware), str(image.ROOT)]

    def _read_request(self):
        data = os.read(self._from_board, 65536)
        self._gathered += data
        return data

    def _read_serial(self):
        data = os.read(self._child.stdout.fileno(), 65536)
        if data:
            self._said = (self._said + data)[-8192:]
            self._on_serial(data)
        return data

    def _read_errors(self):
        data = os.read(self._child.stderr.fileno(), 65536)
        self._errors = (self._errors + data)[-8192:]
        return data

    def _last_words(self):
        """Why the process ended, with its traceback."""
        while self._read_errors():
            pass
        while self._read_serial():
            pass
        code = self._child.wait()
        # MicroPython prints the traceback where the firmware prints, CPython on the error output.
        said = (self._said + b"\n" + self._errors).decode(errors="replace")
        at = said.rfind("Traceback")
        if at >= 0:
            return "the firmware crashed:\n" + said[at:].strip()
        return f"the firmware's main.py came to its end (exit {code})"


def _events(data):
    at = _REQUEST.size
    while at < len(data):
        time, kind, where, value = _EVENT.unpack_from(data, at)
        at += _EVENT.size
        size = value if kind in _WITH_DATA else 0
        yield time, kind, where, value, data[at : at + size]
        at += size


def _mask(addresses, base):
    return sum(1 << address - base for address in addresses if base <= address < base + 60)
