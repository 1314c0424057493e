"""What the constructors of lidar, scan trust, map and windows do. Needed once, at the start: then its memory is the robot's."""

from array import array

from micropython import const

from core.trig import sin14

_MAX_POINTS = const(80)  # lidar.py
_STORE = const(416)
_CHUNK = const(160)
_TURN = const(471859200)
_CAPACITY = const(320)  # local_map.py
_HASH = const(512)
_MOST_GONE = const(16)
_KEPT = const(240)
_LONES = const(24)
_ROW = const(7)  # scan_trust.py
_BEARINGS = const(113)
_BINS = const(4)  # scan_trust.py
_CLEAR = const(60)  # mm from the outline: the border of what is unknown comes no nearer, or there would be no way out


def lidar(self, uart, motor_pwm, config):
    """Fields of a Lidar."""
    self.uart = uart
    self._motor = motor_pwm
    self.n = self.place = self.frame_us = self.speed20 = self.frames = self.speed_faults = self.overflows = self._motor_sum = 0
    self.lone = self.lone_range = self.returned = 0  # of scan_trust.py
    self.intruder = False
    self.ok = False
    self.bearings = array("H", bytes(2 * _MAX_POINTS))
    self.distances = array("H", bytes(2 * _MAX_POINTS))
    self._store = bytearray(_STORE)
    self._chunk = bytearray(_CHUNK)
    frames = config.lidar_frames
    # The places from _FRAMES on, as lidar.py lists them; what comes before is 0 at first.
    self._state = array(
        "i",
        [0] * 23
        + [
            frames, 36000 // frames, _TURN // frames, (config.lidar_offset % 3600) << 17, 1 if config.lidar_mirrored else 0,
            config.lidar_speed20, config.lidar_rxbuf, 10_000_000_000 // config.lidar_baud, 20_000_000 // frames, 0,
        ],
    )  # fmt: skip


def scan_trust(self, config):
    """Fields of a ScanTrust."""
    size = _ROW * config.lidar_frames
    turn = _BINS * config.lidar_frames
    self._own = outline(config)
    self._rows = array("H", bytes(2 * (size + 2 * turn)))
    half = config.robot_length // 2 + _CLEAR
    # Both in the order of the places in scan_trust.py
    self._found = array("i", (4 * config.lidar_near, 4 * config.lidar_far, 0, 0, 0))
    self._state = array(
        "i",
        (config.lidar_returns, size, -turn if config.lidar_mirrored else turn, config.lidar_x, config.lidar_y)
        + (max(half - config.lidar_y, 0), max(half + config.lidar_y, 0), config.lidar_frames)
        + (0, 0, 0, 0, 0, 0, size)
        + (0,) * 18,
    )


def outline(config):
    """For each 3.2 degrees of bearings how far the robot's own outline reaches, 8 mm: what is met nearer is the robot itself."""
    own = bytearray(_BEARINGS)
    half = config.robot_width // 2, config.robot_length // 2
    for k in range(_BEARINGS):
        least = 254
        for b in (32 * k, 32 * k + 31):
            s = sin14(b)
            c = sin14(b + 900)
            for way, at, room in ((s, config.lidar_x, half[0]), (c, config.lidar_y, half[1])):
                room -= at if way > 0 else -at
                if way:
                    least = min(least, max(room << 11, 0) // abs(way))
        own[k] = least
    out = config.lidar_left_out
    for k in range(0, len(out), 2):
        for b in range(out[k] * 10, out[k + 1] * 10 + 1, 16):
            own[b % 3600 >> 5] = 255
    return own


def local_map(self, config):
    """Fields of a LocalMap."""
    length = config.robot_length
    far8 = min(length * 14, 30000)  # 1.75 body lengths to each side
    self.keep = 6 * length  # lining up at a corner takes many short moves
    self.x = array("H", bytes(2 * _CAPACITY))
    self.y = array("H", bytes(2 * _CAPACITY))
    self._seen = bytearray(_CAPACITY)
    self._travel = bytearray(_CAPACITY)
    self._gone = array("H", bytes(2 * _MOST_GONE))
    self._index = array("H", b"\xff\xff" * _HASH)
    self._lidar_x = config.lidar_x
    self._lidar_y = config.lidar_y
    self._frames = config.lidar_frames
    self._frame_us = self._period_us = self._due = self.doubt = self._next_lone = 0
    self._lane = config.robot_width // 2 + 20
    self._ahead = config.robot_length * 3 // 4
    self._lones = array("H", bytes(2 * _LONES))
    self._one = array("H", (0,)), array("H", (0,))  # a frame of one beam
    unit = 0
    while self.keep >> unit > _KEPT:
        unit += 1
    # In the order of the places in local_map.py
    reach = min(far8 * 7 // 10, 4 * config.lidar_far, 32000)
    cells = length * 8 // 30, reach, 4 * config.lidar_near, length * 8
    self.state = array("i", (0, 0, 0, far8) + cells + (self.keep >> unit, unit) + (0,) * 6 + ((config.lidar_near + 40) ** 2,))
    self._open = not config.lidar_returns


def windows(self, config, capacity, band_mm):
    """Fields of a Windows. band_mm: BAND_MM there."""
    self.window = bytearray(capacity)
    self.near = self.urgent = 0
    # In the order of the places in windows.py
    sizes = config.robot_width // 2, config.robot_length // 2, 0, 0, 0, config.windows_look_ahead, config.avoid_soft_margin + band_mm
    self._size = array("i", sizes + (0,) * 3)
