"""One life of the emulated board: the operating system's process and the pipes to it."""

import os
import select
import subprocess

from . import wire
from .silence import Silence


class FirmwareStopped(Exception):
    """The firmware ended or crashed, or no longer lets time pass; the message says which."""


class Hung(FirmwareStopped):
    """It computes and computes, without letting time pass."""


class Child:
    """A process that speaks the lockstep protocol.

    words: the command; the descriptors of its two pipes go where it says None. folder: where it runs. on_serial(bytes) gets what it prints.
    """

    def __init__(self, words, folder, on_serial):
        self._on_serial = on_serial
        self._gathered = self._said = self._errors = b""
        to_board, self._to_board = os.pipe()
        self._from_board, from_board = os.pipe()
        ends = iter((to_board, from_board))
        try:
            self._process = subprocess.Popen(
                [str(next(ends)) if word is None else word for word in words],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                pass_fds=(to_board, from_board),
                cwd=folder,
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
        self.pid = self._process.pid
        assert self._process.stdin and self._process.stdout and self._process.stderr
        self._stdin, self._stdout, self._stderr = self._process.stdin, self._process.stdout, self._process.stderr
        os.set_blocking(self._stdin.fileno(), False)
        self._poll = select.poll()
        self._readers = {}
        for descriptor, reader in (
            (self._from_board, self._read_request),
            (self._stdout.fileno(), self._read_serial),
            (self._stderr.fileno(), self._read_errors),
        ):
            self._poll.register(descriptor, select.POLLIN)
            self._readers[descriptor] = reader

    def receive(self, watched=False):
        """The bytes of the next request. FirmwareStopped when none will come. watched: whether the board has a watchdog, which waits less long."""
        silence = Silence(self.pid, watched)
        while wire.missing(self._gathered):
            ready = self._poll.poll(silence.look_ms)
            if not ready and (trouble := silence.trouble()):
                raise (Hung if silence.computing else FirmwareStopped)(trouble)
            for descriptor, _ in ready:
                if not self._readers[descriptor]():
                    self._poll.unregister(descriptor)
                    del self._readers[descriptor]
            if self._from_board not in self._readers:
                raise FirmwareStopped(self._last_words())
        data, self._gathered = self._gathered, b""
        return data

    def answer(self, data):
        """Send the bytes of an answer."""
        try:
            os.write(self._to_board, data)
        except BrokenPipeError:
            pass  # the next receive says why

    def send_serial(self, data):
        """Bytes to the board's USB serial line; what a board that does not read has no room for is lost."""
        try:
            os.write(self._stdin.fileno(), data)
        except (BrokenPipeError, BlockingIOError):
            pass

    def stop(self):
        """End it, whatever it does; what it printed last is still told."""
        self._process.kill()
        self._process.wait()
        while self._read_serial():
            pass
        os.close(self._to_board)
        os.close(self._from_board)
        for stream in (self._stdin, self._stdout, self._stderr):
            stream.close()

    def _read_request(self):
        data = os.read(self._from_board, 65536)
        self._gathered += data
        return data

    def _read_serial(self):
        data = os.read(self._stdout.fileno(), 65536)
        if data:
            self._said = (self._said + data)[-8192:]
            self._on_serial(data)
        return data

    def _read_errors(self):
        data = os.read(self._stderr.fileno(), 65536)
        self._errors = (self._errors + data)[-8192:]
        return data

    def _last_words(self):
        """Why the process ended, with its traceback."""
        while self._read_errors():
            pass
        while self._read_serial():
            pass
        code = self._process.wait()
        # MicroPython prints the traceback where the firmware prints, CPython on the error output.
        said = (self._said + b"\n" + self._errors).decode(errors="replace")
        at = said.rfind("Traceback")
        if at >= 0:
            return "the firmware crashed:\n" + said[at:].strip()
        return f"the firmware's main.py came to its end (exit {code})"
