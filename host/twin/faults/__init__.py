"""Faults put into a run of the twin, to see what the robot does.

    python -m host.twin Z --fault lidar-frozen        begins once the robot drives and 4 s have passed
    python -m host.twin Z --fault hang@6.5            begins at 6.5 s
    python -m host.twin --fault list

A fault acts where it would on the real robot: on the lidar's bytes (`lidar`), chips, bus and supply (`chips`), wheels and body (`wheels`), the stop
button (`button`). What goes wrong inside the processor (`board`) is done by a module of the emulated board, from outside the firmware.
"""

from . import board, button, chips, lidar, wheels  # noqa: F401, they list their faults
from .base import KINDS, Fault, Outcome

__all__ = ["KINDS", "Fault", "Outcome", "make"]


def make(text):
    """The Fault that NAME or NAME@SECONDS asks for; of None and "" the one in which nothing fails. ValueError says what there is."""
    if not text:
        return Fault()
    name, at, seconds = text.partition("@")
    kind = KINDS.get(name)
    if kind is None:
        raise ValueError(f"{name!r} is no fault; `python -m host.twin --fault list` lists them")
    try:
        at_s = float(seconds) if at else None
    except ValueError:
        at_s = -1.0
    if at_s is not None and not 0 <= at_s < 3600:
        raise ValueError(f"{text!r}: after the @ comes when the fault begins, in seconds from 0")
    fault = kind.make(**kind.settings)
    fault.prepare(name, at_s)
    return fault


def listing():
    """Lines of `--fault list`."""
    width = max(map(len, KINDS))
    return [f"{kind.name:{width}}  {kind.text}" for kind in sorted(KINDS.values(), key=lambda kind: kind.name)]
