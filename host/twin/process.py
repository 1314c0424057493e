"""The process that runs the firmware, and the lockstep channel to it. The message format is in board/lockstep.py."""

import json
import math
import os
import select
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from host import micropython

from . import image, memory, wire
from .silence import Silence

ENGINES = (*micropython.ENGINES, "cpython")
POWER_ON, SOFT_RESET = 1, 5  # as machine.reset_cause() says it
BOOT_US = 300_000  # from the reset to main.py's first line, roughly what the stock image takes


class FirmwareStopped(Exception):
    """The firmware ended or crashed, or no longer lets time pass; the message says which."""


class Process:
    """The firmware in a process of its own.

    engine: one of ENGINES. config_text: the robot.json that it finds. on_serial(bytes) gets what it prints. heap: bytes that it has on
    the board, None = what `memory` says. chip: factor on the speed of an ESP32, math.inf = computing takes no time. clock_us: what the
    board's clock shows at the start; a soft reset leaves it running.
    """

    def __init__(self, engine, config_text, on_serial, firmware=image.FIRMWARE, heap=None, chip=1.0, clock_us=0):
        self._engine = engine
        self._firmware = Path(firmware)
        self._on_serial = on_serial
        self._began = -clock_us  # when the board's clock showed 0
        self._closed = False
        self._folder = tempfile.mkdtemp(prefix="gapseeker-")
        try:
            (Path(self._folder) / "robot.json").write_text(config_text)
            if tables := image.tables(config_text, self._firmware):
                shutil.copyfile(tables, Path(self._folder) / "tables.bin")
            timing = None
            if chip < math.inf:
                timing = json.dumps({"percent": max(round(100 * chip), 1), "sizes": image.sizes(self._firmware)})
                (Path(self._folder) / "chip.json").write_text(timing)
            self._words = self._command(config_text, heap, timing)
            self._start(clock_us, POWER_ON)
        except BaseException:
            shutil.rmtree(self._folder)
            raise

    def receive(self):
        """The next request. FirmwareStopped when none will come."""
        silence = Silence(self._child.pid)
        while wire.missing(self._gathered):
            ready = self._poll.poll(silence.look_ms)
            if not ready and (trouble := silence.trouble()):
                raise FirmwareStopped(trouble)
            for descriptor, _ in ready:
                if not self._readers[descriptor]():
                    self._poll.unregister(descriptor)
                    del self._readers[descriptor]
            if self._from_board not in self._readers:
                raise FirmwareStopped(self._last_words())
        data, self._gathered = self._gathered, b""
        self._request = wire.decode(data, self._began)
        return self._request

    def answer(self, *inputs):
        """Answer the request; inputs as `wire.encode` wants them after the request and the clock."""
        try:
            os.write(self._to_board, wire.encode(self._request, self._began, *inputs))
        except BrokenPipeError:
            pass  # the next receive says why

    def restart(self):
        """Instead of an answer to a RESET: the board starts again, with the files that it has; the next request comes from its new life.

        The chip's clock begins anew, except after a soft reset.
        """
        now, cause = self._request.now + BOOT_US, self._request.address
        self._stop()
        if cause != SOFT_RESET:
            self._began = now
        self._start(now - self._began, cause)

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
        self._stop()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _command(self, config_text, heap, timing):
        """What starts the firmware: the words before and behind those that _start adds."""
        if self._engine == "cpython":
            # -S: site-packages have no place on the board; -u: what was printed before a reset has been printed.
            return [sys.executable, "-E", "-S", "-u", str(image.BOARD.parent / "bootstrap_cpython.py")], [
                str(image.BOARD),
                str(self._firmware),
                str(image.ROOT),
            ]
        port = micropython.find(self._engine)
        board, firmware = image.compiled(self._firmware, port)
        image.lay_out(Path(self._folder), board, firmware)
        size = memory.heap_size(port, board, heap or memory.board_heap(self._firmware, config_text), timing)
        return [*port.command, "-X", f"heapsize={size}", "-m", "bootstrap"], []

    def _start(self, ticks, cause):
        """Begin a life of the board. ticks: what its clock shows, us."""
        to_board, self._to_board = os.pipe()
        self._from_board, from_board = os.pipe()
        before, behind = self._words
        try:
            self._child = subprocess.Popen(
                [*before, *map(str, (to_board, from_board, ticks, cause)), *behind],
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
            os.close(self._to_board)
            os.close(self._from_board)
            raise
        finally:
            os.close(to_board)
            os.close(from_board)
        os.set_blocking(self._child.stdin.fileno(), False)
        self._errors = self._said = self._gathered = b""
        self._poll = select.poll()
        self._readers = {}
        for descriptor, reader in (
            (self._from_board, self._read_request),
            (self._child.stdout.fileno(), self._read_serial),
            (self._child.stderr.fileno(), self._read_errors),
        ):
            self._poll.register(descriptor, select.POLLIN)
            self._readers[descriptor] = reader

    def _stop(self):
        """End a life of the board; what it printed last is still told."""
        self._child.kill()
        self._child.wait()
        while self._read_serial():
            pass
        os.close(self._to_board)
        self._child.stdin.close()
        os.close(self._from_board)
        self._child.stdout.close()
        self._child.stderr.close()

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
