"""A trajectory as the board takes it: knots about a tenth of a second apart, each with angles and speeds; the firmware plays a cubic polynomial between two.

The layout is told in firmware/lib/arm/requests.py.
"""

import math
import struct

import numpy as np

from core.crc16 import crc16

from .errors import ArmError
from .model import Arm
from .reach import Reach

KNOT_S = 0.1
MOST_BYTES = 8192
_HEAD = struct.Struct("<2sBBHH")
FARTHEST = 320.0  # deg, of a set point on the board


def rows(arm: Arm) -> list[tuple[float, float, float]]:
    """(low, high, speed) of each servo: joints, then extra joints; deg, deg/s."""
    joints = [(math.degrees(low), math.degrees(high), math.degrees(speed)) for low, high, speed in zip(arm.low, arm.high, arm.speeds)]
    return joints + [(one["low_deg"], one["high_deg"], one["speed_deg_s"]) for one in arm.extra]


def ident(arm: Arm) -> int:
    """What tells an arm from another on the board: CRC-16 of its name and its limits."""
    data = arm.name.encode()
    for low, high, speed in rows(arm):
        data += struct.pack("<HHH", round(100 * low) & 0xFFFF, round(100 * high) & 0xFFFF, round(10 * speed) & 0xFFFF)
    return crc16(data, 0, len(data))


def encode(reach: Reach, knot_s: float = KNOT_S) -> bytes:
    """The bytes. ArmError if the board could not take them."""
    arm = reach.arm
    if arm.servos is None:
        raise ArmError(f"{arm.name}: arm.json has no servos: it can be planned for, not played")
    times = [0.0]
    for begin, end in zip(reach.times[:-1], reach.times[1:]):
        count = max(math.ceil((end - begin) / knot_s - 1e-9), 1)
        times += [begin + (end - begin) * k / count for k in range(1, count + 1)]
    when = np.array(times)
    q, qd, _ = reach.at(when)
    h = 1e-4
    extra = reach.extra_at(when)
    extra_speed = (reach.extra_at(when + h) - reach.extra_at(when - h)) / (2 * h)
    extra_speed[[0, -1]] = 0
    angles = np.hstack([np.degrees(q), extra])
    speeds = np.hstack([np.degrees(qd), extra_speed])
    if np.abs(angles).max() > FARTHEST:
        raise ArmError(f"a joint goes to {np.abs(angles).max():.0f} deg; the board's set points end at {FARTHEST:g}")
    stamps = np.round(1000 * when).astype(int)
    spans = np.diff(stamps, prepend=stamps[0])
    if (spans[1:] < 1).any():
        raise ArmError("two points of the trajectory are less than a millisecond apart")
    data = _HEAD.pack(b"GR", 1, angles.shape[1], ident(arm), len(when))
    for span, angle, speed in zip(spans, angles, speeds):
        pairs = [v for k in range(len(angle)) for v in (round(100 * angle[k]), round(10 * speed[k]))]
        data += struct.pack(f"<H{len(pairs)}h", span, *pairs)
    data += struct.pack("<H", crc16(data, 0, len(data)))
    if len(data) > MOST_BYTES:
        raise ArmError(f"the trajectory is {len(data)} bytes on the board, {MOST_BYTES} is the most: it is too long, {reach.total:.0f} s")
    return data
