"""Payloads of the wire format (firmware/lib/link/protocol.py) as dicts that JSON can hold, and commands as payloads.

Every dict has `type`; angles are degrees, lengths mm, speeds mm/s or r/s, times seconds of the robot's own clock (it wraps after 18 minutes).

    hello       session (hex), counter, firmware, robot, board, boot, width, length, track, spacings, first, full_speed, lidar
    decision    number, time, state, mode, af, ar, v, window, zone, free, block ([x, y] or None), why, took (ms)
    wheels      time, af, ar, v, angles, speeds (mm/s at the wheels, negative backward)
    points      time, x, y, window
    scan        bearings, distances (mm), times
    health      uptime, heap, worst (ms), battery (V or None), lidar_speed, lidar_ok, chips, radio, fault, frames, errors, speed_faults,
                dropped, refused
    parameter   key, value, default, low, high, unit, meaning, number, of, restart (it counts from the next start)
    log         level, text
    pose        time, x, y, heading: where the robot thinks it is, from where it was switched on
    candidates  time, side ("right" or "left"), backward, list of {af, ar, free, chosen}; free is None where others promised more, so that it was not looked at
    reply       counter, command, status, text
    names       reasons, faults
    turns       time, count (turns of the loop since the last), parts (names), sums, most: ms that each part took of them, and at most of one
    arm         state, why (what froze it last), angles (its set points): only of a robot with an arm
    goal        time, state ("none", "going", "there", "alarm", "searching", "lost"), alarm (words or None), method ("gap", "field", "behaviour"), pose_state ("guessed", "given", "known",
                "lost"), x, y, heading, error (mm, its own estimate), fits (percent), goal ([x, y]), steer ([x, y]), length (of the way, cells; None: there is none), door (number or None),
                through (likewise), open (mm or None), middle, searches, waiting, patrol; mm on the map
    cells       time, first, cells: a part of the map's cells, numbers as firmware/lib/goal/kernels.py describes them
    map         rows, cols, cell (mm), origin ([x, y] of the lower left corner for whoever drew it), doors (list of {x, y, normal, width})

Links add some of their own:

    text        text: what the robot printed between the frames
    truth       x, y, heading, clearance: where it really is (twin, recordings of the twin)
    world       walls ([[x1, y1, x2, y2], ...]), course (twin)
    moving      walls, as of `world`: sides of what moves (twin)
    pace        speed (factor on real time, None: as fast as it goes), paused (twin)
    box         x, y, size (mm, 0: none): the box that was put into the robot's way (twin)
    event       text, time
    ended       text: nothing more will come
"""

import json
import math
import struct

from link import auth, protocol
from params import schema
from planner import reasons
from safety.survive import PARTS

STATES = ("stopped", "auto", "manual")  # "waiting", for its first start after power-up, is a decision of its own
STATUSES = ("ok", "refused")
ARM_STATES = ("off", "wakes", "holds", "moves", "plays")
ARM_WHY = ("nothing", "told to hold", "a fault of the robot", "the link was lost", "the wheels began to turn", "the servos' chip was lost")
ARM_COMMANDS = ("hold", "go on", "home", "play", "joint", "pose")
GOAL_STATES = ("none", "going", "there", "alarm", "searching", "lost")
ALARMS = (None, "door shut", "goal walled in", "no progress")
METHODS = ("gap", "field", "behaviour")
POSE_STATES = ("guessed", "given", "known", "lost")
GO = ("give up", "there", "later", "here", "on", "patrol", "method", "search")
WINDOWS = 5  # none, green, red, blue, yellow
FULL_V256 = 90 * 256
_HELLO_WITHOUT_TAG = 12  # bytes before the JSON in version 0.1.0 and before
_NOT_LOOKED_AT = 65535  # free length of such a candidate
_KNOWN = {key: {"default": default, "unit": unit, "meaning": meaning} for key, _, default, _, _, unit, meaning in schema.rows(schema.LIVE)}


