"""Can the scan be trusted? A lidar that answers may still see nothing: its cover is on, it repeats itself, a part of its turn never comes.

The lidar's revolution is a ring of places, one for each frame. Trust is earned: it takes a whole revolution in which

- every place was heard of within 1.5 revolutions: each frame looks after the two places opposite it, which finds every gap there can be,
- enough of the beams came back (lidar.returns): not at 0, not below lidar.near, not at lidar.far or beyond, and not all of a frame alike,
- and not every frame with returns was the same as that of its place a revolution before: real ranges waver.

A place ahead or behind from which nothing returns is unknown, not free: glass, a black surface, dirt. The border of what was seen free there
last is put into the frame as if something stood there: the planner keeps off it as off any wall, until a beam sees farther. How far that is
shrinks by all that the wheels have rolled since, turns included. Near the border the robot is slow (`most`).

With lidar.returns = 0, for open halls, what does not return is taken for free. Glass that is seen through cannot be seen.
"""

import micropython
from micropython import const

_SCAN = const(12)  # safety/faults.py
_SLOW = const(6)  # V - 90
_ANY = const(90)
_LONGEST = const(76)  # in 4096 us: 1.25 revolutions at 4 r/s
_CONE = const(375)  # 0.1 deg to either side of straight ahead or back: there the blind disc hides nothing but the body

_NEAR_BORDER = const(400)  # mm before the border the robot gets slow

# Layout of the rows, one for each place
_HEARD = const(0)  # 4096 us modulo 2**16
_BEAMS = const(1)
_RETURNS = const(2)
_SUM = const(3)  # of the distances, modulo 2**16
_RANGE = const(4)  # when enough returned last: the farthest, mm; 0: never
_ROLLED = const(5)  # what the wheels had rolled then, mm modulo 2**16
_WAY = const(6)  # 1: ahead the border is near, 2: behind, else 0
_ROW = const(7)

# Layout of the state
_NEAR = const(0)  # quarter mm, the first that counts
_FAR = const(1)  # the first that does not
_COUNT = const(2)  # of the frame: how many count,
_TOTAL = const(3)  # their sum,
_LARGEST = const(4)  # and the largest
_LEAST = const(5)  # share of the beams that must come back, %
_ALL = const(6)  # beams in the rows
_SEEN = const(7)  # returns in the rows
_ALIKE = const(8)  # frames in a row as they were a revolution before, * _ROW
_GOOD = const(9)  # frames since trust was lost, up to a revolution, * _ROW
_NEAREST = const(10)  # mm from the lidar that the border keeps: ahead at _NEAREST + 1, behind at + 2
_WAYS = const(13)  # how many places have the border near: ahead at + 1, behind at + 2


@micropython.viper
def _look(distances: ptr16, n: int, state: ptr32):
    """Of the distances (quarter mm) from state[_NEAR] to below state[_FAR]: how many, their sum, the largest; none if they are all equal."""
    near = state[_NEAR]
    far = state[_FAR]
    count = 0
    total = 0
    low = far
    high = 0
    while n:
        n -= 1
        d = distances[n]
        if d >= near and d < far:
            count += 1
            total += d
            if d < low:
                low = d
            if d > high:
                high = d
    if low == high:
        count = 0  # no surface is like that
    state[_COUNT] = count
    state[_TOTAL] = total
    state[_LARGEST] = high


class ScanTrust:
    """config: lidar_returns (%), lidar_near, lidar_far, lidar_y, robot_length (mm), lidar_frames.

    fault   12 while the scan cannot be trusted, else 0
    most    how far V may lie from 90
    """

    def __init__(self, config):
        from perception.build import scan_trust

        scan_trust(self, config)
        self.fault = _SCAN
        self.most = _ANY

    def frame(self, lidar, odometry, v256, blocked=0):
        """Once a frame, before the map gets it. v256: what the motors are told, for its sign. blocked: 1 ahead, 2 behind, 0 neither is taken for so."""
        rows = self._rows
        state = self._state
        size = len(rows)
        n = lidar.n
        at = lidar.place * _ROW
        now = (lidar.frame_us >> 12) & 0xFFFF
        # Half a revolution ago the places opposite were heard of, or one and a half.
        limit = min(size // _ROW * lidar.period_us * 5 >> 14, _LONGEST)
        opposite = at + size // (2 * _ROW) * _ROW
        late = (now - rows[opposite % size]) & 0xFFFF > limit or (now - rows[(opposite + _ROW) % size]) & 0xFFFF > limit
        _look(lidar.distances, n, state)
        returns = state[_COUNT]
        total = state[_TOTAL] & 0xFFFF
        state[_ALL] += n - rows[at + _BEAMS]
        state[_SEEN] += returns - rows[at + _RETURNS]
        if returns:
            state[_ALIKE] = state[_ALIKE] + _ROW if total == rows[at + _SUM] else 0
        rows[at] = now
        rows[at + _BEAMS] = n
        if state[_LEAST] or blocked:
            self._border(lidar, odometry, at, blocked)
        rows[at + _RETURNS] = returns
        rows[at + _SUM] = total
        if late or not n or state[_SEEN] * 100 < state[_LEAST] * state[_ALL] or state[_ALIKE] >= size:
            state[_GOOD] = 0
        elif state[_GOOD] < size:
            state[_GOOD] += _ROW
        self.fault = 0 if state[_GOOD] >= size else _SCAN
        self.most = _SLOW if v256 >= 0 and state[_WAYS + 1] or v256 <= 0 and state[_WAYS + 2] else _ANY

    def _border(self, lidar, odometry, at, blocked):
        """Whether the frame's place is unknown, or in the blocked way; if so, the border of what was seen free there into the frame."""
        rows = self._rows
        state = self._state
        n = lidar.n
        bearing = lidar.bearings[n >> 1]
        way = slow = 0
        if bearing <= _CONE or bearing >= 3600 - _CONE:
            way = 1
        elif -_CONE <= bearing - 1800 <= _CONE:
            way = 2
        if state[_COUNT] << 3 > n:
            rows[at + _RANGE] = state[_LARGEST] >> 2
            rows[at + _ROLLED] = (odometry.travel256 >> 8) & 0xFFFF
            unknown = False
        else:
            unknown = state[_LEAST] and rows[at + _RETURNS] << 3 <= rows[at + _BEAMS]  # the time before was no better
        if way and (unknown or way == blocked):
            # The body turns: what a place looks at now, one beside it may have seen.
            rolled = odometry.travel256 >> 8
            size = len(rows)
            nearest = border = state[_NEAREST + way]
            k = size - _ROW
            while way != blocked and k <= size + _ROW:
                row = (at + k) % size
                seen = rows[row + _RANGE]
                if seen:
                    seen -= (rolled - rows[row + _ROLLED]) & 0xFFFF
                    if seen > border:
                        border = seen
                    elif seen < 0:
                        rows[row + _RANGE] = 0  # used up, however long the way
                k += _ROW
            slow = way if border < nearest + _NEAR_BORDER else 0
            border <<= 2
            distances = lidar.distances
            while n:
                n -= 1
                distances[n] = border
        state[_WAYS + rows[at + _WAY]] -= 1
        state[_WAYS + slow] += 1
        rows[at + _WAY] = slow
