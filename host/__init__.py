"""The laptop side of the robot: twin, monitor, recording, flashing, measuring. Importing it makes the firmware's modules importable too (`from link import telemetry`); see host.compat."""

import sys

from . import compat

compat.install()


def _missing(kind, error, trace) -> None:
    """What a tool says that cannot import a package: the cure, instead of where it was missed."""
    if issubclass(kind, ModuleNotFoundError) and error.name and error.name.partition(".")[0] != __name__:
        print(f"{error.name} is not installed for this Python; run `make setup` and use .venv/bin/python", file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)


if sys.argv[:1] == ["-m"]:  # a tool is being started: python -m host.TOOL
    sys.excepthook = _missing
