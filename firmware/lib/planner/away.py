"""Whether the robot has got away from a place: an array('i') of x, y (1/256 mm) and heading (0.001 deg)."""


def mark(place, odometry):
    """The place is where the robot is now."""
    place[0] = odometry.x
    place[1] = odometry.y
    place[2] = odometry.heading


def away(place, odometry, reach, heading):
    """Whether the robot is `reach` mm from the place or farther, or has turned by more than `heading` (0.001 deg) since."""
    # Modulo 8 m: the odometry's coordinates go round.
    dx = ((odometry.x - place[0] & 0x1FFFFF ^ 0x100000) - 0x100000) >> 8
    dy = ((odometry.y - place[1] & 0x1FFFFF ^ 0x100000) - 0x100000) >> 8
    turned = (odometry.heading - place[2]) % 360000
    return dx * dx + dy * dy >= reach * reach or min(turned, 360000 - turned) > heading
