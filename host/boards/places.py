"""Where the laptop keeps what belongs to a robot: outside the project, so that a fresh copy of it finds them again."""

import os
import sys
from pathlib import Path

KEY_SIZE = 32  # bytes of a board's network key


def _home(variable: str, windows: str, default: str) -> Path:
    base = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else variable)
    if sys.platform == "win32":
        return Path(base or Path.home()) / "gapseeker" / windows
    return (Path(base) if base else Path.home() / default) / "gapseeker"


def config_dir() -> Path:
    """Keys and backups: things that cannot be made again."""
    return _home("XDG_CONFIG_HOME", "config", ".config")


def cache_dir() -> Path:
    """Downloads: may be removed at any time."""
    return _home("XDG_CACHE_HOME", "cache", ".cache")


def backup_dir() -> Path:
    """Every robot.json ever found on a board that was about to change."""
    return config_dir() / "backups"


def key_path(board: str) -> Path:
    """The network key of the board with this identity (machine.unique_id in hex): KEY_SIZE raw bytes, mode 600."""
    return config_dir() / "keys" / f"{board}.key"
