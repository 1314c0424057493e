"""What the robot tells of itself, message by message. Reads the parts of the robot, changes none; allocates nothing except for PARAMETER."""

import json
import struct
from struct import calcsize

from link import telemetry
from link.telemetry import HEADER, TIME_MASK, copy


def parameters(config):
    """How many PARAMETERs there are: the live ones and the trims."""
    return len(config.live) + 2 * config.axles


class Messages:
    """Composes messages in `encoder`; each method returns the size of the frame."""

    def __init__(self, encoder, identity, names):
        """identity: dict of the HELLO's JSON; names: the NAMES' JSON, bytes."""
        self._encoder = encoder
        self._identity = json.dumps(identity).encode()
        self._names = names
        if len(self._identity) + calcsize(telemetry.HELLO_FORMAT) > encoder.room or len(self._names) > encoder.room:
            raise ValueError("HELLO or NAMES does not fit a frame of %d bytes: shorten the robot's name or the texts of reasons.py" % encoder.room)

    def hello(self, session, counter):
        data = self._encoder.data
        struct.pack_into(telemetry.HELLO_FORMAT, data, HEADER, session, counter)
        return self._text(telemetry.HELLO, calcsize(telemetry.HELLO_FORMAT), self._identity)

    def names(self):
        return self._text(telemetry.NAMES, 0, self._names)

    def reply(self, counter, kind, status, text):
        """As in Commands.reply."""
        struct.pack_into(telemetry.REPLY_FORMAT, self._encoder.data, HEADER, counter, kind, status)
        return self._text(telemetry.REPLY, calcsize(telemetry.REPLY_FORMAT), text)

    def log(self, level, text):
        """text: bytes, UTF-8; what does not fit is cut off."""
        self._encoder.data[HEADER] = level
        return self._text(telemetry.LOG, 1, text)

    def decision(self, avoid, state, now_us, took_us):
        """took_us: computing time that went into the decision."""
        struct.pack_into(
            telemetry.DECISION_FORMAT, self._encoder.data, HEADER, avoid.decisions, now_us & TIME_MASK, state, avoid.mode, avoid.af, avoid.ar,
            avoid.v, avoid.window, avoid.zone, avoid.free, avoid.block_x, avoid.block_y, avoid.why, took_us,
        )  # fmt: skip
        return self._encoder.seal(telemetry.DECISION, calcsize(telemetry.DECISION_FORMAT))

    def wheels(self, drive, now_us):
        data = self._encoder.data
        steering = drive.steering
        count = 2 * steering.n
        struct.pack_into(telemetry.WHEELS_FORMAT, data, HEADER, now_us & TIME_MASK, drive.af, drive.ar, drive.v256, steering.folded, count)
        at = HEADER + calcsize(telemetry.WHEELS_FORMAT)
        copy(steering.angles, 0, 2 * count, data, at)
        copy(steering.shares, 0, 2 * count, data, at + 2 * count)
        return self._encoder.seal(telemetry.WHEELS, calcsize(telemetry.WHEELS_FORMAT) + 4 * count)

    def points(self, avoid, now_us):
        data = self._encoder.data
        count = min(avoid.points_count, (telemetry.MAX_PAYLOAD - calcsize(telemetry.POINTS_FORMAT)) // 5)
        struct.pack_into(telemetry.POINTS_FORMAT, data, HEADER, now_us & TIME_MASK, count)
        at = HEADER + calcsize(telemetry.POINTS_FORMAT)
        copy(avoid.points_x, 0, 2 * count, data, at)
        copy(avoid.points_y, 0, 2 * count, data, at + 2 * count)
        copy(avoid.points_window, 0, count, data, at + 4 * count)
        return self._encoder.seal(telemetry.POINTS, calcsize(telemetry.POINTS_FORMAT) + 5 * count)

    def pose(self, odometry, now_us):
        struct.pack_into(telemetry.POSE_FORMAT, self._encoder.data, HEADER, now_us & TIME_MASK, odometry.x, odometry.y, odometry.heading)
        return self._encoder.seal(telemetry.POSE, calcsize(telemetry.POSE_FORMAT))

    def candidates(self, avoid, variant, now_us):
        """What the latest decision found of all steerings of one variant (bit 0 left, bit 1 backward)."""
        data = self._encoder.data
        candidates = avoid.candidates
        count = min(candidates.count, (telemetry.MAX_PAYLOAD - calcsize(telemetry.CANDIDATES_FORMAT)) // 6)
        af, ar = avoid.af, avoid.ar
        if variant & 1:
            af, ar = -af, -ar
        if variant & 2:
            af, ar = -ar, -af
        chosen = 255
        for k in range(count):
            if candidates.af[k] == af and candidates.ar[k] == ar:
                chosen = k
        struct.pack_into(telemetry.CANDIDATES_FORMAT, data, HEADER, now_us & TIME_MASK, variant, chosen, count)
        at = HEADER + calcsize(telemetry.CANDIDATES_FORMAT)
        copy(candidates.af, 0, 2 * count, data, at)
        copy(candidates.ar, 0, 2 * count, data, at + 2 * count)
        copy(avoid.free_of[variant], 0, 2 * count, data, at + 4 * count)
        return self._encoder.seal(telemetry.CANDIDATES, calcsize(telemetry.CANDIDATES_FORMAT) + 6 * count)

    def health(self, health, lidar, dropped, refused, radio):
        flags = lidar.ok | health.chips << 1 | radio << 2
        struct.pack_into(
            telemetry.HEALTH_FORMAT, self._encoder.data, HEADER, health.uptime_ms, health.heap_free, health.worst_us, health.battery_mv,
            lidar.speed20, flags, health.fault, lidar.frames, lidar.errors, lidar.speed_faults, dropped, refused,
        )  # fmt: skip
        return self._encoder.seal(telemetry.HEALTH, calcsize(telemetry.HEALTH_FORMAT))

    def parameter(self, config, number):
        """PARAMETER for row `number` of config.live, or for a servo's trim behind these. Allocates."""
        live = len(config.live)
        if number < live:
            name = config.live[number]
            key = name.replace("_", ".", 1)
            low, high = config.limits[2 * number], config.limits[2 * number + 1]
            value = getattr(config, name)
        else:
            wheel = number - live
            key, low, high = "servos.trims.%d" % wheel, -20, 20
            value = config.servos_trims[wheel] / 10
        row = {"key": key, "value": value, "low": low, "high": high, "number": number, "of": parameters(config)}
        return self._text(telemetry.PARAMETER, 0, json.dumps(row).encode())

    def _text(self, kind, before, text):
        count = min(len(text), self._encoder.room - before)
        copy(text, 0, count, self._encoder.data, HEADER + before)
        return self._encoder.seal(kind, before + count)


class ScanGatherer:
    """Gathers lidar frames into one SCAN message: a whole turn, or as much of it as fits a frame."""

    def __init__(self, frames_a_turn):
        self._turn = frames_a_turn
        self._data = bytearray(telemetry.MAX_PAYLOAD)
        self._used = 0
        self._frames = 0
        self.ready = False

    def add(self, lidar):
        """Take in the frame the lidar has just delivered; what was ready and not taken gives way."""
        count = lidar.n
        size = calcsize(telemetry.SCAN_FORMAT) + 2 * count
        data = self._data
        if self.ready:
            self._used = self._frames = 0
            self.ready = False
        if not count or self._used + size > telemetry.MAX_PAYLOAD:
            return
        at = self._used
        struct.pack_into(telemetry.SCAN_FORMAT, data, at, lidar.frame_us & TIME_MASK, lidar.bearings[0], lidar.bearings[count - 1], count)
        copy(lidar.distances, 0, 2 * count, data, at + calcsize(telemetry.SCAN_FORMAT))
        self._used = at + size
        self._frames += 1
        # The next frame will be about as long as this one.
        self.ready = self._frames == self._turn or self._used + size > telemetry.MAX_PAYLOAD

    def take(self, encoder):
        """Put what is ready into a SCAN frame; returns its size."""
        self.ready = False
        size = self._used
        copy(self._data, 0, size, encoder.data, HEADER)
        self._used = self._frames = 0
        return encoder.seal(telemetry.SCAN, size)
