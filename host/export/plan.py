"""The steering that was chosen, as a way in the body frame: for the scene of an exported recording."""

from math import cos, hypot, radians, sin

STEP_MM = 20.0


def way(af: float, ar: float, v: float, length: float, span: float) -> list[tuple[float, float, float]]:
    """Poses (x, y in mm, heading in degrees clockwise) of the body's centre along the steering AF, AR (degrees), over `length` mm; backward for V below 90, nothing at 90.

    span: from the first to the last axle, mm. The motion is the firmware's own (firmware/lib/steering.py), for axles that lie evenly round the centre.
    """
    if v == 90 or length <= 0 or span <= 0:
        return []
    a, b = radians(af), radians(ar)
    vx, vy, w = sin(a + b) / 2, cos(a) * cos(b), sin(a - b) / span
    if abs(vx) < 1e-9 and abs(vy) < 1e-9:  # on the spot, or straight sideways
        if abs(af - ar) > 90:
            w = (1 if af > ar else -1) * 2 / span
        else:
            vx = 1.0 if af > 0 else -1.0
    sign = 1 if v > 90 else -1
    speed = max(hypot(vx, vy), abs(w) * span / 2)
    steps = max(int(length / STEP_MM), 1)
    out = [(0.0, 0.0, 0.0)]
    x = y = heading = 0.0
    for _ in range(steps):
        step = sign * length / steps / speed
        half = heading + w * step / 2
        x += step * (vx * cos(half) + vy * sin(half))
        y += step * (vy * cos(half) - vx * sin(half))
        heading += w * step
        out.append((x, y, heading * 57.29577951308232))
    return out
