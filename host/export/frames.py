"""The robot's conventions into those of the standard schemas (ROS REP 103): metres, radians, x forward, y left, angles counter-clockwise."""

from math import cos, pi, radians, sin

MM = 1e-3


def body_point(x: float, y: float) -> tuple[float, float]:
    """x right, y forward, mm -> x forward, y left, m."""
    return y * MM, -x * MM


def body_angle(bearing: float) -> float:
    """Degrees clockwise from forward -> radians counter-clockwise from forward, -pi .. pi."""
    return (pi - radians(bearing)) % (2 * pi) - pi


def world_point(x: float, y: float) -> tuple[float, float]:
    """The world keeps its axes: x right, y up; mm -> m."""
    return x * MM, y * MM


def yaw(heading: float) -> float:
    """Degrees clockwise from +y -> radians counter-clockwise from +x."""
    return pi / 2 - radians(heading)


def quaternion(angle: float) -> dict[str, float]:
    """A turn about z by `angle`, rad."""
    return {"x": 0.0, "y": 0.0, "z": sin(angle / 2), "w": cos(angle / 2)}


def parent_of(true: tuple[float, float, float], believed: tuple[float, float, float]) -> tuple[float, float, float]:
    """Where the frame of the odometry lies in the world (x, y, heading), so that the body believed there is where it truly is.

    true, believed: x, y (mm), heading (degrees clockwise from +y) of the body in the world and in the odometry's frame.
    """
    turn = true[2] - believed[2]
    c, s = cos(radians(turn)), sin(radians(turn))
    x, y = believed[0] * c + believed[1] * s, believed[1] * c - believed[0] * s
    return true[0] - x, true[1] - y, 90.0 + turn  # a heading of 90 is a turn of nothing: see yaw
