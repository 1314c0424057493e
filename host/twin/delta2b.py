"""The Delta-2B lidar: a spinning head that measures, and sends frames of bytes.

Frame format: see `frame` and `fault`; all fields big-endian. Source: vendor protocol manuals of the Delta family.
"""

import numpy as np

NOISE = 4.0  # mm, 1 sigma
DROPOUT = 0.005
SLOWEST, FASTEST = 5.0, 10.0  # r/s; outside, speed faults are sent instead of points
FAULT_PERIOD_US = 50_000
SPIN_LAG_US = 350_000.0
DELAY_US = 300  # from the last point of a frame to its first byte on the wire
MOST_POINTS = 61
POINTS = 38  # a frame at the target speed


class Delta2B:
    """The lidar.

    mount: `vehicle.Lidar`. world: World. random: Generator. version: 1 = 16-bit sum as check, 0 = CRC-16.

    unplugged: for an Observer to set: it turns and measures, but nothing arrives.
    due: time (us) at which the next frame, of either kind, has been measured.
    """

    def __init__(self, mount, world, random, version=1):
        self.mount = mount
        self._world = world
        self._random = random
        self._version = version
        self._rate = mount.speed * mount.frames * POINTS
        self._gain = 1 + random.normal(0, 0.02)
        self.unplugged = False
        self.sector = 0
        self._since = 0.0
        self._target = 0.0 if mount.motor is not None else mount.speed  # then it turns by itself
        self._fastest = np.inf
        self.speed = 0.0
        self.began = 0.0
        self._begin(0.0)

    def spin(self, time, duty):
        """The motor's duty (0..1) changes at the time, us."""
        self._settle(time)
        self._target = min(max(duty - 0.1, 0.0) * 12.6 * self._gain, self._fastest)

    def limit(self, time, fastest):
        """From the time on, us, the motor turns no faster, r/s, whatever it is told."""
        self._settle(time)
        self._fastest = fastest
        self._target = min(self._target, fastest)

    def take(self, poses_at):
        """Bytes of the frame that is due; begins the next one.

        poses_at(times) -> x, y, headings: where the body was, see `Body.poses_at`.
        """
        time = self.due
        data = self._points(time, poses_at) if self._measuring else fault(self.speed, self._version)
        self._settle(time)
        self._begin(time)
        return data

    def _begin(self, time):
        """Begin a frame: its length is that of the speed at its beginning."""
        self.began = time
        self._measuring = SLOWEST <= self.speed <= FASTEST
        period = 1e6 / self.mount.frames / self.speed if self._measuring else FAULT_PERIOD_US
        self.due = time + period

    def _settle(self, time):
        """Follow the motor to the time."""
        self.speed = self._target + (self.speed - self._target) * np.exp((self._since - time) / SPIN_LAG_US)
        self._since = time

    def _points(self, time, poses_at):
        mount, random = self.mount, self._random
        period = time - self.began
        n = min(round(self._rate * period / 1e6), MOST_POINTS)
        start = self.sector / mount.frames
        self.sector = (self.sector + 1) % mount.frames
        share = np.arange(n) / n
        x, y, heading = poses_at(self.began + share * period)
        turn = 2 * np.pi * (start + share / mount.frames)
        if mount.mirrored:
            turn = -turn
        if mount.x or mount.y:
            s, c = np.sin(heading), np.cos(heading)
            x, y = x + mount.x * c + mount.y * s, y + mount.y * c - mount.x * s
        ranges = self._world.ranges(x, y, heading + turn + np.radians(mount.offset / 10))
        ranges += random.normal(0, NOISE, n)
        lost = (ranges < mount.near) | (ranges > mount.far) | (random.random(n) < DROPOUT)
        counts = np.where(lost, 0, np.rint(ranges * 4)).astype(np.uint16)
        signals = np.where(lost, 0, np.clip(160 - ranges / 60, 12, 160)).astype(np.uint8)
        return frame(self.speed, round(start * 36000), signals, counts, self._version)


def frame(speed, start, signals, counts, version=1):
    """A measurement frame.

    speed: r/s. start: angle of the first point, 0.01 deg. signals: (n,) 0..255. counts: (n,) distances in quarter mm.
    """
    n = len(counts)
    data = bytearray(15 + 3 * n)
    data[:13] = (0xAA, 0, 13 + 3 * n, version, 0x61, 0xAD, 0, 5 + 3 * n, min(round(speed * 20), 255), 0, 0, start >> 8, start & 0xFF)
    points = np.frombuffer(data, np.uint8)[13:-2].reshape(n, 3)
    points[:, 0] = signals
    points[:, 1] = counts >> 8
    points[:, 2] = counts & 0xFF
    data[-2:] = check(data[:-2], version).to_bytes(2, "big")
    return bytes(data)


def fault(speed, version=1):
    """A speed-fault frame, sent instead of points. speed: r/s."""
    data = bytes((0xAA, 0, 9, version, 0x61, 0xAE, 0, 1, min(round(speed * 20), 255)))
    return data + check(data, version).to_bytes(2, "big")


def check(data, version):
    """Check over the bytes before it: the sum, or CRC-16 (Modbus) when the version is 0."""
    if version:
        return sum(data) & 0xFFFF
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc
