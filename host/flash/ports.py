"""Which serial port the board is on."""

import os
import sys
from collections.abc import Callable

from host.boards import usb
from host.boards.errors import FlashError


def choose(wanted: str | None, ask: Callable[[str], str] | None = None) -> str:
    """The port to use: `wanted` if given, the only candidate, or the one picked through `ask` (a function like input()).

    Raises FlashError when there is none, when there are several and nobody to ask, or when the port may not be opened.
    """
    port = wanted or _pick(usb.candidates(), ask)
    check_access(port)
    return port


def _pick(found: list, ask: Callable[[str], str] | None) -> str:
    if not found and (trouble := usb.obstacle()):
        raise FlashError("no board found", trouble)
    if not found:
        raise FlashError(
            "no board found: there is no USB serial port",
            "plug the board in with a cable that carries data (many only charge), or name the port: PORT=/dev/ttyUSB0",
        )
    if len(found) == 1:
        return found[0].device
    lines = [f"  {number}  {port.device}  {port.description}" for number, port in enumerate(found, 1)]
    table = "several serial ports:\n" + "\n".join(lines)
    if ask is None:
        raise FlashError(table, f"name one of them: PORT={found[0].device}")
    answer = ask(f"{table}\nwhich one? [1-{len(found)}] ").strip()
    if not answer.isdigit() or not 1 <= int(answer) <= len(found):
        raise FlashError(f"{answer!r} is none of the numbers 1 to {len(found)}", f"name the port: PORT={found[0].device}")
    return found[int(answer) - 1].device


def check_access(port: str) -> None:
    """Raise FlashError if the port is not there or belongs to a group this user is not in."""
    if sys.platform == "win32" or "://" in port:
        return  # the name is not a path there; the tools report what is wrong
    if not os.path.exists(port):
        here = ", ".join(found.device for found in usb.candidates()) or "none"
        raise FlashError(f"there is no port {port} (USB serial ports now: {here})", "check the cable and the name: PORT=/dev/ttyUSB0")
    if not os.access(port, os.R_OK | os.W_OK):
        raise FlashError(
            f"no permission to use {port}",
            "join the group that owns it: sudo usermod -aG dialout $USER (uucp on Arch), then log out and in again",
        )
