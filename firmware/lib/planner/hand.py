"""A person steers, and the robot keeps off walls all the same. Loaded when somebody drives it by hand, and let go when it is told to stand."""

from micropython import const

_MANUAL = const(14)  # reasons.MANUAL
_KEPT = const(20)  # mm
_STOPS = const(300)  # V - 90 for each mm of room, times the full speed in mm/s: what rolls out in 0.3 s, until a beam has seen it and the motors stand
_CREEP = const(6)  # V - 90 with which it may go on as long as there is any room


def by_hand(avoid, odometry, af, ar, v):
    """How far V may lie from 90 for one who steers AF, AR (0.1 deg) and asks for V: as far as there is room to stop, by the candidate next to it."""
    avoid.observe(odometry, _MANUAL, af, ar, v)
    if v == 90:
        return 0
    back = 0
    if v < 90:
        af, ar, back = -ar, -af, 2
    candidates = avoid.candidates
    afs, ars = candidates.af, candidates.ar
    least = 3600
    for k in range(candidates.count):
        right = abs(afs[k] - af) + abs(ars[k] - ar)
        left = abs(afs[k] + af) + abs(ars[k] + ar)
        if right < least:
            least, best, mirroring = right, k, back
        if left < least:
            least, best, mirroring = left, k, back | 1
    room = avoid.ways.free(mirroring, best) - _KEPT
    if room < 0:
        return 0
    return max(room * _STOPS // avoid.config.motors_full_speed, _CREEP)
