"""What reasons.py and health.py number, in words. Loaded when somebody asks for the names, and where there is a screen."""

import json

# By the numbers of reasons.py
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
    "",
    "",  # no longer used
    "closed in, standing still",
    "stopped by command or button",
    "fault, standing still",
    "driven by hand",
    "",
    "been here before, trying another way",
    "something new in the way, stopped",
)

# By the faults of health.py
FAULTS = (
    "all is well",
    "stop button pressed",
    "lidar is silent: check its supply, motor and data line",
    "a PWM chip does not answer: check its supply and the I2C lines",
    "battery is empty: charge it",
    "well again, waiting a moment before driving on",
)


def names():
    """All of them as the JSON of the message NAMES, bytes."""
    return json.dumps({"reasons": REASONS, "faults": FAULTS}).encode()
