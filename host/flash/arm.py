"""arm.json on its way to the board: checked against the robot.json that will be there, and kept through a flash as robot.json is."""

import json
import tempfile
from pathlib import Path

from host import compat
from host.arm import board as on_board
from host.arm import model
from host.arm.errors import ArmError
from host.boards.errors import FlashError

FILE = "arm.json"


def check(arm: bytes, settings: bytes) -> str:
    """What is found, in words. FlashError if the board could not take the arm: no servos, or no room beside the wheels on the servos' chip."""
    compat.install()
    from params.config import Config
    from params.values import ConfigError

    remedy = "correct it, or leave it out; docs/arm.md says what it may hold"
    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / FILE
            path.write_bytes(arm)
            found = model.read(model.read_json(path, "arm"), FILE)
    except ArmError as error:
        raise FlashError(str(error).replace(f"{folder}/", ""), remedy) from None
    if found.servos is None:
        raise FlashError(f"{FILE} has no servos: nothing on the board could move that arm", remedy)
    farthest = max(max(abs(low), abs(high)) for low, high, _ in on_board.rows(found))
    if farthest > on_board.FARTHEST:
        raise FlashError(f"{FILE}: a joint goes to {farthest:g} deg; the board's set points end at {on_board.FARTHEST:g}", remedy)
    try:
        config = Config(json.loads(settings))
    except (ConfigError, ValueError):
        return f"{found.name}; not held against robot.json, which is wrong itself"
    wheels = list(config.servos_channels)
    free = [channel for channel in range(16) if channel not in wheels]
    taken = [channel for channel in found.servos.channels if channel in wheels]
    if taken:
        room = f"the {config.axles} axles leave {len(free)} outputs ({', '.join(map(str, free)) or 'none'}), the arm wants {len(found.servos.channels)}"
        raise FlashError(f"{FILE}: servos.channels: output {taken[0]} of the servos' chip is a wheel's: {room}", remedy)
    return f"{found.name}, {len(found.servos.channels)} servos on outputs {', '.join(map(str, found.servos.channels))}"
