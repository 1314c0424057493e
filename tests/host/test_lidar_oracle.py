"""The lidar parser against an independent one: lds2d's decoder of the same protocol, over random frames."""

import random

import pytest

from lidar import Lidar

threeirobotix = pytest.importorskip("lds2d.drivers.threeirobotix_delta_2a")


class Config:
    lidar_baud = 230400
    lidar_rxbuf = 2048
    lidar_frames = 16
    lidar_offset = 0
    lidar_mirrored = False
    lidar_speed20 = 120


class Uart:
    def __init__(self, data):
        self.data = data

    def any(self):
        return len(self.data)

    def readinto(self, buffer):
        count = min(len(buffer), len(self.data))
        buffer[:count] = self.data[:count]
        self.data = self.data[count:]
        return count


def random_frame(rng):
    count = rng.randint(1, 61)
    size = 5 + 3 * count
    data = bytearray([0xAA, 0, 8 + size, 1, 0x61, 0xAD, 0, size, rng.randint(80, 200)])
    data += rng.randint(-500, 500).to_bytes(2, "big", signed=True)
    data += rng.randrange(36000).to_bytes(2, "big")
    for _ in range(count):
        lost = rng.random() < 0.2
        data += bytes([0 if lost else rng.randint(1, 255)])
        data += (0 if lost else rng.randint(400, 32000)).to_bytes(2, "big")
    return bytes(data + (sum(data) & 0xFFFF).to_bytes(2, "big"))


def ours(data):
    lidar = Lidar(Uart(data), None, Config)
    frames = []
    while lidar.poll(0):
        n = lidar.n
        frames.append((lidar.speed20 / 20, list(zip(lidar.bearings[:n], lidar.distances[:n]))))
    return frames


@pytest.mark.parametrize("seed", range(20))
def test_same_frames_as_lds2d(seed):
    rng = random.Random(seed)
    data = b"".join(random_frame(rng) for _ in range(25))
    expected = list(threeirobotix.decode_delta(bytearray(data)))
    found = ours(data)
    assert len(found) == len(expected) == 25
    for (speed, points), (their_speed, their_points) in zip(found, expected):
        assert speed == pytest.approx(their_speed)
        assert len(points) == len(their_points)
        for (bearing, distance), point in zip(points, their_points):
            apart = (bearing / 10 - point.angle_deg + 180) % 360 - 180
            assert abs(apart) <= 0.0501
            assert abs(distance / 4 - point.dist_mm) <= 0.5
