"""Where the robot is on the map: odometry, put right by how a revolution of the lidar's points lies to the map's walls.

Functions of the Goal, whose numbers they keep; layer.py lists them.
"""

from micropython import const

from core.trig import cos14, sin14
from goal.kernels import fit

_COUNT = const(7)
_SUMS = const(8)
_USED = const(17)
_FITS = const(18)
_FAULTS = const(19)
_X = const(24)
_Y = const(25)
_TURN = const(26)
_OX = const(27)
_OY = const(28)
_CX = const(29)  # the correction, 1/8 mm, and
_CY = const(30)
_CT = const(31)  # 1/16384 rad
_LEFT = const(32)
_FRAMES = const(33)
_PHASE = const(34)
_FAILED = const(35)
_WEAK = const(36)
_REVOLUTION = const(37)
_FAR = const(38)
_NEAR = const(39)
_MOUNT_X = const(40)
_MOUNT_Y = const(41)

_TOLD_POSE = const(3)
_TOLD_X = const(4)
_TOLD_Y = const(5)
_TOLD_HEADING = const(6)
_TOLD_ERROR = const(7)
_TOLD_FITS = const(8)

_STRIDE = const(8)  # one beam in so many
_MOST = const(80)  # points
_STEPS = const(5)
_PRIOR = const(262144)  # the prediction counts as two points
_LOST_AFTER = const(12)  # matches that fail one after the other
_POINTS = const(20)  # fewer tell nothing
_ROUND = const(360000)
_KNOWN = const(2)
_LOST = const(3)
_BIT = const(1 << 20)


def advance(goal, lidar, odometry):
    """Go on with the odometry, and take a part of the frame's points."""
    n = goal.numbers
    told = goal.told
    s = sin14(n[_TURN] // 100)
    c = cos14(n[_TURN] // 100)
    dx = (odometry.x - n[_OX] & 0x1FFFFF ^ _BIT) - _BIT
    dy = (odometry.y - n[_OY] & 0x1FFFFF ^ _BIT) - _BIT
    n[_OX] = odometry.x
    n[_OY] = odometry.y
    n[_X] += (dx * c + dy * s + 8192) >> 14
    n[_Y] += (dy * c - dx * s + 8192) >> 14
    x = n[_X] >> 8
    y = n[_Y] >> 8
    told[_TOLD_X] = min(max(x, 0), 32767)
    told[_TOLD_Y] = min(max(y, 0), 32767)
    heading = odometry.heading + n[_TURN]
    told[_TOLD_HEADING] = heading % _ROUND // 100
    if n[_FRAMES] >= n[_REVOLUTION]:
        return
    n[_FRAMES] += 1
    # The frame's points are as old as it took to measure half of it, and to bring it here.
    heading = (heading - odometry.step_heading * 3 // 2) // 100
    s = sin14(heading)
    c = cos14(heading)
    x += (n[_MOUNT_X] * c + n[_MOUNT_Y] * s) >> 14
    y += (n[_MOUNT_Y] * c - n[_MOUNT_X] * s) >> 14
    count = n[_COUNT]
    for k in range(n[_PHASE], lidar.n, _STRIDE):
        d = lidar.distances[k]
        if n[_NEAR] <= d <= n[_FAR] and count < _MOST:
            s = heading + lidar.bearings[k]
            c = (d * cos14(s) + 32768 >> 16) + y
            s = (d * sin14(s) + 32768 >> 16) + x
            if 0 <= s < 32768 and 0 <= c < 32768:
                goal.px[count] = s
                goal.py[count] = c
                count += 1
    n[_COUNT] = count


def again(n):
    """Gather the next revolution."""
    n[_COUNT] = n[_FRAMES] = 0
    n[_PHASE] = (n[_PHASE] + 3) % _STRIDE
    n[_LEFT] = _STEPS
    n[_CX] = n[_CY] = n[_CT] = 0


def score(goal, dx, dy, t, first, stride):
    """The sums of kernels.fit() for a correction: how far the points lie from the map's walls, in all."""
    n = goal.numbers
    a = t * 3581 >> 10  # 1/16384 rad are 0.0035 deg
    c = cos14(a // 100)
    s = sin14(a // 100) + (c * (a % 100) * 286 >> 14) // 1000
    x = n[_X] >> 5
    y = n[_Y] >> 5
    fit(n, 0, 0, goal.field, goal.px, goal.py, first, stride, x, y, s, c, x + dx, y + dy)
    return n[_FAULTS]


def improve(n):
    """A step of Gauss-Newton on the sums, added to the correction. False when it was as good as none.

    The normal equations by elimination; scaled to 14 bits, so that no product leaves the small integers.
    """
    a = n[_SUMS] + _PRIOR
    d = n[_SUMS + 4] + _PRIOR
    f = n[_SUMS + 7] + _PRIOR
    b = max(a, d, f)
    k = 0
    while b >> k > 16383:
        k += 1
    a >>= k
    d >>= k
    f >>= k
    b = n[_SUMS + 1] >> k
    c = n[_SUMS + 2] >> k
    e = n[_SUMS + 5] >> k
    p = -n[_SUMS + 3] >> k
    q = -n[_SUMS + 6] >> k
    r = -n[_SUMS + 8] >> k
    a = max(a, 1)
    m = (b << 14) // a
    d = max(d - (m * b >> 14), 1)
    e -= m * c >> 14
    q -= m * p >> 14
    m = (c << 14) // a
    f -= m * c >> 14
    r -= m * p >> 14
    m = (e << 14) // d
    f = max(f - (m * e >> 14), 1)
    r -= m * q >> 14
    n[_WEAK] = min(a, d, f) << k
    # 64ths over 64ths squared, in 1/8 mm and 1/16384 rad
    f = min(max((r << 10) // f, -2000), 2000)
    d = min(max(((q << 9) - (e * f >> 1)) // d, -2000), 2000)
    a = min(max(((p << 9) - (c * f >> 1) - b * d) // a, -2000), 2000)
    n[_CX] += a
    n[_CY] += d
    n[_CT] += f
    return abs(a) + abs(d) + (abs(f) >> 1) > 6


def match(goal):
    """One step towards the pose at which the points fit the map best. False after the last."""
    n = goal.numbers
    told = goal.told
    score(goal, n[_CX], n[_CY], n[_CT], 0, 1)
    used = n[_USED]
    told[_TOLD_FITS] = fits = n[_FITS] * 100 // max(used, 1)
    n[_LEFT] -= 1
    if used < _POINTS or fits < 50 and n[_LEFT] < _STEPS - 2:
        n[_FAILED] += 1
        told[_TOLD_ERROR] = min(told[_TOLD_ERROR] + 10, 999)
        if n[_FAILED] >= _LOST_AFTER:
            told[_TOLD_POSE] = _LOST
        return False
    if n[_LEFT] and improve(n):
        return True
    correct(n, told)
    return False


def correct(n, told):
    """Take the correction over."""
    n[_X] += n[_CX] << 5
    n[_Y] += n[_CY] << 5
    n[_TURN] = (n[_TURN] + n[_CT] * 3497 // 1000) % _ROUND
    n[_FAILED] = 0
    told[_TOLD_POSE] = _KNOWN
    # What the least certain direction rests on: a few points that stand square to it, or it is the odometry's.
    if n[_WEAK] > n[_USED] << 14:
        told[_TOLD_ERROR] = 5 + n[_FAULTS] // n[_USED]
    else:
        told[_TOLD_ERROR] = min(told[_TOLD_ERROR] + 2, 999)
