"""The watchdog: when the loop hangs, the chip resets itself. What must be known after a reset is kept in the RTC's memory: that wears no flash.

    bytes of that memory     0, 1   b"GS": the rest is ours
                             2      the part at work, see PARTS in survive.py: one that hangs cannot say so any more
                             3      1: whoever reset it wants MicroPython's prompt, not the robot

Loaded when it begins and when it ends, and let go after.
"""

from micropython import const

_PROMPT = const(3)
_TIMEOUT_MS = const(1000)


def begin(robot, machine):
    """From now on robot.feed() has to be called once a second; nothing but a reset ends that. robot.keep(robot.note) puts the bytes where a reset
    leaves them."""
    if hasattr(machine, "RTC"):  # a build without it is watched all the same
        robot.keep = machine.RTC().memory
        robot.keep(robot.note)
    robot.feed = machine.WDT(timeout=_TIMEOUT_MS).feed


def prompt(robot, machine):
    """Everything off, and a reset, after which main.py ends before it has begun anything: at the prompt nobody would feed the watchdog."""
    try:
        robot.off()
    finally:
        robot.note[_PROMPT] = 1
        machine.RTC().memory(robot.note)
        machine.reset()
