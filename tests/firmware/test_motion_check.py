"""perception/scan_trust.py, the motion: a robot in a room, whose wheels do as they are told, and which moves so or otherwise."""

from array import array
from math import cos, pi, sin

from perception.scan_trust import ScanTrust

FRAMES = 16
BEAMS = 38
PERIOD_S = 0.00947
SCAN, NOTHING, WRONG_WAY, HALF = 12, 13, 14, 15
ROOM = -900.0, 1000.0, -1200.0, 1500.0  # left, right, behind, ahead


class Config:
    lidar_returns = 20
    robot_width = 250
    lidar_left_out = ()
    lidar_near = 200
    lidar_far = 8000
    lidar_frames = FRAMES
    robot_length = 600
    lidar_x = 0
    lidar_y = 0
    lidar_mirrored = False


class Odometry:
    x = y = heading = travel256 = 0


class Lidar:
    def __init__(self):
        self.place = FRAMES - 1
        self.n = BEAMS
        self.missed = 0
        self.frame_us = 0
        self.period_us = int(PERIOD_S * 1e6)
        self.bearings = array("H", bytes(160))
        self.distances = array("H", bytes(160))


def range_to(walls, x, y, angle):
    """mm to the walls of a rectangle from inside; far away where there is none (None)."""
    left, right, behind, ahead = walls
    s = sin(angle)
    c = cos(angle)
    nearest = 16000.0
    for wall, way, speed in ((right, x, s), (left, x, s), (ahead, y, c), (behind, y, c)):
        if wall is not None and abs(speed) > 1e-6 and (wall - way) / speed > 0:
            nearest = min(nearest, (wall - way) / speed)
    return nearest


class Drive:
    """speed, turn: mm/s forward and deg/s clockwise that the wheels are told; share, turned: how much of them becomes motion."""

    def __init__(self, speed=200.0, turn=0.0, walls=ROOM, **changes):
        self.config = config = Config()
        for name in changes:
            setattr(config, name, changes[name])
        self.check = ScanTrust(config)
        self.lidar = Lidar()
        self.odometry = Odometry()
        self.told = self.true = 0.0, 0.0, 0.0  # x, y, heading in radians
        self.speed = speed
        self.turn = turn * pi / 180
        self.walls = walls
        self.random = 1
        self.share = self.turned = 1.0
        self.people = 0  # places whose ranges are anything

    def waver(self, most):
        self.random = (self.random * 75 + 74) % 65537
        return self.random % (2 * most + 1) - most

    def frame(self, heard=True):
        x, y, heading = self.told
        self.told = self._moved(self.told, 1.0, 1.0)
        self.true = self._moved(self.true, self.share, self.turned)
        odometry = self.odometry
        x, y, heading = self.told
        odometry.x = int(x * 256)
        odometry.y = int(y * 256)
        odometry.heading = int(heading * 180000 / pi) % 360000
        lidar = self.lidar
        lidar.frame_us += lidar.period_us
        lidar.place = place = (lidar.place + 1) % FRAMES
        x, y, heading = self.true
        config = self.config
        x += config.lidar_x * cos(heading) + config.lidar_y * sin(heading)
        y += config.lidar_y * cos(heading) - config.lidar_x * sin(heading)
        for i in range(BEAMS):
            turn = (place * BEAMS + i) / (FRAMES * BEAMS)
            if config.lidar_mirrored:
                turn = -turn
            lidar.bearings[i] = int(turn * 3600) % 3600
            far = range_to(self.walls, x, y, heading + 2 * pi * turn) if place >= self.people else 700 + self.waver(150)
            lidar.distances[i] = min(int(4 * far) + self.waver(16), 65535)
        v256 = 256 if self.speed > 0 else -256 if self.speed < 0 or self.turn else 0
        lidar.missed += not heard
        if heard:
            self.check.frame(lidar, odometry, v256)

    def _moved(self, pose, share, turned):
        x, y, heading = pose
        way = self.speed * share * PERIOD_S
        return x + way * sin(heading), y + way * cos(heading), heading + self.turn * turned * PERIOD_S

    def go(self, seconds):
        """Seconds until there was a fault, None if there was none."""
        while self.check.fault == SCAN:  # until it is trusted
            self.frame()
        frames = int(seconds / PERIOD_S)
        for i in range(frames):
            self.frame()
            if self.check.fault:
                return i * PERIOD_S
        return None


