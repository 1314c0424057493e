"""Why the robot does what it does, in words. Decisions carry the index; screens and pages show the text."""

from micropython import const

WAITING = const(0)
ON = const(1)
BEND = const(2)
CENTRE = const(3)
CRAB = const(4)
PLAN = const(5)
LOOKING = const(6)
BACK = const(7)
TURNED = const(8)
NEAR = const(9)
TOUCH = const(10)
BOXED = const(11)
STOPPED = const(12)
FAULT = const(13)
MANUAL = const(14)
SPIN = const(15)
AGAIN = const(16)
BLOCKED = const(17)

REASONS = (
    "waiting for the lidar",
    "way ahead is free",
    "steering through the gap",
    "opening the distance to an obstacle",
    "moving sideways to line up",
    "second part of a planned move",
    "way ahead closes, comparing two moves at a time",
    "backing out",
    "backing up to line up with the gap",
    "obstacle in the emergency window, getting away",
    "touching, moving away from the point of contact",
    "closed in, standing still",
    "stopped by command",
    "fault, standing still",
    "driven by hand",
    "turning on the spot",
    "been here before, trying another way",
    "something new in the way, stopped",
)
