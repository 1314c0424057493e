"""What is done about an exception in the loop, once the motors are off. Loaded when it happens, and let go after."""

from micropython import const

_PART = const(2)
_TOLD = const(5)  # what fails in every turn would fill the log

# By the numbers with which robot.py says who is at work
PARTS = ("start", "lidar", "planner", "drive", "link", "screen")


def survive(robot, error):
    """Count it, and tell the first few."""
    safety = robot.safety
    safety.failures += 1
    if safety.failures <= _TOLD and robot.link is not None:
        robot.link.log(2, "%s: %r" % (PARTS[robot.note[_PART]], error))