def failing(share, turned=None, seconds=2.0, **settings):
    """After a second in which all is well: (the fault, after how many seconds)."""
    drive = Drive(**settings)
    assert drive.go(1.0) is None
    drive.share = share
    drive.turned = share if turned is None else turned
    after = drive.go(seconds)
    return drive.check.fault, after


def test_all_is_well():
    for speed, turn in ((200.0, 0.0), (-200.0, 0.0), (400.0, 0.0), (85.0, 0.0), (200.0, 40.0), (85.0, -60.0), (0.0, 0.0)):
        assert Drive(speed, turn).go(2.5) is None, (speed, turn)


def test_a_body_that_turns_otherwise_than_it_is_steered_is_noticed_though_it_gets_on_well():
    for turn in (25.0, -25.0):
        for turned in (0.6, 1.4):
            fault, after = failing(1.0, turned=turned, turn=turn)
            assert fault in (WRONG_WAY, HALF) and after < 1.2, (turn, turned, fault, after)
        for turned in (0.85, 1.15):
            assert failing(1.0, turned=turned, turn=turn) == (0, None), (turn, turned)


def test_wheels_that_slip_a_little_are_well():
    for share in (0.9, 1.1):
        for turn in (0.0, 40.0):
            assert failing(share, turn=turn) == (0, None), share


def test_nothing_moves():
    for speed, turn in ((200.0, 0.0), (-200.0, 0.0), (85.0, 0.0), (200.0, 40.0), (0.0, 60.0)):
        fault, after = failing(0.0, speed=speed, turn=turn)
        assert fault == NOTHING and after < 1.5, (speed, turn, fault, after)


def test_the_wrong_way():
    for speed, turn in ((200.0, 0.0), (200.0, 40.0)):
        fault, after = failing(-1.0, speed=speed, turn=turn)
        assert fault == WRONG_WAY and after < 1.5, (speed, turn, fault, after)


def test_half_the_speed():
    for speed in (200.0, -200.0, 120.0):
        fault, after = failing(0.5, speed=speed)
        assert fault == HALF and after < 1.5, (speed, fault, after)


def test_lidar_beside_the_middle_and_mirrored():
    for changes in ({"lidar_x": 60, "lidar_y": 200}, {"lidar_mirrored": True}, {"lidar_mirrored": True, "lidar_y": -150}):
        assert Drive(150.0, 50.0, **changes).go(2.5) is None, changes
        fault, after = failing(0.0, speed=150.0, turn=50.0, **changes)
        assert fault == NOTHING, changes


def test_between_parallel_walls_nothing_is_said():
    assert failing(0.0, walls=(-300.0, 350.0, None, None)) == (0, None)
    assert failing(0.5, walls=(-300.0, 350.0, None, None)) == (0, None)


def test_people_about():
    drive = Drive()
    drive.people = 6
    assert drive.go(2.5) is None


def test_standing_says_nothing():
    drive = Drive(0.0)
    drive.people = 10
    assert drive.go(2.5) is None


def blocked(drive):
    """Whether the way ahead is taken for blocked: 60 mm before the body."""
    drive.frame()
    while drive.lidar.place:
        drive.frame()
    return max(drive.lidar.distances[:BEAMS]) == 4 * 360


def test_it_tries_once_and_then_gives_up():
    drive = Drive()
    drive.go(1.0)
    drive.share = 0.0
    assert drive.go(1.5) is not None
    check = drive.check
    assert (check.fault, check.alarm) == (NOTHING, False)
    frames = 0
    while check.fault:
        drive.frame()
        frames += 1
    assert 0.5 < frames * PERIOD_S < 0.7
    assert blocked(drive), "so that it backs out"
    drive.speed = -200.0
    assert drive.go(1.5) is not None
    assert (check.fault, check.alarm) == (NOTHING, True)
    for _ in range(400):
        drive.frame()
    assert check.fault == NOTHING, "until a person comes"
    check.clear()
    assert (check.fault, check.alarm) == (SCAN, False)


def test_backed_out_it_goes_on():
    drive = Drive()
    drive.go(1.0)
    drive.share = 0.0
    drive.go(1.5)
    drive.share = 1.0
    drive.speed = -100.0
    for _ in range(400):
        drive.frame()
    assert drive.check.fault == 0 and not blocked(drive)


def test_after_a_gap_it_begins_anew():
    drive = Drive()
    drive.go(1.0)
    for _ in range(5):
        drive.frame(False)
    drive.true = 200.0, 0.0, 0.5  # carried elsewhere meanwhile
    for _ in range(2 * FRAMES):
        drive.frame()
        assert drive.check.fault in (0, SCAN)
    assert drive.go(1.5) is None
