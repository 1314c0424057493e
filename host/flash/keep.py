"""What must survive a flash: the builder's robot.json, and the key of the network link."""

import hashlib
import json
import os
import secrets
import time
from pathlib import Path

from host import compat
from host.boards import places


def backup(settings: bytes, board: str) -> Path:
    """Keep a copy of a robot.json on the laptop; returns its path. What is there already under the same content is not kept twice."""
    for path in backups(board):
        if path.read_bytes() == settings:
            return path
    folder = places.backup_dir()
    folder.mkdir(parents=True, exist_ok=True)
    stamp = time.strftime("%Y%m%d-%H%M%S")
    for attempt in range(100):
        path = folder / f"robot-{board}-{stamp}{f'-{attempt}' if attempt else ''}.json"
        try:
            with open(path, "xb") as file:
                file.write(settings)
                os.fsync(file.fileno())
            return path
        except FileExistsError:
            continue
    raise AssertionError(f"a hundred backups within a second in {folder}")


def backups(board: str) -> list[Path]:
    """The copies kept of a board's robot.json, newest first."""
    found = places.backup_dir().glob(f"robot-{board}-*.json")
    return sorted(found, key=lambda path: (path.stat().st_mtime_ns, path.name), reverse=True)


def doubts(settings: bytes, default: bytes) -> str:
    """What is wrong with a kept robot.json, or missing beside the default one; empty if nothing. It is kept all the same."""
    compat.install()
    from params.config import Config
    from params.values import ConfigError

    stands = "the robot will not drive until it is corrected"
    try:
        mine = json.loads(settings)
    except ValueError as error:
        return f"is no valid JSON ({error}): {stands}"
    if not isinstance(mine, dict):
        return f"is no JSON object: {stands}"
    try:
        Config(mine)
    except ConfigError as error:
        return f"is not what this firmware takes ({error}): {stands}"
    missing = sorted(_keys(json.loads(default)) - _keys(mine))
    return f"lacks {', '.join(missing)}: the defaults hold for these" if missing else ""


def _keys(settings: dict, prefix: str = "") -> set[str]:
    """Every key with those above it: {"avoid": {"margin": 12}} -> {"avoid.margin"}."""
    found: set[str] = set()
    for key, value in settings.items():
        found |= _keys(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key}
    return found


def new_key() -> bytes:
    return secrets.token_bytes(places.KEY_SIZE)


def save_key(key: bytes, board: str) -> Path:
    """Keep the laptop's copy of a board's key, readable by its owner only; returns its path."""
    path = places.key_path(board)
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    part = path.with_suffix(".part")
    part.unlink(missing_ok=True)
    with open(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
        file.write(key)
    return part.replace(path)


def knows_key(board: str, sha256: str) -> bool:
    """Whether the laptop's copy of a board's key is the key with this SHA-256, and a whole one."""
    path = places.key_path(board)
    if not path.exists():
        return False
    key = path.read_bytes()
    return len(key) == places.KEY_SIZE and hashlib.sha256(key).hexdigest() == sha256
