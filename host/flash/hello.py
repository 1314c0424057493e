"""Watches a board start: until MicroPython answers, until the firmware says hello, or until it is clear why neither happens."""

import json
import re
import struct
import time

import serial

from host import compat
from host.boards.errors import FlashError

from . import tools

BAUD = 115200  # of the ROM's messages and of MicroPython's prompt
PATIENCE = 3.0  # s for a running program to give way to the prompt
_RESETS = 3  # this many restarts within one listening are a boot loop
_INTERRUPT, _RAW, _EXECUTE = b"\r\x03", b"\r\x01", b"\x04"
_PROMPT = b"raw REPL; CTRL-B to exit\r\n>"


def find(said: bytes) -> str | None:
    """Version in the first hello (firmware/lib/link/protocol.py) among these bytes; None if there is none yet."""
    compat.install()
    from link import frames as whole_frames
    from link import protocol

    for kind, _, payload in whole_frames.decode(said):
        if kind == protocol.HELLO:
            try:
                return str(json.loads(payload[struct.calcsize(protocol.HELLO_FORMAT) :])["firmware"])
            except (ValueError, KeyError, TypeError, RecursionError):
                continue  # of another firmware, before this one
    return None


def ask_prompt(port: str, seconds: float = PATIENCE) -> tuple[bool, bytes]:
    """Whether MicroPython lets go of what it runs and comes to its prompt; and what the board said.

    Asked directly, because mpremote waits far longer for a no.
    """
    said = b""
    with _opened(port) as line:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            said += _enter_raw(line, timeout=0.5)
            if said.endswith(_PROMPT):
                return True, said
    return False, said


def wait_for_prompt(port: str, timeout: float = 30) -> None:
    """Returns when a board that has just been restarted answers.

    Raises FlashError, with the reason if the board gives one, after `timeout` s. A blank board makes its file system at its first start, which takes some seconds.
    """
    end = time.monotonic() + timeout
    while True:
        answers, said = ask_prompt(port)
        if answers:
            return
        if said.count(b"rst:0x") >= _RESETS or time.monotonic() > end:
            raise diagnose(said, "MicroPython does not answer")


def restart(port: str, timeout: float = 20) -> str:
    """Reset the board and return the version its firmware says hello with. Raises FlashError with the board's own words if it does not.

    The port stays open over the reset, so that nothing said is missed; that is why the reset is not left to mpremote.
    """
    with _opened(port) as line:
        if not (said := _enter_raw(line, timeout=5)).endswith(_PROMPT):
            raise diagnose(said, "the board does not stop its program")
        line.write(b"import machine; machine.reset()" + _EXECUTE)
        said = b""
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            said += line.read(max(1, line.in_waiting))
            if version := find(said):
                return version
            if b"Traceback" in said and said.rstrip().endswith(b">>>") or said.count(b"rst:0x") > _RESETS:
                break
        raise diagnose(said, "the firmware did not say hello")


def diagnose(said: bytes, what: str) -> FlashError:
    """The error for a board that said `said` and then did not do what it should; `what` names that."""
    text = said.decode(errors="replace")
    if "Brownout" in text:
        return FlashError(
            "the board resets itself: its supply voltage drops",
            "feed it from a stronger USB port or a shorter cable; unplug servos and motors while flashing",
        )
    if text.count("rst:0x") >= _RESETS:
        return FlashError(
            "the board restarts over and over (boot loop)",
            "run make flash again; if it stays so: BAUD=115200, a better cable, another board",
        )
    if trace := re.search(r"Traceback.*", text, re.DOTALL):
        return FlashError(
            f"the firmware stopped with an error:\n{trace[0].strip()}",
            "correct robot.json or the file named above, then make deploy",
        )
    if not text.strip():
        return FlashError(what, "the board is silent: press its EN (reset) button, check the cable, then run this again")
    return FlashError(f"{what}; the board said:\n{text.strip()[-800:]}", tools.remedy(""))


def _opened(port: str) -> serial.Serial:
    try:
        return serial.Serial(port, BAUD, timeout=0.1, exclusive=True)
    except (serial.SerialException, OSError) as error:
        raise FlashError(f"cannot open {port}: {error}", tools.remedy(str(error))) from None


def _enter_raw(line: serial.Serial, timeout: float) -> bytes:
    """Ask for the raw prompt; returns what the board said, up to the prompt if it came."""
    line.write(_INTERRUPT + _RAW)
    said = b""
    end = time.monotonic() + timeout
    while not said.endswith(_PROMPT) and time.monotonic() < end:
        said += line.read(1)
    return said
