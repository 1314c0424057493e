"""Dead reckoning: where the body is, from what the wheels are doing.

The robot has no other sense of its own motion. The estimate is good enough to
carry lidar points along for a body length or two, which is all the planner asks
of it; it drifts by the few per cent the wheels slip.
"""

from time import ticks_add, ticks_diff

from micropython import const

from core.trig import cos14, sin14

_WORLD = const(0x10000000)  # x and y lie within it, 1048 m: a multiple of the 2**21 of the map's coordinates, so that these go on evenly
_STEP_US = const(10_000)
_PAUSE_US = const(200_000)


class Odometry:
    """Pose of the body centre in a frame fixed at boot.

    x right and y forward at boot in 1/256 mm, modulo 2**29 (-2**28 .. 2**28 - 1: after a kilometre the sign changes), heading clockwise in
    0.001 degree (0..359999). `travel256` counts 1/256 mm rolled by the fastest wheel, in either direction, modulo 2**26: it is the
    age of a remembered point (drift grows with travel, not with time).
    """

    def __init__(self, config):
        self.full_speed = config.motors_full_speed  # mm/s at V = 180
        self.x = 0
        self.y = 0
        self.heading = 0
        self.travel256 = 0
        self.step_x = 0  # the last 10 ms in the body frame, 1/256 mm
        self.step_y = 0
        self.step_heading = 0  # 0.001 degree
        self.now_us = -1  # time of the estimate

    def advance(self, now_us, drive):
        """Add the motion up to about now; drive gives the twist (spec section 3).

        Goes on in steps of 10 ms: shorter ones would be lost in rounding, longer ones would cut corners.
        """
        if self.now_us < 0:
            self.now_us = now_us
            return
        late = ticks_diff(now_us, self.now_us)
        if not -_PAUSE_US <= late <= _PAUSE_US:  # a pause this long is a fault, not motion; after one of minutes the difference is negative
            self.now_us = ticks_add(now_us, -_PAUSE_US)
            late = _PAUSE_US
        while late >= _STEP_US:
            self._step(drive)
            late -= _STEP_US

    def _step(self, drive):
        self.now_us = ticks_add(self.now_us, _STEP_US)
        steering = drive.steering
        # 1/256 mm of the fastest wheel in 10 ms; every division rounds to the nearest, or the pose would creep
        dist = (drive.v256 * self.full_speed + 4500) // 9000
        dx = (dist * steering.vx + 8192) >> 14
        dy = (dist * steering.vy + 8192) >> 14
        # w is 2**14 * S/2 * rad/mm; 895 / 2**15 = 2 * (180/pi) * 1000 / (256 * 2**14)
        span = steering.span
        turn = ((dist * steering.w + (span >> 1)) // span * 895 + 16384) >> 15
        middle = (self.heading + (turn >> 1) + 50) // 100
        s = sin14(middle)
        c = cos14(middle)
        self.x = ((self.x + ((dx * c + dy * s + 8192) >> 14) + _WORLD) & (2 * _WORLD - 1)) - _WORLD
        self.y = ((self.y + ((dy * c - dx * s + 8192) >> 14) + _WORLD) & (2 * _WORLD - 1)) - _WORLD
        heading = self.heading + turn
        if heading < 0:
            heading += 360000
        elif heading >= 360000:
            heading -= 360000
        self.heading = heading
        self.step_x = dx
        self.step_y = dy
        self.step_heading = turn
        self.travel256 = (self.travel256 + (dist if dist >= 0 else -dist)) & 0x3FFFFFF