def decode(kind: int, payload: bytes, full_speed: float = 1280.0) -> dict | None:
    """A message as a dict; None for a type, a length or a content that this version does not know, whatever it may be.

    full_speed: mm/s of the wheels at V = 180, for `wheels`.
    """
    try:
        if kind == protocol.WHEELS:
            return _wheels(payload, full_speed)
        return _DECODERS[kind](payload) if kind in _DECODERS else None
    except (struct.error, ValueError, IndexError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        return None


def _json(text: bytes) -> dict:
    """A JSON object without what JSON itself does not have: no NaN, no infinity. Raises ValueError or RecursionError."""
    told = json.loads(text, parse_constant=_finite, parse_float=_finite)
    if not isinstance(told, dict):
        raise ValueError("no JSON object")
    return told


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is no number")
    return number


def _is_number(value) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e9


def _are_numbers(value) -> bool:
    return isinstance(value, list) and all(map(_is_number, value))


def _is_text(value) -> bool:
    return isinstance(value, str)


def _is_board(value) -> bool:
    """It becomes part of a file's name."""
    return isinstance(value, str) and 0 < len(value) <= 64 and all(digit in "0123456789abcdef" for digit in value)


_HELLO_FIELDS = {
    "firmware": _is_text, "robot": _is_text, "board": _is_board, "boot": _is_text, "width": _is_number, "length": _is_number, "track": _is_number,
    "first": _is_number, "full_speed": _is_number, "spacings": _are_numbers, "lidar": lambda value: _are_numbers(value) and len(value) == 2,
}  # fmt: skip


def _block(x, y):
    return None if x == protocol.NO_POINT else [x, y]


def _hello(payload):
    session, counter, _ = struct.unpack_from(protocol.HELLO_FORMAT, payload)
    try:
        rest = _json(payload[struct.calcsize(protocol.HELLO_FORMAT) :])
    except ValueError:
        rest = _json(payload[_HELLO_WITHOUT_TAG:])  # in recordings
    for name in ("robot", "board"):
        rest[name]  # those who connect need them
    wrong = [name for name, fits in _HELLO_FIELDS.items() if name in rest and not fits(rest[name])]
    if wrong:
        raise ValueError(f"{wrong[0]} cannot be")
    return {**rest, "type": "hello", "session": session.hex(), "counter": counter}


def _decision(payload):
    number, time, state, mode, af, ar, v, window, zone, free, x, y, why, took = struct.unpack(protocol.DECISION_FORMAT, payload)
    if window >= WINDOWS:
        raise ValueError(f"window {window} cannot be")
    waits = state == protocol.STOPPED and why == reasons.START
    return {
        "type": "decision", "number": number, "time": time / 1e6, "state": "waiting" if waits else STATES[state], "mode": mode, "af": af / 10, "ar": ar / 10, "v": v,
        "window": window, "zone": None if zone == 255 else zone, "free": free, "block": _block(x, y), "why": why, "took": took / 1000,
    }  # fmt: skip


def _wheels(payload, full_speed):
    size = struct.calcsize(protocol.WHEELS_FORMAT)
    time, af, ar, v256, folded, count = struct.unpack_from(protocol.WHEELS_FORMAT, payload)
    angles = struct.unpack_from(f"<{count}h", payload, size)
    shares = struct.unpack_from(f"<{count}h", payload, size + 2 * count)
    scale = v256 * full_speed / FULL_V256 / 16384
    return {
        "type": "wheels", "time": time / 1e6, "af": af / 10, "ar": ar / 10, "v": round(90 + v256 / 256, 2), "folded": folded,
        "angles": [angle / 10 for angle in angles], "speeds": [round(share * scale, 1) for share in shares],
    }  # fmt: skip


def _points(payload):
    size = struct.calcsize(protocol.POINTS_FORMAT)
    time, count = struct.unpack_from(protocol.POINTS_FORMAT, payload)
    windows = list(payload[size + 4 * count :])
    if len(windows) != count or max(windows, default=0) >= WINDOWS:
        raise ValueError("windows that cannot be")
    return {
        "type": "points", "time": time / 1e6, "x": list(struct.unpack_from(f"<{count}h", payload, size)),
        "y": list(struct.unpack_from(f"<{count}h", payload, size + 2 * count)), "window": windows,
    }  # fmt: skip


def _scan(payload):
    size = struct.calcsize(protocol.SCAN_FORMAT)
    bearings, distances, times = [], [], []
    at = 0
    while at < len(payload):
        time, first, last, count = struct.unpack_from(protocol.SCAN_FORMAT, payload, at)
        step = ((last - first + 1800) % 3600 - 1800) / max(count - 1, 1)
        bearings += [round((first + step * i) % 3600 / 10, 2) for i in range(count)]
        distances += [quarter / 4 for quarter in struct.unpack_from(f"<{count}H", payload, at + size)]
        times.append(time / 1e6)
        at += size + 2 * count
    return {"type": "scan", "times": times, "bearings": bearings, "distances": distances}


def _health(payload):
    uptime, heap, worst, battery, speed, flags, fault, frames, errors, faults, dropped, refused = struct.unpack(protocol.HEALTH_FORMAT, payload)
    return {
        "type": "health", "uptime": uptime / 1000, "heap": heap, "worst": worst / 1000, "battery": battery / 1000 if battery else None,
        "lidar_speed": speed / 20, "lidar_ok": bool(flags & 1), "chips": bool(flags & 2), "radio": bool(flags & 4), "fault": fault,
        "frames": frames, "errors": errors, "speed_faults": faults, "dropped": dropped, "refused": refused,
    }  # fmt: skip


def _pose(payload):
    time, x, y, heading = struct.unpack(protocol.POSE_FORMAT, payload)
    return {"type": "pose", "time": time / 1e6, "x": x / 256, "y": y / 256, "heading": heading / 1000}


def _candidates(payload):
    size = struct.calcsize(protocol.CANDIDATES_FORMAT)
    time, variant, chosen, count = struct.unpack_from(protocol.CANDIDATES_FORMAT, payload)
    values = struct.unpack_from(f"<{2 * count}h{count}H", payload, size)
    rows = []
    for k in range(count):
        af, ar, free = values[k] / 10, values[count + k] / 10, values[2 * count + k]
        if free == _NOT_LOOKED_AT:
            free = None
        if variant & 1:
            af, ar = -af, -ar
        if variant & 2:
            af, ar = -ar, -af
        rows.append({"af": af, "ar": ar, "free": free, "chosen": k == chosen})
    return {"type": "candidates", "time": time / 1e6, "side": ("right", "left")[variant & 1], "backward": bool(variant & 2), "list": rows}


def _parameter(payload):
    """The robot tells the value; default, unit and meaning are the same here as there, and it has no room for them."""
    told = _json(payload)
    key = told["key"]
    told["value"]
    if not isinstance(told.get("number", 0), int) or not isinstance(told.get("of", 1), int):
        raise ValueError("numbers that cannot be")
    if key.startswith("servos.trims."):
        wheel = int(key.rpartition(".")[2])
        known = {"default": 0, "unit": "deg", "meaning": f"trim of axle {wheel // 2 + 1} {('left', 'right')[wheel % 2]}"}
    else:
        # A default of None goes with the body: only the robot knows it.
        known = _KNOWN.get(key, {"default": told["value"], "unit": "", "meaning": key})
    return {**known, **told, "type": "parameter"}


def _turns(payload):
    time, count, *values = struct.unpack(protocol.TURNS_FORMAT, payload)
    sums, most = values[0::2], values[1::2]
    return {"type": "turns", "time": time / 1e6, "count": count, "parts": list(PARTS), "sums": [v / 1000 for v in sums], "most": [v / 1000 for v in most]}


def _arm(payload: bytes) -> dict:
    size = struct.calcsize(protocol.ARM_STATE_FORMAT)
    state, why, count = struct.unpack_from(protocol.ARM_STATE_FORMAT, payload)
    angles = struct.unpack_from(f"<{count}h", payload, size)
    return {"type": "arm", "state": ARM_STATES[state], "why": ARM_WHY[why], "angles": [angle / 100 for angle in angles]}


def _reply(payload):
    counter, kind, status = struct.unpack_from(protocol.REPLY_FORMAT, payload)
    text = payload[struct.calcsize(protocol.REPLY_FORMAT) :].decode(errors="replace")
    return {"type": "reply", "counter": counter, "command": COMMANDS.get(kind, str(kind)), "status": STATUSES[status], "text": text}


def _names(payload):
    told = _json(payload)
    for name in ("reasons", "faults"):
        if not isinstance(told[name], list) or not all(map(_is_text, told[name])):
            raise ValueError(f"{name} that cannot be")
    return {**told, "type": "names"}


def _goal(payload):
    (
        time,
        state,
        alarm,
        method,
        pose,
        x,
        y,
        heading,
        error,
        fits,
        goal_x,
        goal_y,
        steer_x,
        steer_y,
        length,
        door,
        through,
        wide,
        middle,
        searches,
        waiting,
        patrol,
    ) = struct.unpack(protocol.GOAL_FORMAT, payload)
    if min(state, alarm, method, pose) < 0:
        raise ValueError("a state that cannot be")
    return {
        "type": "goal", "time": time / 1e6, "state": GOAL_STATES[state], "alarm": ALARMS[alarm], "method": METHODS[method], "pose_state": POSE_STATES[pose],
        "x": x, "y": y, "heading": heading / 10, "error": error, "fits": fits, "goal": [goal_x, goal_y], "steer": [steer_x, steer_y],
        "length": None if length < 0 else length / 5, "door": None if door < 0 else door, "through": None if through < 0 else through,
        "open": None if wide < 0 else wide, "middle": middle, "searches": searches, "waiting": waiting, "patrol": bool(patrol),
    }  # fmt: skip


def _cells(payload):
    time, first = struct.unpack_from(protocol.CELLS_FORMAT, payload)
    size = struct.calcsize(protocol.CELLS_FORMAT)
    return {"type": "cells", "time": time / 1e6, "first": first, "cells": list(struct.unpack(f"<{(len(payload) - size) // 2}H", payload[size:]))}


def _map(payload):
    at = struct.calcsize(protocol.MAP_FORMAT)
    version, rows, cols, count, cell, field_rows, field_cols, spacing, _, x, y = struct.unpack_from("<BBBBHBBHHii", payload, at)
    at += struct.calcsize("<BBBBHBBHHii")
    doors = [struct.unpack_from("<4H", payload, at + 8 * k) for k in range(count)]
    if not rows or not cols or not cell:
        raise ValueError("a map that cannot be")
    return {
        "type": "map", "rows": rows, "cols": cols, "cell": cell, "origin": [x, y],
        "doors": [{"x": x, "y": y, "normal": normal / 10, "width": width} for x, y, normal, width in doors],
    }  # fmt: skip


_DECODERS = {
    protocol.GOAL: _goal,
    protocol.CELLS: _cells,
    protocol.MAP: _map,
    protocol.HELLO: _hello,
    protocol.DECISION: _decision,
    protocol.POINTS: _points,
    protocol.SCAN: _scan,
    protocol.HEALTH: _health,
    protocol.PARAMETER: _parameter,
    protocol.LOG: lambda payload: {"type": "log", "level": payload[0], "text": payload[1:].decode(errors="replace")},
    protocol.POSE: _pose,
    protocol.CANDIDATES: _candidates,
    protocol.REPLY: _reply,
    protocol.ARM_STATE: _arm,
    protocol.NAMES: _names,
    protocol.TURNS: _turns,
}

COMMANDS = {
    protocol.DRIVE: "drive",
    protocol.TUNE: "tune",
    protocol.KEEP: "keep",
    protocol.WATCH: "watch",
    protocol.LIST: "list",
    protocol.POINT: "point",
    protocol.GREET: "greet",
    protocol.RESTART: "restart",
    protocol.ARM: "arm",
    protocol.REACH: "reach",
    protocol.GO: "go",
    protocol.PUT_MAP: "map",
}


def drive(counter: int, what: str, af: float = 0, ar: float = 0, v: float = 90) -> bytes:
    """what: "stop", "auto" or "manual"; af, ar in degrees, v 0..180. ValueError beyond these."""
    states = {"stop": protocol.STOPPED, "auto": protocol.AUTO, "manual": protocol.MANUAL}
    if what not in states:
        raise ValueError(f"drive {what!r}: one of {', '.join(states)} is needed")
    if not (-90 <= af <= 90 and -90 <= ar <= 90 and 0 <= v <= 180):
        raise ValueError(f"AF {af}, AR {ar} (-90 to 90 degrees), V {v} (0 to 180)")
    return struct.pack(protocol.DRIVE_FORMAT, counter, states[what], round(af * 10), round(ar * 10), round(v))


def tune(counter: int, key: str, value) -> bytes:
    """value: what JSON can hold."""
    return struct.pack(protocol.COUNTER_FORMAT, counter) + f"{key}={json.dumps(value)}".encode()


def arm(counter: int, what: str, approach: bool = False, joint: int = 0, angle: float = 0.0, angles=()) -> bytes:
    """what: one of ARM_COMMANDS. approach: with "play", go first to where it begins. joint (0 ..), angle: with "joint"; angles: of all joints, with "pose"; degrees."""
    if what not in ARM_COMMANDS:
        raise ValueError(f"arm {what!r}: one of {', '.join(ARM_COMMANDS)} is needed")
    data = struct.pack(protocol.COUNTER_FORMAT, counter) + bytes((ARM_COMMANDS.index(what),))
    if what == "play":
        data += bytes((approach,))
    elif what == "joint":
        data += struct.pack("<Bh", joint, _hundredths(angle))
    elif what == "pose":
        data += struct.pack(f"<{len(angles)}h", *(_hundredths(one) for one in angles))
    return data


def _hundredths(angle):
    if not -320 <= angle <= 320:
        raise ValueError(f"{angle:g} degrees: a joint's angle lies within 320")
    return round(100 * angle)


def reach(counter: int, offset: int, data: bytes) -> bytes:
    """A piece of a trajectory, at most 190 bytes."""
    return struct.pack("<IH", counter, offset) + data


def plain(counter: int) -> bytes:
    """Payload of KEEP, LIST and RESTART."""
    return struct.pack(protocol.COUNTER_FORMAT, counter)


def watch(counter: int, scan: bool, candidates: bool, turns: bool = False) -> bytes:
    return struct.pack(protocol.WATCH_FORMAT, counter, scan | candidates << 1 | turns << 2)


def point(counter: int, wheel: int, angle: float) -> bytes:
    """angle in degrees."""
    return struct.pack(protocol.POINT_FORMAT, counter, wheel, round(angle * 10))


def go(counter: int, what: str, x: float = 0, y: float = 0, heading: float = 0) -> bytes:
    """what: one of GO; x, y in mm on the map (of "patrol": 0 or 1, of "method": its number), heading in degrees. ValueError beyond these."""
    if what not in GO:
        raise ValueError(f"go {what!r}: one of {', '.join(GO)} is needed")
    if not (abs(x) <= 32767 and abs(y) <= 32767):
        raise ValueError(f"{x:g}, {y:g} mm lies beside every map")
    return struct.pack(protocol.GO_FORMAT, counter, GO.index(what), round(x), round(y), round((heading + 180) % 360 * 10) - 1800)


def put_map(counter: int, first: int, size: int, check: int, part: bytes) -> bytes:
    """A part of the board's map: its first byte, how many there are in all, and their CRC-16."""
    return struct.pack(protocol.PUT_MAP_FORMAT, counter, first, size, check) + part


def greet(counter: int, names: bool, nonce: bytes = b"") -> bytes:
    """names: also send HELLO and NAMES. nonce: 8 random bytes that the answer's tag covers."""
    return struct.pack(protocol.GREET_FORMAT, counter, names, nonce)


def hello_tag(key: bytes, nonce: bytes, payload: bytes) -> bytes:
    """The tag that a HELLO with this payload has if it answers a GREET with this nonce."""
    before, behind = _HELLO_WITHOUT_TAG, struct.calcsize(protocol.HELLO_FORMAT)
    return auth.Signer(key).digest(nonce, bytes((protocol.VERSION, protocol.HELLO)), payload[:before], payload[behind:])[: auth.TAG]
