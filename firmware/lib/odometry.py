"""Dead reckoning: where the body is, from what the wheels are doing.

The robot has no other sense of its own motion. The estimate is good enough to
carry lidar points along for a body length or two, which is all the planner asks
of it; it drifts by the few per cent the wheels slip.
"""

from time import ticks_diff, ticks_add

from trig import sin14, cos14


class Odometry:
    """Pose of the body centre in a frame fixed at boot.

    x right and y forward at boot in 1/256 mm, heading clockwise in 0.001 degree
    (0..359999). `travel` counts the millimetres rolled by the fastest wheel, in
    either direction: it is the age of a remembered point (drift grows with
    travel, not with time).
    """

    def __init__(self, config):
        self.full_speed = config.motors_full_speed  # mm/s at V = 180
        self.x = 0
        self.y = 0
        self.heading = 0
        self.travel256 = 0
        self.step_x = 0  # the last step in the body frame, 1/256 mm
        self.step_y = 0
        self.step_heading = 0  # 0.001 degree
        self.step_us = 1
        self._last = -1

    @property
    def travel(self):
        return self.travel256 >> 8

    def advance(self, now_us, drive):
        """Add the motion since the last call; drive gives the twist (spec section 3)."""
        if self._last < 0:
            self._last = now_us
            return
        # Steps of 64 us keep speed * time inside a small integer.
        ticks = ticks_diff(now_us, self._last) >> 6
        if ticks <= 0:
            return
        self._last = ticks_add(self._last, ticks << 6)
        if ticks > 1000:  # a pause of more than 64 ms is not motion, it is a fault
            ticks = 1000
        steering = drive.steering
        speed = drive.v256 * self.full_speed // 90  # fastest wheel, 1/256 mm/s
        dist = (speed * ticks + 7812) // 15625  # 1/256 mm
        dx = (dist * steering.vx) >> 14
        dy = (dist * steering.vy) >> 14
        # w is 2**14 * S/2 * rad/mm; 1790/65536 = 2 * (180/pi) * 1000 / (256 * 2**14)
        turn = ((dist * steering.w // steering.span) * 1790) >> 16
        middle = (self.heading + (turn >> 1)) // 100
        s = sin14(middle)
        c = cos14(middle)
        self.x += (dx * c + dy * s) >> 14
        self.y += (dy * c - dx * s) >> 14
        heading = self.heading + turn
        if heading < 0:
            heading += 360000
        elif heading >= 360000:
            heading -= 360000
        self.heading = heading
        self.step_x = dx
        self.step_y = dy
        self.step_heading = turn
        self.step_us = ticks << 6
        self.travel256 = (self.travel256 + (dist if dist >= 0 else -dist)) & 0x3FFFFFF
