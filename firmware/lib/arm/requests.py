"""Commands for the arm. Loaded when the first comes, let go after (link/link.py); a movement is kept alive by commands, so it stays loaded meanwhile.

    50 ARM     what u8: 0 hold, 1 go on (what moves freezes 300 ms after the last command), 2 home, 3 play (then u8: 1 = first go slowly to where it begins),
               4 joint (then index u8, angle i16), 5 pose (then an angle i16 each); angles in 0.01 deg
    51 REACH   offset u16, then bytes of a trajectory, from 0 on without a gap; the last piece has it checked and kept

A trajectory is bytes, little-endian, in the file reach.bin:

    "GR" 1 u8, joints u8, ident u16 (of the arm), knots u16, then knots, then CRC-16 of all before
    knot: time since the one before u16 (ms; 0 in the first), then of each joint angle i16 (0.01 deg) and speed i16 (0.1 deg/s)
"""

import os
import struct
from time import ticks_us

from micropython import const

from core.crc16 import crc16

_ARM = const(0x50)
_OFF = const(0)
_WAKES = const(1)
_HOLDS = const(2)
_MOVES = const(3)
_PLAYS = const(4)

_HEAD = const(8)
_LONGEST = const(16000)  # ms between two knots
_MOST = const(8192)  # bytes of a trajectory
_NEAR = const(200)  # 0.01 deg: how far from its beginning the arm may stand
_SLOW = const(4)  # a movement to a pose takes so many times as long as the limits of speed would
_FILE = const("reach.bin")
_NEW = const("reach.new")


def carry_out(link, kind, payload, robot, driven):
    """Do what the command asks; returns the text of its REPLY. ValueError when it cannot be done, with a text for the person. As link/requests.py."""
    arm = getattr(link, "arm", None)
    if arm is None:
        raise ValueError("this robot has no arm: put arm.json on its board")
    if len(payload) < 5:
        raise ValueError("%d bytes are too few" % len(payload))
    if kind != _ARM:
        return _take_in(arm, payload)
    what = payload[4]
    if what == 1:
        arm.heard_us = ticks_us()
        return ""
    if what == 0:
        arm.freeze(1)
        return ""
    _may_move(arm, link, robot, driven)
    try:
        begin = _BEGIN[what]
    except KeyError:
        raise ValueError("arm %d: 0 hold, 1 go on, 2 home, 3 play, 4 joint, 5 pose" % what)
    text = begin(arm, payload)
    arm.heard_us = ticks_us()
    arm.why = 0
    return text


def _may_move(arm, link, robot, driven):
    if link.safety.fault:
        raise ValueError("the robot has a fault, or its stop button is pressed: the arm stays where it is")
    if not arm.while_driving and (link.state or driven or robot.drive.v256):
        raise ValueError("the robot drives: stop it first, or set while_driving in arm.json")


def _home(arm, payload):
    if arm.state == _OFF:
        for k in range(len(arm.angles)):
            arm.angles[k] = arm.rest[k]
            arm.sent[k] = -1
        arm.woken = 0
        arm.state = _WAKES
        return "its servos get their pulses, one after the other: it must lie in its rest pose"
    return _to_pose(arm, arm.rest)


def _awake(arm):
    if arm.state == _OFF:
        raise ValueError("the arm is without power: home first")
    if arm.state == _WAKES:
        raise ValueError("the arm is getting its power: a moment")


