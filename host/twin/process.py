"""The firmware in a process of its own, with the files and the memory that it has on the board. The message format is in board/lockstep.py."""

import json
import math
import shutil
import sys
import tempfile
from pathlib import Path

from host import micropython

from . import image, memory, wire
from .child import Child, FirmwareStopped, Hung

__all__ = ["ENGINES", "FirmwareStopped", "Process"]

ENGINES = (*micropython.ENGINES, "cpython")
POWER_ON, WDT_RESET, SOFT_RESET = 1, 3, 5  # as machine.reset_cause() says it
CHIP = 1.0  # factor on the speed of an ESP32, where none is given
BOOT_US = 300_000  # from the reset to main.py's first line, roughly what the stock image takes


class Process:
    """The emulated board and the firmware on it.

    engine: one of ENGINES. config_text: the robot.json that it finds. on_serial(bytes) gets what it prints. heap: bytes that it has on
    the board, None = what `memory` says. chip: factor on the speed of an ESP32, math.inf = computing takes no time, None = CHIP. clock_us: what the
    board's clock shows at the start; a soft reset leaves it running. files: {name: bytes} that it finds as well.
    """

    def __init__(self, engine, config_text, on_serial, firmware=image.FIRMWARE, heap=None, chip=None, clock_us=0, files=None):
        self._on_serial = on_serial
        self._began = -clock_us  # when the board's clock showed 0
        self._request = wire.Request(wire.FLUSH, 0, 0, 0, 0, (), 0, -1, b"", [])  # the latest; before the first, none that asks for anything
        self._closed = False
        self._folder = Path(tempfile.mkdtemp(prefix="gapseeker-"))
        try:
            self.leave({"robot.json": config_text.encode(), **(files or {})})
            if tables := image.tables(config_text, firmware):
                shutil.copyfile(tables, self._folder / "tables.bin")
            timing = self._chip(CHIP if chip is None else chip, Path(firmware))
            self._words = self._command(engine, Path(firmware), config_text, heap, timing, files or {})
            self._child = self._start(clock_us, POWER_ON)
        except BaseException:
            shutil.rmtree(self._folder)
            raise

    def receive(self):
        """The next wire.Request. FirmwareStopped when none will come.

        A firmware that computes for ever without letting time pass never feeds its watchdog: if it has one, the board resets when that bites.
        """
        before = self._request
        watched = before.watchdog >= 0
        try:
            self._request = wire.decode(self._child.receive(watched), self._began)
        except Hung:
            if not watched:
                raise
            return self.reset(WDT_RESET, before.target + before.watchdog)
        return self._request

    def answer(self, *inputs):
        """Answer the request; inputs as `wire.encode` wants them after the request and the clock."""
        self._child.answer(wire.encode(self._request, self._began, *inputs))

    def restart(self):
        """Instead of an answer to a RESET: the board starts again, with the files that it has; the next request comes from its new life.

        The chip's clock begins again, except after a soft reset.
        """
        now, cause = self._request.now + BOOT_US, self._request.address
        self._child.stop()
        self.leave({"rtc.bin": self._request.kept})
        if cause != SOFT_RESET:
            self._began = now
        self._child = self._start(now - self._began, cause)

    def reset(self, cause, time=None, forget=False):
        """The processor is reset from outside, at the time (us, None = now): the wire.Request of that, to be served and followed by `restart`.

        forget: power was off, so that the memory of its clock is lost.
        """
        before = self._request
        time = before.target if time is None else time
        self._request = wire.Request(
            wire.RESET, cause, 0, time, time, before.probe, before.overflows, -1, bytes(len(before.kept)) if forget else before.kept, []
        )
        return self._request

    @property
    def folder(self):
        """Where the board's files lie while it is there."""
        return self._folder

    def leave(self, files):
        """Put files on the board. files: {name: bytes}."""
        for name, data in files.items():
            (self._folder / name).write_bytes(data)

    def send_serial(self, data):
        """Bytes to the board's USB serial line; what a board that does not read has no room for is lost."""
        self._child.send_serial(data)

    def close(self):
        """End the process and remove its files."""
        if self._closed:
            return
        self._closed = True
        self._child.stop()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _chip(self, speed, firmware):
        """Leave the file that says how fast the chip is; its text, None where computing takes no time."""
        if speed == math.inf:
            return None
        text = json.dumps({"percent": max(round(100 * speed), 1), "sizes": image.sizes(firmware)})
        (self._folder / "chip.json").write_text(text)
        return text

    def _command(self, engine, firmware, config_text, heap, timing, files):
        """What starts the firmware: the words before and behind those that _start puts in."""
        if engine == "cpython":
            # -S: site-packages have no place on the board; -u: what was printed before a reset has been printed.
            before = [sys.executable, "-E", "-S", "-u", str(image.BOARD.parent / "bootstrap_cpython.py")]
            return before, [str(image.BOARD), str(firmware), str(image.ROOT)]
        port = micropython.find(engine)
        board, compiled = image.compiled(firmware, port)
        image.lay_out(self._folder, board, compiled)
        if heap is None:
            heap = memory.board_heap(firmware, config_text, files)
        size = memory.heap_size(port, board, heap, timing, memory.radio(config_text), files.get("fault.json"))
        return [*port.command, "-X", f"heapsize={size}", "-m", "bootstrap"], []

    def _start(self, ticks, cause):
        """Begin a life of the board. ticks: what its clock shows, us."""
        before, behind = self._words
        return Child([*before, None, None, str(ticks), str(cause), *behind], self._folder, self._on_serial)
