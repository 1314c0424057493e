"""What planner/reasons.py and safety/faults.py number, in words. Loaded when somebody asks for the names, and where there is a screen."""

import json

from micropython import const

from link import messages

_NAMES = const(0x0C)

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
    "waiting for a start: page, screen, or button held a second",
    "waiting for a goal on its map",
    "at its goal",
    "alarm: the goal cannot be reached",
    "standing, as it does not know where it is on its map",
)

# By the numbers of safety/faults.py
FAULTS = (
    "all is well",
    "stop button pressed",
    "lidar is silent: check its supply, motor and data line",
    "a PWM chip does not answer: check its supply and the I2C lines",
    "battery is empty: charge it",
    "well again, waiting a moment before driving on",
    "computing takes too long",
    "out of memory: see the log",
    "a PWM chip was lost three times: look for dips of its supply",
    "part of the program failed: see the log",
    "part of the program hung and was restarted: see the log",
    "no steering within the wheels' limits: see the log",
    "what the lidar sees cannot be trusted: look at it",
    "nothing moves: held, or no power",
    "turns the wrong way",
    "moves too slowly, or slips",
)


def names(data):
    """All of them as NAMES into the encoder's data, one after the other; returns its length."""
    length = 0
    between = '{"reasons": ['
    for texts in (REASONS, FAULTS):
        for what in texts:
            length = messages.text(_NAMES, data, length, (between + json.dumps(what)).encode())
            between = ","  # a frame has room for all, but not for much more
        between = '], "faults": ['
    return messages.text(_NAMES, data, length, b"]}")