def _to_pose(arm, pose):
    """A slow movement from where it stands to a pose, rest to rest."""
    _awake(arm)
    arm.freeze(1)
    fastest = 50  # ms
    for k in range(len(arm.angles)):
        low, high, speed = arm.limits[3 * k : 3 * k + 3]
        if not low <= pose[k] <= high:
            raise ValueError("joint %d: %d.%02d deg is outside its limits %d .. %d" % (k + 1, pose[k] // 100, pose[k] % 100, low // 100, high // 100))
        # Speed is highest in the middle, half as much again as the mean.
        fastest = max(fastest, abs(pose[k] - arm.angles[k]) * 150 // speed)
    if fastest > _LONGEST:
        raise ValueError("that is too far for one movement at so slow a limit of speed: go half of it first")
    longest = min(fastest * _SLOW, _LONGEST)
    for k in range(len(arm.angles)):
        arm.before[1 + 2 * k] = arm.angles[k]
        arm.after[1 + 2 * k] = pose[k]
        arm.before[2 + 2 * k] = arm.after[2 + 2 * k] = 0
    arm.after[0] = longest
    arm.began_us = ticks_us()
    arm.state = _MOVES
    return "%d ms" % longest


def _joint(arm, payload):
    if len(payload) < 8 or payload[5] >= len(arm.angles):
        raise ValueError("a joint 0 .. %d and an angle are needed" % (len(arm.angles) - 1))
    pose = list(arm.angles)
    pose[payload[5]] = struct.unpack_from("<h", payload, 6)[0]
    return _to_pose(arm, pose)


def _pose(arm, payload):
    count = len(arm.angles)
    if len(payload) < 5 + 2 * count:
        raise ValueError("an angle for each of %d joints is needed" % count)
    return _to_pose(arm, struct.unpack_from("<%dh" % count, payload, 5))


def _play(arm, payload):
    """Start what is kept: checked again, as arm.json may have changed since, and a flash may fail."""
    _awake(arm)
    try:
        _check(arm, _FILE)
    except OSError:
        raise ValueError("no trajectory on the board: upload one first")
    arm.freeze(1)
    file = open(_FILE, "rb")
    file.seek(_HEAD)
    file.readinto(arm.before)
    far = 0
    for k in range(len(arm.angles)):
        far = max(far, abs(arm.before[1 + 2 * k] - arm.angles[k]))
    if far > _NEAR:
        file.close()
        if len(payload) > 5 and payload[5] & 1:
            begins = [arm.before[1 + 2 * k] for k in range(len(arm.angles))]
            return "first to where it begins: " + _to_pose(arm, begins) + ", then play again"
        raise ValueError("the arm stands %d.%02d deg from where the trajectory begins: let it go there first" % (far // 100, far % 100))
    for k in range(len(arm.angles)):
        arm.before[1 + 2 * k] = arm.angles[k]  # what little is missing is made up in the first stretch
    file.readinto(arm.after)
    arm.file = file
    arm.began_us = ticks_us()
    arm.state = _PLAYS
    return ""


def _take_in(arm, payload):
    """A piece of a trajectory."""
    if len(payload) < 7:
        raise ValueError("%d bytes are too few" % len(payload))
    if arm.state >= _MOVES:
        raise ValueError("the arm moves: hold it first")
    offset = payload[4] | payload[5] << 8
    try:
        have = os.stat(_NEW)[6] if offset else 0
        if offset != have or offset + len(payload) - 6 > _MOST:
            raise ValueError("offset %d: %d is next, %d bytes at most" % (offset, have, _MOST))
        with open(_NEW, "ab" if offset else "wb") as file:
            file.write(payload[6:])
            size = offset + len(payload) - 6
        with open(_NEW, "rb") as file:
            head = file.read(_HEAD)
        if len(head) < _HEAD or head[:2] != b"GR":
            raise ValueError("these are no bytes of a trajectory")
        if size < _size(head):
            return ""
        _check(arm, _NEW)
        os.rename(_NEW, _FILE)
    except OSError as error:
        raise ValueError("the trajectory cannot be written: %s" % error)
    return "kept"


def _size(head):
    return _HEAD + (2 + 4 * head[3]) * (head[6] | head[7] << 8) + 2


def _check(arm, name):
    """ValueError unless the file is a whole trajectory for this arm, within its limits. OSError where there is none."""
    if os.stat(name)[6] > _MOST:
        raise ValueError("the trajectory is larger than %d bytes" % _MOST)
    with open(name, "rb") as file:
        data = file.read()
    count = len(arm.angles)
    size = len(data)
    if size < _HEAD + 2 or data[:3] != b"GR\x01" or data[3] != count or size != _size(data):
        raise ValueError("the trajectory is cut off, or of another arm: %d bytes" % size)
    if crc16(data, 0, size - 2) != data[-2] | data[-1] << 8:
        raise ValueError("the trajectory is damaged: its check does not hold")
    if data[4] | data[5] << 8 != arm.ident:
        raise ValueError("the trajectory is for another arm, or for other limits: plan it with this robot's arm.json")
    knots = data[6] | data[7] << 8
    if knots < 2:
        raise ValueError("the trajectory has no way to go")
    before = None
    for number in range(knots):
        knot = struct.unpack_from("<H%dh" % (2 * count), data, _HEAD + (2 + 4 * count) * number)
        if number in (0, knots - 1) and any(knot[2 + 2 * k] for k in range(count)):
            raise ValueError("the trajectory does not begin and end at rest")
        _check_knot(arm.limits, before, knot, number)
        before = knot


def _check_knot(limits, before, knot, number):
    span = knot[0]
    if before and not 1 <= span <= _LONGEST or not before and span:
        raise ValueError("knot %d: its time goes back, stands or is too far: %d ms" % (number, span))
    for k in range(len(knot) // 2):
        angle, speed = knot[1 + 2 * k], knot[2 + 2 * k]
        if not limits[3 * k] <= angle <= limits[3 * k + 1]:
            raise ValueError("knot %d: joint %d at %d (0.01 deg) is outside its limits" % (number, k + 1, angle))
        if abs(speed) > limits[3 * k + 2]:
            raise ValueError("knot %d: joint %d turns faster than it may" % (number, k + 1))
        if before and abs(angle - before[1 + 2 * k]) * 100 > limits[3 * k + 2] * span:
            raise ValueError("knot %d: joint %d jumps" % (number, k + 1))
        if abs(speed) * span // 100 > 60000:
            raise ValueError("knot %d: joint %d is too fast for so long a stretch" % (number, k + 1))


_BEGIN = {2: _home, 3: _play, 4: _joint, 5: _pose}
