"""The laptop side of the robot: twin, monitor, recording, flashing, measuring. Importing it makes the firmware's modules importable too (`from link import telemetry`); see host.compat."""

from . import compat

compat.install()
