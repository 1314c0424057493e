"""What the robot tells of itself, message by message: writes type and payload into `data`, the encoder's, and returns the payload's length.

protocol.py describes the payloads and has the formats as well; the tests hold them together. These functions read the parts of the robot,
change none and allocate nothing. What few ask for is in watched.py and requests.py.
"""

from struct import pack_into

from micropython import const

from link.telemetry import copy, copy_points

_TYPE = const(3)  # place of the type in a frame
_AT = const(8)  # and of the payload
_MAX = const(1390)
_TIME = const(0x3FFFFFFF)  # times are the robot's ticks_us modulo 2**30

_HELLO = const(0x01)
_DECISION = const(0x02)
_WHEELS = const(0x03)
_POINTS = const(0x04)
_HEALTH = const(0x06)
_POSE = const(0x09)

# Bytes of the fixed parts
_HELLO_SIZE = const(20)
_HELLO_SIGNED = const(12)  # bytes of it before the tag
_TAG = const(8)
_DECISION_SIZE = const(28)
_WHEELS_SIZE = const(15)
_POINTS_SIZE = const(6)
_HEALTH_SIZE = const(37)
_POSE_SIZE = const(16)

_MOST_POINTS = const(276)  # of 5 bytes each, in a frame


def text(kind, data, before, what):
    """The bytes `what` behind `before` bytes that are in place; what does not fit is cut off."""
    data[_TYPE] = kind
    count = min(len(what), _MAX - before)
    copy(what, 0, count, data, _AT + before)
    return before + count


def hello(data, session, counter, identity, signer, nonce):
    """identity: the JSON, bytes; counter: of the last command; nonce: of the greeting that is answered, empty where none is."""
    pack_into("<8sI8s", data, _AT, session, counter, b"")
    length = text(_HELLO, data, _HELLO_SIZE, identity)
    if nonce and signer is not None:
        view = memoryview(data)
        tag = signer.digest(nonce, view[_TYPE - 1 : _TYPE + 1], view[_AT : _AT + _HELLO_SIGNED], identity)
        copy(tag, 0, _TAG, data, _AT + _HELLO_SIGNED)
    return length


def decision(data, avoid, state, now_us, took_us):
    """took_us: computing time that went into the decision."""
    data[_TYPE] = _DECISION
    pack_into(
        "<IIBBhhBBBhhhBI", data, _AT, avoid.decisions, now_us & _TIME, state, avoid.mode, avoid.af, avoid.ar,
        avoid.v, avoid.window, avoid.zone, avoid.free, avoid.block_x, avoid.block_y, avoid.why, took_us,
    )  # fmt: skip
    return _DECISION_SIZE


def wheels(data, drive, now_us):
    """As they stand now."""
    data[_TYPE] = _WHEELS
    steering = drive.steering
    count = len(steering.angles)
    pack_into("<IhhhIB", data, _AT, now_us & _TIME, drive.af, drive.ar, drive.v256, steering.folded, count)
    copy(steering.angles, 0, 2 * count, data, _AT + _WHEELS_SIZE)
    copy(steering.shares, 0, 2 * count, data, _AT + _WHEELS_SIZE + 2 * count)
    return _WHEELS_SIZE + 4 * count


def points(data, avoid, now_us):
    """The latest decision's, with their windows; as many as fit."""
    data[_TYPE] = _POINTS
    count = min(avoid.points_count, _MOST_POINTS)
    pack_into("<IH", data, _AT, now_us & _TIME, count)
    at = _AT + _POINTS_SIZE
    copy_points(avoid.points_x, count, data, at)
    copy_points(avoid.points_y, count, data, at + 2 * count)
    copy(avoid.points_window, 0, count, data, at + 4 * count)
    return _POINTS_SIZE + 5 * count


def pose(data, odometry, now_us):
    """Where the robot thinks it is."""
    data[_TYPE] = _POSE
    pack_into("<IiiI", data, _AT, now_us & _TIME, odometry.x, odometry.y, odometry.heading)
    return _POSE_SIZE


def health(data, robot, dropped, refused, radio):
    """robot: as for the Link; radio: whether there is one; the counters are the link's."""
    data[_TYPE] = _HEALTH
    health, lidar = robot.health, robot.lidar
    flags = lidar.ok | robot.drive.ok << 1 | radio << 2
    pack_into(
        "<IIIHBBBIIIII", data, _AT, health.uptime_ms, health.heap_free, health.worst_us, health.battery_mv,
        lidar.speed20, flags, robot.safety.fault, lidar.frames, lidar.errors, lidar.speed_faults, dropped, refused,
    )  # fmt: skip
    return _HEALTH_SIZE
