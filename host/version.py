"""The project's version: that of the firmware in this checkout, which the robot's hello tells too."""

import os
import shutil
import sys
from argparse import ArgumentParser
from pathlib import Path

from core.version import VERSION

__all__ = ["VERSION", "add_version", "python"]


def add_version(parser: ArgumentParser) -> None:
    """Give a tool its --version, and its usage the name of the Python that runs it: not every system has one called python."""
    parser.prog = parser.prog.replace("python -m", f"{python()} -m", 1)
    parser.add_argument("--version", action="version", version=f"gapseeker {VERSION}")


def python() -> str:
    """What starts this Python from here, for commands that are shown to be typed: .venv/bin/python; "python" where that is this one."""
    name = "python"
    if found := shutil.which(name):
        # A virtual environment's is a link to the system's: the folder tells them apart.
        if Path(found).parent.resolve() == Path(sys.executable).parent.resolve():
            return name
    here = os.path.relpath(sys.executable)
    return sys.executable if here.startswith("..") else here
