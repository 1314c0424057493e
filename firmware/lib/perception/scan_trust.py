"""Can the scan be trusted, and does it follow the motion? A lidar that answers may see nothing; a robot that is held believes its wheels.

The lidar's revolution is a ring of places, one for each frame. Trust is earned: it takes a whole revolution in which

- no two frames were missing, nor the same one as in the revolution before: every place was heard of, or both its neighbours were,
- enough of the beams came back (lidar.returns): not at 0, not below lidar.near, not at lidar.far or beyond, and not all of a frame alike,
- ahead and behind not all was lost at once: a cover, dirt, a dazzled lidar,
- and not every frame was the same as that of its place a revolution before: real ranges waver.

A place ahead or behind from which nothing returns is unknown, not free: glass, a black surface, dirt. The border of what was seen free there
last is put into the frame as if something stood there: the planner keeps off it as off any wall, until a beam sees farther. How far that is
shrinks by all that the wheels have rolled since, turns included. Near the border the robot is slow (`most`).

With lidar.returns = 0, for open halls, what does not return is taken for free. Glass that is seen through cannot be seen.

Motion: each place is cut into four bins, and the range of each, of two of its beams, is compared with that of a revolution before. How it should
have changed is told by the odometry (range flow):

    expected = range that lay in that direction, as the body has turned  -  range in this bin before
               - what the lidar came nearer in the bin's direction  +  the surface's slope * what it went across / range

    bin j before  ___.          a wall; the lidar moves on by d: it is nearer by d along the bin's beam, and looks at
                      \\___.     a place farther on, where the wall slopes
    bin j now         o---->

What moves by itself near the robot: a bin that shows something nearer than all the bins round it were a revolution before, by more than the robot's motion tells
(`lidar.intruder`). The robot stands until nothing has come for a while (LocalMap.doubt).

Bins are weighed by the square of what is expected: beside a parallel wall nothing is, and nothing is said. Those agree that changed as expected,
a quarter more or less. People who walk about spoil some bins; a robot that does not move as told spoils nearly all. The ratio, of the sum of
observed * expected to the weight, is 1 where the robot moves as told, 1/2 at half the speed, 0 where nothing moves, and negative where it goes
the wrong way. It is a fault when less than half the weight agrees and the ratio is low over a second or so, or less than two fifths agree; not at
one revolution, though. Its kind is what the last revolution shows. A second ratio, of the sum of (observed - expected) * slope to that of slope**2,
is by how much the body turned otherwise than it should have; it soon shows wheels that stay as they are when they are told to turn.
The first time the robot stands for a moment, and then the way it was going is taken for blocked for some seconds, so that the planner backs
out. The next time soon after, `alarm` says that it is of no use.
"""

import micropython
from micropython import const

from core.trig import cos14, sin14

# safety/faults.py
_SCAN = const(12)
_NOTHING = const(13)
_WRONG_WAY = const(14)
_HALF = const(15)

_SLOW = const(6)  # V - 90
_ANY = const(90)
_CONE = const(375)  # 0.1 deg to either side of straight ahead or back: there the blind disc hides nothing but the body
_NEAR_BORDER = const(400)  # mm before the border the robot gets slow

_BINS = const(4)  # of a place

# What comes: it is nearer in its bin than any of the bins round it was, and than the robot's own motion tells
_NEAR_BY = const(800)  # mm from the outline
_CAME = const(35)  # mm
_NEIGHBOURS = const(5)  # of six bins that must have been seen: legs of tables come and go in them
_NOWHERE = const(30000)
_JUMP = const(200)  # mm: more is another surface
_INFORMED = const(4000)  # mm**2, weight from which on something can be told
_STEEP = const(400)  # mm from bin to bin: on steeper surfaces ranges say little
_ODD = const(60)  # mm: more is somebody who walks about, and counts no more than that
_SLOPING = const(20_000)  # 2**-4 mm**2 of slopes, from which on something can be told of its turning
_ASTRAY = const(60)  # 2**-8 bin in a second: so far it may turn otherwise, and a sixth of what it should have turned,
_UNSURE = const(800_000)  # and more where few slopes tell
_STAND = const(60)  # frames
_BACK = const(360)  # frames since a fault for which the way is taken for blocked
_FORGET = const(2000)  # and after which it may try again

# Layout of the rows, one for each place; behind them the bins of two revolutions, in turn
_RETURNS = const(0)
_RANGE = const(1)  # when enough returned last: the farthest, mm, and _PLENTY if it was half of the beams; 0: never
_PLENTY = const(0x8000)
_ROLLED = const(2)  # what the wheels had rolled then, mm modulo 2**16
_WAY = const(3)  # 1: ahead the border is near, 2: behind, else 0
_X = const(4)  # where the lidar was, quarter mm
_Y = const(5)
_HEADING = const(6)  # of the body, 0.1 deg
_ROW = const(7)

