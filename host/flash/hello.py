"""Watches a board start: until MicroPython answers, until the firmware says hello, or until it is clear why neither happens."""

import re
import time
from typing import Callable

import serial

from . import board, tools
from .errors import FlashError

BAUD = 115200  # of the ROM's messages and of MicroPython's prompt
_RESETS = 3  # this many restarts within one listening are a boot loop
_INTERRUPT, _RAW, _EXECUTE = b"\r\x03", b"\r\x01", b"\x04"


def wait_for_prompt(port: str, timeout: float = 30) -> board.Survey:
    """Survey of a board that has just been restarted. Raises FlashError, with the reason if the board gives one, after `timeout` s.

    A blank board makes its file system at its first start, which takes some seconds.
    """
    end = time.monotonic() + timeout
    while True:
        try:
            return board.survey(port, timeout=15)
        except FlashError as error:
            said = listen(port, seconds=2)
            loop = _RESETS <= said.count(b"rst:0x")
            if loop or time.monotonic() > end:
                raise diagnose(said, error.what) from None


def listen(port: str, seconds: float) -> bytes:
    """What the board prints of itself."""
    with _opened(port) as line:
        end = time.monotonic() + seconds
        said = b""
        while (left := end - time.monotonic()) > 0:
            line.timeout = left
            said += line.read(max(1, line.in_waiting))
        return said


def restart(port: str, find_hello: Callable[[bytes], str | None], timeout: float = 20) -> str:
    """Reset the board and return the version its firmware says hello with. Raises FlashError with the board's own words if it does not.

    `find_hello` looks for a hello in all bytes received so far. The port stays open over the reset, so that nothing said is missed; that is
    why the reset is not left to mpremote.
    """
    with _opened(port) as line:
        line.write(_INTERRUPT + _RAW)
        _read_until(line, b"raw REPL; CTRL-B to exit\r\n>", 5)
        line.write(b"import machine; machine.reset()" + _EXECUTE)
        said = b""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            said += line.read(max(1, line.in_waiting))
            if version := find_hello(said):
                return version
            if b"Traceback" in said and said.rstrip().endswith(b">>>") or said.count(b"rst:0x") > _RESETS:
                break
        raise diagnose(said, "the firmware did not say hello")


def diagnose(said: bytes, what: str) -> FlashError:
    """The error for a board that said `said` and then did not do what it should; `what` names that."""
    text = said.decode(errors="replace")
    if "Brownout" in text:
        return FlashError("the board resets itself: its supply voltage drops",
                          "feed it from a stronger USB port or a shorter cable; unplug servos and motors while flashing")  # fmt: skip
    if text.count("rst:0x") >= _RESETS:
        return FlashError("the board restarts over and over (boot loop)", "run make flash again; if it stays so: BAUD=115200, a better cable, another board")
    if trace := re.search(r"Traceback.*", text, re.S):
        return FlashError(f"the firmware stopped with an error:\n{trace[0].strip()}", "correct robot.json or the file named above, then make deploy")
    if not text.strip():
        return FlashError(what, "the board is silent: press its EN (reset) button, check the cable, then run this again")
    return FlashError(f"{what}; the board said:\n{text.strip()[-800:]}", tools.remedy(""))


def _opened(port: str) -> serial.Serial:
    try:
        return serial.Serial(port, BAUD, timeout=0.1, exclusive=True)
    except (serial.SerialException, OSError) as error:
        raise FlashError(f"cannot open {port}: {error}", tools.remedy(str(error))) from None


def _read_until(line: serial.Serial, mark: bytes, timeout: float) -> None:
    said = b""
    end = time.monotonic() + timeout
    while not said.endswith(mark):
        if time.monotonic() > end:
            raise diagnose(said, "the board did not stop its program")
        said += line.read(1)
