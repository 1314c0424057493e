"""Does the scan follow the motion? A robot that is held, slips, or whose motors or servos have failed believes its wheels, and nothing else.

Each place of the lidar's revolution (a frame) is cut into four bins, and the range of each, of three of its beams, is compared with that of a
revolution before.
How it should have changed is told by the odometry (range flow):

    expected = range that lay in that direction, as the body has turned  -  range in this bin before
               - what the lidar came nearer in the bin's direction  +  the surface's slope * what it went across / range

    bin j before  ___.          a wall; the lidar moves on by d: it is nearer by d along the bin's beam, and looks at
                      \\___.     a place farther on, where the wall slopes
    bin j now         o---->

Bins are weighed by the square of what is expected: beside a parallel wall nothing is, and nothing is said. `agree` is the weight of those that
changed as expected, a quarter more or less. People who walk about spoil some bins; a robot that does not move as told spoils nearly all.
The ratio, of the sum of observed * expected to the weight, is 1 where the robot moves as told, 1/2 at half the speed, 0 where nothing moves, and
negative where it goes the wrong way. It is a fault when too few agree and the ratio is low over a second or so; its kind is what the last
revolution shows.

The first time it stands for a moment, and then for some seconds takes the direction it was going for blocked, so that the planner backs out.
The next time soon after, `alarm` says that it is of no use.
"""

from micropython import const

from core.trig import cos14, sin14

_NOTHING = const(13)  # safety/faults.py
_WRONG_WAY = const(14)
_HALF = const(15)

_BINS = const(4)  # of a place
_FARTHEST = const(24000)  # quarter mm
_JUMP = const(200)  # mm: more is another surface
_INFORMED = const(4000)  # mm**2, weight from which on something can be told
_STAND = const(60)  # frames
_BACK = const(360)  # frames since a fault for which the way is taken for blocked
_FORGET = const(2000)  # and after which it may try again

# Layout of the state
_NOW = const(0)  # first of this revolution's bins: 0 or the number of bins; the others are of the one before
_WEIGHT = const(1)  # of the last seconds
_AGREED = const(2)
_RATIO = const(3)  # sum of observed * expected
_NEW = const(3)  # the same three of this revolution are so many places on
_SINCE = const(7)  # frames since a fault, _FORGET: long ago
_TURN = const(8)  # bins of a revolution
_LEVER_X = const(9)  # the lidar in the body, mm
_LEVER_Y = const(10)
_SIGN = const(11)  # of the bearings' growth from bin to bin


