"""Why the robot does what it does. Decisions carry the number; the words to it stand in link/reason_texts.py.

Not loaded on the robot: what gives a reason has its number as a const of its own, marked "# reasons.NAME"; a test holds them against this list.
Recordings keep the numbers: one that is no longer used is not given to another reason.
"""

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
BOXED = const(11)
STOPPED = const(12)
FAULT = const(13)
MANUAL = const(14)
AGAIN = const(16)
BLOCKED = const(17)
START = const(18)
GOAL_NONE = const(19)
GOAL_THERE = const(20)
GOAL_ALARM = const(21)
GOAL_WHERE = const(22)
