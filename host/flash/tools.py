"""Runs esptool and mpremote, and turns what they say on failing into what to do."""

import re
import subprocess
import sys
import threading

from host.boards.errors import FlashError

OTHER_CHIP = (
    "this robot needs a plain ESP32 (WROOM-32): the image is the ESP32's, S2 and C3 have one processor core and no such UART pins, and the compiled "
    "firmware does not run on a C3 at all; check which board is on this port, or name another: PORT=..."
)

# (what a tool prints, what to do): the first that matches wins
_REMEDIES = [
    (
        r"[Pp]ermission denied",
        "join the group that owns the port: sudo usermod -aG dialout $USER (uucp on Arch), then log out and in again",
    ),
    (
        r"[Ww]rong chip argument|chip is .*not ESP32\b|Unexpected chip ID|invalid for this chip",
        OTHER_CHIP,
    ),
    (
        r"busy|in use by another program|[Cc]ould not exclusively lock",
        "close the program that uses the port (a monitor, a terminal), then run this again",
    ),
    (
        r"No such file or directory|doesn't exist|could not open port",
        "check the cable and the name of the port: PORT=/dev/ttyUSB0",
    ),
    (
        r"[Ff]ailed to connect|[Nn]o serial data received|[Ww]rong boot mode|[Tt]imed out waiting for packet",
        "hold the BOOT button while it connects; try another cable; or a lower rate: BAUD=115200",
    ),
    (
        r"MD5 of file does not match|[Ii]nvalid head of packet|[Ss]erial data stream stopped|[Cc]orrupt",
        "the line is disturbed: use a shorter cable, no hub, and a lower rate: BAUD=115200",
    ),
    (
        r"device (disconnected|reports readiness)|Input/output error|[Dd]evice not configured",
        "the board went away: check the cable and its power, then run this again",
    ),
    (
        r"ENOSPC|\[Errno 28\]|No space left",
        "not enough room on the board: remove files of your own from it (mpremote fs ls, mpremote fs rm), or make flash, which empties it",
    ),
    (
        r"could not enter raw repl",
        "the board does not answer at the prompt: press its EN (reset) button and run this again; if that fails, make flash",
    ),
    (r"No module named", "install what this needs: make setup"),
    (r"MemoryError", "press the board's EN (reset) button and run this again"),
]


def esptool(port: str, *args: str, baud: int = 460800) -> list[str]:
    """Command line of esptool for the robot's chip; args begin with esptool's own command."""
    return [sys.executable, "-m", "esptool", "--chip", "esp32", "--port", port, "--baud", str(baud), *args]


def mpremote(port: str, *args: str) -> list[str]:
    """Command line of mpremote; args may chain commands with "+"."""
    return [sys.executable, "-m", "mpremote", "connect", port, *args]


def shown(command: list[str]) -> str:
    """A command as a person would type it."""
    words = ["python" if word == sys.executable else word for word in command]
    return " ".join(f"'{word}'" if re.search(r"[\s;()']", word) else word for word in words)


def remedy(output: str) -> str:
    """What to do about a failure that printed this."""
    for pattern, text in _REMEDIES:
        if re.search(pattern, output):
            return text
    return "read the lines above; press the board's EN (reset) button and run this again"


def show(command: list[str], timeout: float = 600) -> None:
    """Run with the tool's own output and progress bars on the terminal. Raises FlashError if it fails or takes longer than `timeout` s."""
    _run(command, stdout=None, timeout=timeout)


def read(command: list[str], timeout: float = 60) -> str:
    """Run quietly; returns what it printed. Raises FlashError like `show`."""
    return _run(command, stdout=subprocess.PIPE, timeout=timeout)


def _run(command: list[str], stdout, timeout: float) -> str:
    tool = command[2]
    sys.stdout.flush()
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=stdout, stderr=subprocess.PIPE, text=True, errors="replace")
    expired = threading.Timer(timeout, process.kill)
    expired.start()
    try:
        out, err = process.communicate()
    finally:
        if process.poll() is None:
            process.kill()
        if finished_in_time := expired.is_alive():
            expired.cancel()
    if not finished_in_time:
        raise FlashError(f"{tool} did not finish within {timeout:.0f} s", remedy("could not enter raw repl"))
    if process.returncode:
        said = f"{out or ''}\n{err}".strip()
        raise FlashError(f"{tool} failed: {shown(command)}\n{said}", remedy(said))
    return out or ""
