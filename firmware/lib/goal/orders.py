"""Commands about goals and the map: GO and MAP of link/protocol.py. Loaded when one comes, let go after."""

import os
import struct

from micropython import const

from core.unload import unload
from goal import route
from goal.pose import again

_GO = const(0x49)
_AT = const(4)  # of the payload, behind the counter
_QUEUE = const(8)
_X = const(24)  # layer.py
_Y = const(25)
_TURN = const(26)
_FAILED = const(35)
_STAGE = const(43)
_POSE = const(3)
_ERROR = const(7)
_WAITING = const(19)
_PATROL = const(20)
NEW = "map.new"
FILE = "map.bin"


def obey(robot, kind, payload):
    """Returns the text of the REPLY. ValueError when it cannot be done, with a text for the person."""
    robot.drive.stop()
    if kind != _GO:
        return _store(payload)
    goal = robot.goal
    if goal is None:
        raise ValueError("there is no map on the board: python -m host.map sends one, then restart it")
    if len(payload) < 11:
        raise ValueError("%d bytes are too few" % len(payload))
    what, x, y, heading = struct.unpack_from("<Bhhh", payload, _AT)
    told = goal.told
    if what == 0:
        told[_WAITING] = told[_PATROL] = 0
        goal.go()
    elif what in (1, 2):
        _there(goal, x, y, what == 2)
    elif what == 3:
        _free(goal, x, y)
        n = goal.numbers
        n[_X], n[_Y] = x << 8, y << 8
        n[_TURN] = (heading * 100 - robot.odometry.heading) % 360000
        _look_again(goal, 1)
    elif what == 4:
        route.forget(goal)
        if told[_POSE] == 3:
            _look_again(goal, 0)
        else:
            goal.go()
    elif what == 5:
        told[_PATROL] = x != 0
    elif what == 6:
        if not 0 <= x <= 2:
            raise ValueError("method %d: 0 gap, 1 field, 2 behaviour" % x)
        from goal.build import choose

        choose(goal, x)
        choose = None
        unload("goal.build")
        if told[0] == 1:
            goal.go()
    elif what == 7:
        _look_again(goal, 0)
    else:
        raise ValueError("go %d: 0 to 7 are known" % what)
    return ""


def _free(goal, x, y):
    n = goal.numbers
    if x < 0 or y < 0 or x // n[2] >= n[0] or y // n[2] >= n[1] // n[0] or goal.cells[route.cell_at(n, x, y)] == 0xFFFF:
        raise ValueError("%d, %d mm lies in a wall or beside the map" % (x, y))


def _there(goal, x, y, later):
    _free(goal, x, y)
    queue = goal.queue
    told = goal.told
    if not later:
        told[_WAITING] = 0
    at = told[_WAITING]
    if at >= _QUEUE:
        raise ValueError("%d goals are waiting, more are not kept" % _QUEUE)
    queue[2 * at] = x
    queue[2 * at + 1] = y
    told[_WAITING] = at + 1
    if not at:
        goal.asked = True
        goal.go()


def _look_again(goal, state):
    """The pose is to be found: near what has been given (1), or anywhere (0)."""
    goal.told[_POSE] = state
    goal.numbers[_FAILED] = goal.numbers[_STAGE] = 0
    goal.told[_ERROR] = 999
    again(goal.numbers)
    goal.locate = None
    goal.asked = True
    goal.hold(4, 22)  # SEARCHING, reasons.GOAL_WHERE


def _store(payload):
    """A part of the map's file. It is written beside the old one, checked as a whole, and put in its place in one step."""
    if len(payload) < 10:
        raise ValueError("%d bytes are too few" % len(payload))
    first, size, check = struct.unpack_from("<HHH", payload, _AT)
    part = payload[10:]
    try:
        if first:
            have = os.stat(NEW)[6]
            if have != first:
                raise ValueError("byte %d was expected, %d came: send it again" % (have, first))
        with open(NEW, "ab" if first else "wb") as file:
            file.write(part)
        if first + len(part) < size:
            return ""
        from core.crc16 import crc16

        with open(NEW, "rb") as file:
            data = file.read()
        if len(data) != size or crc16(data, 0, size) != check:
            raise ValueError("what has arrived is damaged: send it again")
        data = None
        from goal.build import load

        try:
            load(NEW)
        finally:
            load = None
            unload("goal.build")
        os.rename(NEW, FILE)
    except OSError as error:
        raise ValueError("the map cannot be written: %s" % error) from None
    return "the map is kept, and counts from the next start"