class MotionCheck:
    """config: lidar_frames, lidar_x, lidar_y (mm), lidar_mirrored.

    fault   13 nothing moves, 14 it goes or turns the wrong way, 15 it is too slow; else 0
    alarm   True when it has tried to back out: the fault stays until `clear()`
    way     1: take the way ahead for blocked, 2: that behind, 0: neither
    """

    def __init__(self, config):
        from perception.build import motion_check

        motion_check(self, config)
        self.clear()

    def clear(self):
        """A person wants it to drive."""
        self.fault = self.way = 0
        self.alarm = False
        self._state[_SINCE] = _FORGET
        self._forget()

    def _forget(self):
        """All that was seen, for there was a gap."""
        bins = self._bins
        k = len(bins)
        while k:
            k -= 1
            bins[k] = 0
        state = self._state
        k = _SINCE
        while k > _WEIGHT:
            k -= 1
            state[k] = 0

    def frame(self, lidar, odometry, v256, trusted):
        """Once a frame, before anything is put into it. v256: what the motors are told; trusted: False when frames may be missing."""
        state = self._state
        if state[_SINCE] < _FORGET:
            state[_SINCE] += 1
            if not self.alarm and state[_SINCE] >= _STAND:
                self.fault = 0
                if state[_SINCE] >= _BACK:
                    self.way = 0
        if not trusted:
            if self._seen:
                self._seen = False
                self._forget()
            return
        self._seen = True
        if lidar.place == 0:
            self._judge(state, v256)
        self._compare(lidar, odometry, state, self._bins)

    def _judge(self, state, v256):
        """A revolution is over: the weights of those before fade by a quarter."""
        weight = state[_WEIGHT + _NEW]
        ratio = state[_RATIO + _NEW] * 4
        k = _WEIGHT
        while k <= _RATIO:
            state[k] += state[k + _NEW] - (state[k] >> 2)
            state[k + _NEW] = 0
            k += 1
        state[_NOW] = state[_TURN] - state[_NOW]
        whole = state[_WEIGHT]
        if v256 and not self.fault and whole > _INFORMED and state[_AGREED] * 2 < whole and state[_RATIO] * 10 < whole * 7:
            self.fault = _WRONG_WAY if ratio < -weight else _NOTHING if ratio < weight else _HALF
            self.alarm = state[_SINCE] < _FORGET
            self.way = 1 if v256 > 0 else 2
            state[_SINCE] = 0
            self._forget()

    def _compare(self, lidar, odometry, state, bins):
        """The frame's bins with those of a revolution before."""
        turn = state[_TURN]
        n = lidar.n
        at = lidar.place * _BINS
        # Where the lidar is, quarter mm, and its heading, 0.1 deg
        heading = odometry.heading // 100
        s = sin14(heading)
        c = cos14(heading)
        x = ((odometry.x >> 6) + ((state[_LEVER_X] * c + state[_LEVER_Y] * s) >> 12)) & 0xFFFF
        y = ((odometry.y >> 6) + ((state[_LEVER_Y] * c - state[_LEVER_X] * s) >> 12)) & 0xFFFF
        pose = 2 * turn + at
        dx = ((x - bins[pose] & 0xFFFF) ^ 0x8000) - 0x8000
        dy = ((y - bins[pose + 1] & 0xFFFF) ^ 0x8000) - 0x8000
        dx, dy = (dx * c - dy * s) >> 14, (dx * s + dy * c) >> 14
        turned = ((heading + 1 - bins[pose + 2] + 5400) % 3600 - 1800) * state[_SIGN] * turn * 256 // 3600
        known = bins[pose + 2]
        bins[pose] = x
        bins[pose + 1] = y
        bins[pose + 2] = heading + 1
        before = turn - state[_NOW]
        distances = lidar.distances
        j = 0
        while j < _BINS:
            k = (4 * j + 1) * n
            one = distances[k >> 4]
            was = distances[(k + n) >> 4]
            there = distances[(k + 2 * n) >> 4]
            # Not one surface, or as no surface is, or too far off to tell much: 0
            low = min(one, was, there)
            slope = max(one, was, there) - low
            now = (one + was + there) // 12 if 0 < slope << 2 < low < _FARTHEST else 0
            k = at + j
            bins[state[_NOW] + k] = now
            was = bins[before + k]
            k = (k << 8) + turned
            one = bins[before + (k >> 8) % turn]
            slope = bins[before + ((k >> 8) + 1) % turn] - one
            if known and now and was and one and -one < slope * 3 < one:
                there = one + (slope * (k & 255) >> 8)
                bearing = lidar.bearings[(2 * j + 1) * n >> 3]
                s = sin14(bearing)
                c = cos14(bearing)
                across = ((dx * c - dy * s) >> 16) * state[_SIGN] * turn
                expected = there - was - ((dx * s + dy * c) >> 16) + slope * across // (there * 44 // 7)
                if -_JUMP < expected < _JUMP:
                    size = -expected if expected < 0 else expected
                    now -= was
                    state[_WEIGHT + _NEW] += expected * expected
                    state[_RATIO + _NEW] += expected * min(max(now, -2 * size - 20), 2 * size + 20)
                    if -(size >> 2) - 4 <= now - expected <= (size >> 2) + 4:
                        state[_AGREED + _NEW] += expected * expected
            j += 1
