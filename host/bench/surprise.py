"""Something new, close before the nose: put into recorded scans, to see how soon the robot answers."""

DISTANCE_MM = 312  # from the lidar: 12 mm before the nose, inside the red window
HALF_ANGLE = 12.0  # degrees to each side of straight ahead
FIRST_S, APART_S, MOST, LASTS_S, AFTER_S = 3.0, 4.0, 1, 0.25, 0.4
STRAIGHT = 200  # 0.1 deg: ahead is where the robot goes while it steers no more than this


def with_surprise(batches, decisions):
    """Copies of the batches, [(time us, bytes)], each ending soon after something has come up in front of the driving robot.

    decisions: [(time us, AF, AR, V)] made in the run. Whole frames of the Delta family with version 1 are expected.
    """
    out = []
    due = FIRST_S * 1e6
    for time, af, ar, v in decisions:
        if time >= due and v > 100 and abs(af) <= STRAIGHT and abs(ar) <= STRAIGHT:
            out.append([(at, _blocked(data) if time <= at < time + LASTS_S * 1e6 else data) for at, data in batches if at < time + (LASTS_S + AFTER_S) * 1e6])
            due = time + APART_S * 1e6
        if len(out) == MOST:
            break
    return out


def _blocked(data):
    """The frames in the bytes, with every beam near straight ahead shortened."""
    out = bytearray(data)
    at = 0
    while at + 13 <= len(out):
        length = int.from_bytes(out[at + 1 : at + 3], "big")
        if out[at] != 0xAA or at + length + 2 > len(out):
            break
        if out[at + 5] == 0xAD:
            start = int.from_bytes(out[at + 11 : at + 13], "big") / 100
            count = (length - 13) // 3
            for n in range(count):
                bearing = (start + 22.5 * n / count + 180) % 360 - 180
                if abs(bearing) <= HALF_ANGLE:
                    place = at + 13 + 3 * n
                    out[place : place + 3] = bytes((60,)) + (4 * DISTANCE_MM).to_bytes(2, "big")
            out[at + length : at + length + 2] = (sum(out[at : at + length]) & 0xFFFF).to_bytes(2, "big")
        at += length + 2
    return bytes(out)