# What is looked for in a frame, and found
_NEAR = const(0)  # quarter mm, the first that counts
_FAR = const(1)  # the first that does not
_COUNT = const(2)  # how many count,
_LARGEST = const(3)  # and the largest
_ALONE = const(4)
_TWO_BEAMS = const(4000)  # quarter mm; anything so near is met by two beams

# Layout of the state
_LEAST = const(0)  # share of the beams that must come back, %
_SIZE = const(1)  # of the rows
_TURN = const(2)  # bins of a revolution, negative where bearings fall from bin to bin
_LEVER_X = const(3)  # the lidar in the body, mm
_LEVER_Y = const(4)
_NEAREST = const(4)  # mm from the lidar that the border keeps: ahead at _NEAREST + 1, behind at + 2
_WAYS = const(7)  # how many places have no border near; ahead at + 1, behind at + 2
_MISSED = const(10)  # frames that had been missing when it looked last
_SEEN = const(11)  # returns in the rows
_ALIKE = const(12)  # frames in a row as they were a revolution before
_GOOD = const(13)  # frames since trust was lost, up to two revolutions
_NOW = const(14)  # where this revolution's bins begin
_WEIGHT = const(15)  # of the last seconds
_AGREED = const(16)
_RATIO = const(17)  # sum of observed * expected
_SLOPES = const(18)  # sum of slope**2, and of what was not expected * slope: their ratio is by how much it turned otherwise, in bins
_SHIFT = const(19)
_TURNED = const(20)  # what it should have turned, in 2**-8 of a bin, summed over the frames
_NEW = const(6)  # the same six of this revolution are so many places on
_SINCE = const(27)  # frames since a fault of motion, up to _FORGET
_BLOCKED = const(28)  # the way taken for blocked: 1 ahead, 2 behind, 0 neither
_LONE = const(29)  # 0, or how much of a revolution is left until a frame may be missing again, counted like the rows
_DOUBTS = const(30)  # revolutions in a row that spoke against the motion
_SUDDEN = const(31)  # places one after the other, ahead or behind, from which nothing returns all of a sudden
_COVERED = const(32)  # 1 ahead, 2 behind: there was _COVER of them; 0 neither
_COVER = const(3)


@micropython.viper
def _sift(distances: ptr16, bearings: ptr16, n: int, found: ptr32, own: ptr8) -> int:
    """Of the distances (quarter mm) from found[_NEAR] to below found[_FAR]: how many, the largest; none if they are all equal.

    What tells nothing of what stands round the robot becomes 1: the longest distance and beyond, what is nearer than own (for each 32 tenths of a degree how
    far the robot itself reaches, 8 mm), and of what is near a lone reading, which no beam beside it agrees with: that may be dust, or the sun. Returns the place
    of the last of these, counted from 1, its distance in found[_ALONE]; 0 if there is none.
    """
    near = found[_NEAR]
    far = found[_FAR]
    count = 0
    lone = 0
    low = far
    high = 0
    after = 0  # the distance behind, as it was
    while n:
        n -= 1
        d = distances[n]
        if d >= far or d and d < own[bearings[n] >> 5] << 5:
            distances[n] = 1
        elif d >= near:
            count += 1
            if d < low:
                low = d
            if d > high:
                high = d
            # A wall seen at three degrees falls off by a fifth from beam to beam.
            k = d >> 2
            if d < _TWO_BEAMS and (after - d + k) & 0xFFFFF > k + k and n and (distances[n - 1] - d + k) & 0xFFFFF > k + k:
                lone = n + 1
                found[_ALONE] = d
                distances[n] = 1
        after = d
    if low == high:
        count = 0  # no surface is like that
    found[_COUNT] = count
    found[_LARGEST] = high
    return lone


