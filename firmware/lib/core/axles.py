"""Lays out a robot's axles for steering.py, and says what is wrong with them. Needed when a Steering is made only: core/start.py lets it go."""

from array import array

from micropython import const

_LARGEST_RATIO = const(8)
# As in steering.py
_AXLES = const(3)
_TRACK = const(4)
_FIRST = const(5)


def lay_out(spacings, track, first=None):
    """What Steering is made of: its array, mm from the first axle to the last, and how far the body's centre lies ahead of the middle of them.

    spacings: mm between neighbouring axles, front to rear, ints or floats, each > 0; one fewer than there are axles, at least one.
    track: mm between the left and the right wheels, > 0 and less than 8 S, S being the sum of the spacings.
    first: mm from the body's centre forward to the first axle, half of S (also None) where the axles lie evenly about the centre.
    Raises ValueError otherwise, or for more than 15 axles. The last of the three is over S/2, in 2**-14.
    """
    if not spacings:
        raise ValueError("a robot has two axles at least: give one spacing or more")
    if len(spacings) > 14:
        raise ValueError("%d axles are too many: 15 at most" % (len(spacings) + 1))
    if min(spacings) <= 0:
        raise ValueError("axle spacings must be above 0 mm, not %r" % min(spacings))
    span = sum(spacings)
    if not 0 < track < _LARGEST_RATIO * span:
        raise ValueError("track must lie between 0 and %d mm (8 times the wheelbase), not %r" % (_LARGEST_RATIO * span, track))
    n = len(spacings) + 1
    work = array("i", bytes(4 * (_FIRST + 3 * n)))
    work[_AXLES] = n
    work[_TRACK] = _ratio(track, span)
    behind = 0
    for k in range(n - 1):
        behind += spacings[k]
        work[_FIRST + 1 + k] = _ratio(2 * behind, span)
    back = 0 if first is None else int(round((span / 2 - first) * 32768 / span))
    return work, span, back


def _ratio(length, span):
    """length / span in 2**-23, rounded; exact where both are ints."""
    return int((length * 0x1000000 // span + 1) // 2)
