"""Faults of the lidar: in the bytes that it sends, and in its motor."""

import numpy as np

from ..delta2b import frame
from .base import Fault, named

_POINTS_AT = 13
_MEASUREMENT = 0xAD
_TRUST_MS = 230  # one and a half revolutions
_TWICE_MS = 320  # two, and a frame


def measures(data):
    """True for a frame with points in it."""
    return len(data) > _POINTS_AT and data[5] == _MEASUREMENT


def start_of(data):
    """Angle of a frame's first point, 0.01 deg."""
    return data[11] << 8 | data[12]


def with_points(data, change):
    """The frame with other points. change(signals, counts), both (n,) int arrays, counts in quarter mm, returns two such."""
    if not measures(data):
        return data
    points = np.frombuffer(data, np.uint8)[_POINTS_AT:-2].reshape(-1, 3).astype(int)
    signals, counts = change(points[:, 0], points[:, 1] << 8 | points[:, 2])
    return frame(data[8] / 20, start_of(data), signals, counts, data[3])


class _Lidar(Fault):
    def begin(self, simulation):
        self.mount = simulation.lidar.mount

    def bearings(self, data):
        """Bearing of each point in the body frame, degrees -180..180, clockwise from forward; of a frame that measures."""
        n = (len(data) - _POINTS_AT - 2) // 3
        turn = start_of(data) / 100 + np.arange(n) / n * 360 / self.mount.frames
        return (self.mount.offset / 10 + (-turn if self.mount.mirrored else turn) + 180) % 360 - 180


@named("lidar-silent", "the lidar turns and sends nothing more", within_ms=250, again_s=0)
class Silent(_Lidar):
    def distort(self, time, data):
        return b""


@named("lidar-unplugged", "its plug comes off: the line falls silent within a frame and the motor runs out", within_ms=250, again_s=0)
class Unplugged(_Lidar):
    _cut = False

    def begin(self, simulation):
        simulation.lidar.limit(simulation.now, 0.0)

    def distort(self, time, data):
        if self._cut:
            return b""
        self._cut = True
        return data[: len(data) // 2]


@named("lidar-garbage", "as many bytes as ever, and all of them random", within_ms=250, again_s=0)
class Garbage(_Lidar):
    _random = np.random.default_rng(12)

    def distort(self, time, data):
        return self._random.bytes(len(data))


@named("lidar-slow", "its motor gets slow, 3 r/s: it sends that instead of points", within_ms=600, again_s=0)
class Slow(_Lidar):
    def begin(self, simulation):
        simulation.lidar.limit(simulation.now, 3.0)


@named("lidar-frozen", "one frame again and again", within_ms=_TRUST_MS, again_s=0)
class Frozen(_Lidar):
    _kept = b""

    def distort(self, time, data):
        if not self._kept and measures(data):
            self._kept = data
        return self._kept or data


@named("lidar-stuck", "one revolution again and again", within_ms=1500, again_s=0)
class Stuck(_Lidar):
    def begin(self, simulation):
        super().begin(simulation)
        self._kept = {}

    def distort(self, time, data):
        if not measures(data):
            return data
        if len(self._kept) < self.mount.frames:
            return self._kept.setdefault(start_of(data), data)
        return self._kept.get(start_of(data), data)


@named("lidar-covered", "the cover is on from the start: no beam returns", within_ms=0, again_s=0, from_start=True)
@named("lidar-blind", "no beam returns: all distances 0", within_ms=_TRUST_MS, again_s=0, count=0, signal=0)
@named("lidar-far", "all distances 65535", within_ms=_TRUST_MS, again_s=0, count=65535)
@named("lidar-near", "all distances just below lidar.near", within_ms=_TRUST_MS, again_s=0, count=None)
class Alike(_Lidar):
    def __init__(self, count=0, signal=100, from_start=False):
        self.at_start = from_start
        self._count, self._signal = count, 0 if from_start else signal

    def distort(self, time, data):
        count = round(self.mount.near * 4) - 1 if self._count is None else self._count
        return with_points(data, lambda signals, counts: (signals * 0 + self._signal, counts * 0 + count))


@named("lidar-half", "the front half is never sent", within_ms=_TRUST_MS, again_s=0, half_angle=90)
@named("lidar-front", "the two frames in front are never sent", within_ms=_TRUST_MS, again_s=0, half_angle=22.5)
class Missing(_Lidar):
    def __init__(self, half_angle):
        self._half = half_angle

    def distort(self, time, data):
        if measures(data):
            bearings = np.radians(self.bearings(data))
            middle = np.degrees(np.arctan2(np.sin(bearings).mean(), np.cos(bearings).mean()))
            if abs(middle) < self._half:
                return b""
        return data


@named("lidar-hole", "one frame, ahead to the right, is never sent", within_ms=_TWICE_MS, again_s=0)
@named("lidar-lost", "every 1.1 s a frame does not come through", every_us=1_100_000)
class Lost(_Lidar):
    """every_us: one of whatever direction so often; 0: always the same one."""

    def __init__(self, every_us=0):
        self._every = every_us
        self._next = 0.0
        self._place = None

    def distort(self, time, data):
        if not measures(data):
            return data
        if self._every:
            lost = time >= self._next
            if lost:
                self._next = time + self._every
        else:
            if self._place is None and 0 < self.bearings(data).mean() < 45:
                self._place = start_of(data)
            lost = start_of(data) == self._place
        return b"" if lost else data


@named("lidar-glass", "the front 135 degrees return nothing, as from glass", within_ms=_TWICE_MS, again_s=0)
class Glass(_Lidar):
    def distort(self, time, data):
        if not measures(data):
            return data
        seen = abs(self.bearings(data)) > 67.5
        return with_points(data, lambda signals, counts: (signals * seen, counts * seen))


@named("lidar-dust", "one beam in a hundred ends at something that is not there, 250 to 600 mm off")
class Dust(_Lidar):
    def __init__(self):
        self._random = np.random.default_rng(12)

    def distort(self, time, data):
        def change(signals, counts):
            false = self._random.random(len(counts)) < 0.01
            return np.where(false, 50, signals), np.where(false, self._random.integers(1000, 2400, len(counts)), counts)

        return with_points(data, change)
