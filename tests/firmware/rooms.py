"""Rooms with four walls as the lidar at the body's centre sees them: Delta-2B frames computed beforehand, and points for the memory."""

from array import array
from math import cos, pi, sin

FRAMES = 16
POINTS = 38
FRAME_SIZE = 8 + 5 + 3 * POINTS + 2
FRAME_US = 9470  # at 6.6 r/s


def distance(bearing, left, right, front, rear):
    """mm to the nearest wall of the room x = -left .. right, y = -rear .. front; bearing in 0.1 deg."""
    x = sin(bearing * pi / 1800)
    y = cos(bearing * pi / 1800)
    across = (right / x if x > 0 else -left / x) if x else 1e9
    along = (front / y if y > 0 else -rear / y) if y else 1e9
    return min(across, along)


def revolution(left, right, front, rear):
    """The bytes of one turn in such a room; what is nearer than 200 mm or farther than 8 m gives no return."""
    data = bytearray(FRAMES * FRAME_SIZE)
    at = 0
    for frame in range(FRAMES):
        start = frame * 2250  # 0.01 deg
        parameters = 5 + 3 * POINTS
        head = (0xAA, 0, 8 + parameters, 1, 0x61, 0xAD, 0, parameters, 132, 0, 0, start >> 8, start & 255)
        for k, value in enumerate(head):
            data[at + k] = value
        i = at + len(head)
        for k in range(POINTS):
            mm = distance((start + 2250 * k / POINTS) / 10, left, right, front, rear)
            quarters = int(mm * 4) if 200 <= mm <= 8000 else 0
            data[i] = 40
            data[i + 1] = quarters >> 8
            data[i + 2] = quarters & 255
            i += 3
        check = sum(data[at:i]) & 0xFFFF
        data[i] = check >> 8
        data[i + 1] = check & 255
        at += FRAME_SIZE
    return data


class Uart:
    """Gives one frame each time it is asked, round and round; allocates nothing. `data` may be exchanged at any time."""

    def __init__(self, data):
        self.data = data
        self._at = 0

    def any(self):
        return 0

    def readinto(self, buffer):
        i = 0
        at = self._at
        data = self.data
        if at & 1:  # the second call of a pair finds nothing
            self._at = (at + 1) % (2 * FRAMES)
            return None
        start = (at >> 1) * FRAME_SIZE
        while i < FRAME_SIZE:
            buffer[i] = data[start + i]
            i += 1
        self._at = at + 1
        return FRAME_SIZE


class Sight:
    """What the parts behind the lidar read of it: one frame at a time."""

    frame_us = 0
    period_us = FRAME_US
    lone = lone_range = returned = 0
    intruder = False

    def __init__(self):
        self.n = POINTS
        self.bearings = array("H", [0] * POINTS)
        self.distances = array("H", [0] * POINTS)

    def look(self, frame, of):
        """of(bearing in 0.1 deg) -> mm, 0 for none."""
        self.frame_us = (self.frame_us + FRAME_US) & 0x3FFFFFFF
        for k in range(POINTS):
            self.bearings[k] = int(frame * 225 + 225 * k / POINTS)
            self.distances[k] = int(of(self.bearings[k]) * 4)


class Still:
    """An odometry that stands where one puts it."""

    def __init__(self):
        self.x = self.y = self.heading = self.travel256 = self.travel = 0
        self.step_x = self.step_y = self.step_heading = 0
        self.now_us = 0