class ScanTrust:
    """config: lidar_returns (%), lidar_near, lidar_far, lidar_x, lidar_y, robot_length (mm), lidar_frames, lidar_mirrored.

    fault   12 while the scan cannot be trusted, 13 nothing moves, 14 it goes or turns the wrong way, 15 it is too slow; else 0
    alarm   True when it has tried to back out: the fault stays until `clear()`
    most    how far V may lie from 90
    """

    def __init__(self, config):
        from perception.build import scan_trust

        scan_trust(self, config)
        self.most = _ANY
        self.clear()

    def clear(self):
        """A person wants it to drive."""
        self.fault = _SCAN
        self.alarm = False
        state = self._state
        state[_SINCE] = _FORGET
        state[_BLOCKED] = 0

    def frame(self, lidar, odometry, v256):
        """Once a frame, before the map gets it. v256: what the motors are told, for its sign."""
        rows = self._rows
        state = self._state
        size = state[_SIZE]
        at = lidar.place * _ROW
        n = lidar.n
        found = self._found
        lidar.intruder = False
        lidar.lone = _sift(lidar.distances, lidar.bearings, n, found, self._own)
        lidar.lone_range = found[_ALONE]
        lidar.returned = returns = found[_COUNT]
        if at == 0:
            self._judge(state, v256)
        self._compare(lidar, odometry, rows, state)
        state[_SEEN] += returns - rows[at]
        self._border(lidar, odometry, rows, state, at)
        rows[at] = returns
        good = state[_GOOD]
        missed = lidar.missed - state[_MISSED]
        lone = state[_LONE]
        if missed > 1 or missed and lone or not n or state[_SEEN] * 100 * _ROW < state[_LEAST] * n * size or state[_ALIKE] >= size or state[_COVERED]:
            good = 0
        elif missed:
            good = min(good, size)  # what is told of the motion has a hole now
        elif good < 2 * size:
            good += _ROW
        state[_GOOD] = good
        if missed:
            state[_MISSED] = lidar.missed
            state[_LONE] = size  # until its place has been heard of again
        elif lone:
            state[_LONE] = lone - _ROW
        if state[_SINCE] < _FORGET:
            state[_SINCE] += 1
            if state[_SINCE] == _BACK:
                state[_BLOCKED] = 0
        if not self.alarm and (self.fault <= _SCAN or state[_SINCE] >= _STAND):
            self.fault = 0 if good >= size else _SCAN
        self.most = _SLOW if v256 >= 0 and state[_WAYS + 1] or v256 <= 0 and state[_WAYS + 2] else _ANY

    def _border(self, lidar, odometry, rows, state, at):
        """Whether the frame's place is unknown, or in the blocked way; if so, the border of what was seen free there into the frame."""
        n = lidar.n
        bearing = lidar.bearings[n >> 1]
        way = slow = 0
        if bearing <= _CONE or bearing >= 3600 - _CONE:
            way = 1
        elif -_CONE <= bearing - 1800 <= _CONE:
            way = 2
        rolled = odometry.travel256 >> 8
        blocked = way == state[_BLOCKED]
        if way == state[_COVERED] and self._found[_COUNT] << 3 > n:
            state[_COVERED] = 0
        # Most of them returned a revolution ago, and none does now: in three places one after the other that is not how a room opens.
        if way and not blocked and self._found[_COUNT] << 3 <= n < rows[at] << 1 and state[_LEAST]:
            state[_SUDDEN] += 1
            if state[_SUDDEN] == _COVER:
                state[_COVERED] = way
        else:
            state[_SUDDEN] = 0
        if self._found[_COUNT] << 3 > n:
            rows[at + _RANGE] = self._found[_LARGEST] >> 2 | (_PLENTY if self._found[_COUNT] << 1 > n else 0)
            rows[at + _ROLLED] = rolled & 0xFFFF
            if not blocked:
                way = 0
        elif not blocked and (not state[_LEAST] or rows[at] << 3 > n):
            way = 0  # it was better the time before
        if way:
            nearest = border = state[_NEAREST + way]
            # Walls that end, and nothing behind, are lost beam by beam. What returned most of a moment ago and nothing now is not to be trusted.
            opened = rows[at + _RANGE]
            opened = not blocked and 0 < opened < _PLENTY
            # The body turns: what a place looks at now, one beside it may have seen.
            size = state[_SIZE]
            k = size - _ROW
            while k <= size + _ROW and not blocked:
                row = (at + k) % size
                seen = rows[row + _RANGE] & _PLENTY - 1
                if seen:
                    seen -= (rolled - rows[row + _ROLLED]) & 0xFFFF
                    if seen > border:
                        border = seen
                    elif seen < 0:
                        rows[row + _RANGE] = 0  # used up, however long the way
                k += _ROW
            slow = way if border < nearest + _NEAR_BORDER else 0
            distances = lidar.distances
            while n and not opened:
                n -= 1
                distances[n] = border << 2
        state[_WAYS + rows[at + _WAY]] -= 1
        state[_WAYS + slow] += 1
        rows[at + _WAY] = slow

    def _judge(self, state, v256):
        """A revolution is over: the weights of those before fade by a quarter."""
        weight = state[_WEIGHT + _NEW]
        ratio = state[_RATIO + _NEW] * 4
        still = state[_AGREED + _NEW] * 2 < weight
        k = _WEIGHT
        while k <= _TURNED:
            state[k] += state[k + _NEW] - (state[k] >> 2)
            state[k + _NEW] = 0
            k += 1
        state[_NOW] = 2 * state[_SIZE] + abs(state[_TURN]) - state[_NOW]
        whole = state[_WEIGHT]
        agreed = state[_AGREED]
        slopes = state[_SLOPES] >> 4
        if (
            whole > _INFORMED
            and still
            and agreed * 2 < whole
            and (state[_RATIO] * 10 < whole * 7 or agreed * 5 < whole * 2)
            or slopes > _SLOPING
            and abs(state[_SHIFT] * 64 // slopes) > _ASTRAY + _UNSURE // slopes + abs(state[_TURNED]) * 2 // (3 * abs(state[_TURN]))
        ):
            state[_DOUBTS] += 1
        else:
            state[_DOUBTS] = 0
        if v256 and not self.fault and state[_DOUBTS] > 1:
            self.fault = _WRONG_WAY if ratio < -weight or ratio > 3 * weight else _NOTHING if ratio < weight else _HALF
            self.alarm = state[_SINCE] < _FORGET
            state[_BLOCKED] = 1 if v256 > 0 else 2
            state[_SINCE] = state[_WEIGHT] = state[_AGREED] = state[_RATIO] = state[_SLOPES] = state[_SHIFT] = 0

    def _compare(self, lidar, odometry, rows, state):
        """The frame's bins with those of a revolution before."""
        size = state[_SIZE]
        turn = abs(state[_TURN])
        now = state[_NOW]
        before = 2 * size + turn - now
        n = lidar.n
        k = lidar.place * _ROW
        # Where the lidar is, quarter mm, and its heading, 0.1 deg
        heading = odometry.heading // 100
        s = sin14(heading)
        c = cos14(heading)
        dx = (odometry.x >> 6) + ((state[_LEVER_X] * c + state[_LEVER_Y] * s) >> 12)
        dy = (odometry.y >> 6) + ((state[_LEVER_Y] * c - state[_LEVER_X] * s) >> 12)
        turned = ((heading - rows[k + _HEADING] + 5400) % 3600 - 1800) * state[_TURN] // 14  # in 2**-8 of a bin
        rows[k + _HEADING] = heading
        heading = ((dx - rows[k + _X] & 0xFFFF) ^ 0x8000) - 0x8000
        rows[k + _X] = dx & 0xFFFF
        dx = ((dy - rows[k + _Y] & 0xFFFF) ^ 0x8000) - 0x8000
        rows[k + _Y] = dy & 0xFFFF
        dy = (heading * s + dx * c) >> 14
        dx = (heading * c - dx * s) >> 14
        state[_TURNED + _NEW] += turned
        moved = dx * dx + dy * dy >> 8
        known = state[_GOOD] == 2 * size
        changes = some = 0
        k = lidar.place * _BINS
        i = n
        while i < 16 * n:
            first = lidar.distances[i >> 4]
            last = lidar.distances[(i + 2 * n) >> 4]
            seen = (first + last) >> 3 if -first < (first - last) * 8 < first else 0  # one surface
            rows[now + k] = seen
            was = rows[before + k]
            changes |= seen ^ was
            some |= seen
            there = (k << 8) + turned
            one = rows[before + (there >> 8) % turn]
            slope = rows[before + ((there >> 8) + 1) % turn] - one
            if known and seen:
                s = lidar.bearings[(i + n) >> 4]
                if seen - (self._own[s >> 5] << 3) < _NEAR_BY:
                    least = _NOWHERE
                    missing = _NEIGHBOURS
                    c = there >> 8
                    for j in range(c - 2, c + 4):
                        c = rows[before + j % turn]
                        if c:
                            missing -= 1
                            if c < least:
                                least = c
                    if missing <= 0 and seen < least - _CAME - ((dx * sin14(s) + dy * cos14(s)) >> 16):
                        lidar.intruder = True
            if known and seen and was and -one < slope * 6 < one:
                there = one + (slope * (there & 255) >> 8)
                s = lidar.bearings[(i + n) >> 4]
                c = cos14(s)
                s = sin14(s)
                there += slope * ((dx * c - dy * s) >> 16) * state[_TURN] // (there * 44 // 7) - ((dx * s + dy * c) >> 16) - was
                seen -= was
                if -_JUMP < there < _JUMP and -_JUMP < seen < _JUMP:
                    was = seen - there
                    # Along a wall little is expected, and most of that because it is taken for bent: less than a quarter of the way tells nothing.
                    if there * there >= moved:
                        state[_WEIGHT + _NEW] += there * there
                        state[_RATIO + _NEW] += there * seen
                        if abs(was) <= (abs(there) >> 2) + 4:
                            state[_AGREED + _NEW] += there * there
                    if -_STEEP < slope < _STEEP:
                        state[_SLOPES + _NEW] += slope * slope
                        state[_SHIFT + _NEW] += slope * min(max(was, -_ODD), _ODD)
            k += 1
            i += 4 * n
        if changes:
            state[_ALIKE] = 0
        elif some:
            state[_ALIKE] += _ROW
