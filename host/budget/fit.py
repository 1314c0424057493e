"""Whether a robot.json's options fit a board without PSRAM, and what to switch off if not."""

import json
from pathlib import Path

from host import micropython

from . import chip_memory, targets, trace

# What can be switched off, the first first: (what a person calls it, the values that switch it off, how to write it)
_OPTIONS = (
    ("screen", {"screen": {"kind": "none"}}, 'screen.kind to "none"'),
    ("WiFi", {"wifi": {"ssid": ""}}, 'wifi.ssid to ""'),
)


class DoesNotFit(Exception):
    """The options need more than the board has. remedy: what to switch off."""

    def __init__(self, what: str, remedy: str):
        super().__init__(what)
        self.remedy = remedy


def check(settings: bytes, firmware: Path) -> str:
    """What is left, in words, for the robot.json `settings`. Raises DoesNotFit.

    The start is run here, on a MicroPython with the board's words, and played against the model of the chip's memory. Where there is none, or where
    the settings are wrong, nothing is refused: the text says so.
    """
    try:
        port = micropython.find()
    except micropython.ToolMissing as error:
        return f"not checked: {error}"
    if port.word_bytes != 4:
        return "not checked: this machine has no MicroPython with words of 32 bits (make setup gets it where it can be had)"
    try:
        config = json.loads(settings)
        if not isinstance(config, dict):
            return f"not checked: {settings[:20]!r} is no robot.json"
        problem, left = _problem(config, firmware)
    except (ValueError, trace.Failed) as error:
        return "not checked: the start ends with " + (str(error).strip().splitlines() or ["nothing said"])[-1]
    if problem:
        raise DoesNotFit(f"these options do not fit the memory of this board: {problem}", _remedy(config, firmware))
    return f"{left} bytes of the heap are left beside what comes and goes"


def _problem(config: dict, firmware: Path) -> tuple[str, int]:
    """(what does not fit, or "", bytes of the heap left)."""
    try:
        with trace.board(config, firmware) as folder:
            memory = chip_memory.replay(trace.record(folder, trace.native_pieces(firmware)))
    except chip_memory.NoRoom as error:
        return str(error), 0
    left = memory.heap_left - targets.COMES_AND_GOES
    return ("" if left >= 0 else f"{-left} bytes of the heap are missing for what comes and goes while it drives"), left


def _remedy(config: dict, firmware: Path) -> str:
    """The fewest options that have to go, tried one by one and then together."""
    on = [option for option in _OPTIONS if _is_on(config, option[1])]
    for option in on:
        if not _problem(trace.merged(config, option[1]), firmware)[0]:
            return f"switch the {option[0]} off: set {option[2]} in robot.json; or use a board with PSRAM"
    if len(on) > 1:
        without = config
        for option in on:
            without = trace.merged(without, option[1])
        if not _problem(without, firmware)[0]:
            return "switch off " + " and ".join(f"the {name} (set {how})" for name, _, how in on) + "; or use a board with PSRAM"
    return "this firmware needs a board with PSRAM; python -m host.budget shows what takes the room"


def _is_on(config: dict, off: dict) -> bool:
    return any(config.get(group, {}).get(key, value) != value for group, values in off.items() for key, value in values.items())
