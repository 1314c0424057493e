"""How far the links are from the obstacles, for many poses at once. Below 0: how deep they are in.

Link 1 begins at the base. What the base itself stands on (nearer to it than TOUCHES) cannot be kept clear of by that link: of it only the far end counts there.
"""

import math

import numpy as np

from .model import Arm
from .scenes import Box, Disc, HalfPlane, Obstacle

TOUCHES = 0.01  # m


def corners(arm: Arm, cos, sin):
    """x and y of base, joints and end, (n + 1, ...) m, from cosines and sines of the directions (n, ...)."""
    shape = (arm.joints + 1, *cos.shape[1:])
    x, y = np.empty(shape), np.empty(shape)
    x[0], y[0] = arm.base
    for i, length in enumerate(arm.lengths):
        np.add(x[i], length * cos[i], out=x[i + 1])
        np.add(y[i], length * sin[i], out=y[i + 1])
    return x, y


def least(arm: Arm, x, y, cos, sin, obstacles) -> np.ndarray:
    """Least distance, m, over all links and obstacles, (...); infinite without obstacles. x, y: from corners(); cos, sin: of the directions."""
    found = np.full(x.shape[1:], np.inf)
    for obstacle in obstacles:
        stands = distance_of_point(obstacle, *arm.base) < TOUCHES
        for i in range(arm.joints):
            far_only = stands and i == 0
            np.minimum(found, _link(obstacle, x[i], y[i], cos[i], sin[i], arm.lengths[i], far_only) - arm.radii[i], out=found)
    return found


def distance_of_point(obstacle: Obstacle, x: float, y: float) -> float:
    """Signed distance of one point, m."""
    cos, sin = np.array([1.0]), np.array([0.0])
    return float(_link(obstacle, np.array([x]), np.array([y]), cos, sin, 0.0, False)[0])


def _link(obstacle, x, y, cos, sin, length, far_only):
    """Distance of segments that begin at (x, y) and go `length` along (cos, sin)."""
    if far_only:
        x, y, length = x + length * cos, y + length * sin, 0.0
    if isinstance(obstacle, Disc):
        dx, dy = obstacle.x - x, obstacle.y - y
        along = np.clip(dx * cos + dy * sin, 0.0, length)
        dx -= along * cos
        dy -= along * sin
        return np.sqrt(dx * dx + dy * dy) - obstacle.radius
    if isinstance(obstacle, HalfPlane):
        out_x, out_y = math.cos(obstacle.angle), math.sin(obstacle.angle)
        near = (x - obstacle.x) * out_x + (y - obstacle.y) * out_y
        return np.minimum(near, near + length * (cos * out_x + sin * out_y))
    return _box(obstacle, x, y, cos, sin, length)


def _box(box: Box, x, y, cos, sin, length):
    """Outside: Euclid's distance. Inside: how far in along the nearest side. Both in the box's own axes."""
    c, s = math.cos(box.angle), math.sin(box.angle)
    x, y = (x - box.x) * c + (y - box.y) * s, (y - box.y) * c - (x - box.x) * s
    cos, sin = cos * c + sin * s, sin * c - cos * s
    half_w, half_h = box.width / 2, box.height / 2
    # How far outside each side the point at t along the segment is: four lines in t, whose upper envelope is lowest at an end or where two cross.
    offsets = (x - half_w, -x - half_w, y - half_h, -y - half_h)
    slopes = (cos, -cos, sin, -sin)
    ts = [np.zeros_like(x), np.full_like(x, length)]
    for i in range(4):
        for j in range(i):
            slope = slopes[i] - slopes[j]
            with np.errstate(divide="ignore", invalid="ignore"):
                t = np.where(np.abs(slope) > 1e-12, (offsets[j] - offsets[i]) / slope, 0.0)
            ts.append(np.clip(t, 0.0, length))
    depth = np.full_like(x, np.inf)
    for t in ts:
        worst = np.maximum(
            np.maximum(offsets[0] + slopes[0] * t, offsets[1] + slopes[1] * t), np.maximum(offsets[2] + slopes[2] * t, offsets[3] + slopes[3] * t)
        )
        np.minimum(depth, worst, out=depth)
    outside = np.full_like(x, np.inf)
    for px, py in ((x, y), (x + length * cos, y + length * sin)):  # ends of the segment to the box
        np.minimum(outside, np.hypot(np.maximum(np.abs(px) - half_w, 0), np.maximum(np.abs(py) - half_h, 0)), out=outside)
    for corner_x, corner_y in ((half_w, half_h), (-half_w, half_h), (half_w, -half_h), (-half_w, -half_h)):  # corners of the box to the segment
        dx, dy = corner_x - x, corner_y - y
        along = np.clip(dx * cos + dy * sin, 0.0, length)
        np.minimum(outside, np.hypot(dx - along * cos, dy - along * sin), out=outside)
    return np.where(depth < 0, depth, outside)
