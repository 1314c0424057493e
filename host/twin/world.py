"""Rays and contact against the walls of a course, for the whole frame or the whole body at once."""

import numpy as np

FAR = 1e9
_CORNER_X = np.array([[1.0], [1.0], [-1.0], [-1.0]])
_CORNER_Y = np.array([[1.0], [-1.0], [1.0], [-1.0]])


class World:
    """Walls as segments.

    segments: (n, 4), mm.
    """

    def __init__(self, segments):
        self.put(segments)

    def put(self, segments):
        """Other walls from now on, for all who look at this world."""
        self.segments = np.asarray(segments, float)
        self._start = np.ascontiguousarray(self.segments[:, :2].T)
        end = self.segments[:, 2:].T
        self._side = np.ascontiguousarray(end - self._start)
        length = np.hypot(*self._side)
        self._normal = np.stack([-self._side[1], self._side[0]]) / length
        self._tangent = self._side / length
        self._length = length

    def ranges(self, x, y, bearing):
        """Distance to the nearest wall of each ray, mm (FAR: none). x, y, bearing: (m,), radians clockwise from +y."""
        dx, dy = np.sin(bearing)[:, None], np.cos(bearing)[:, None]
        ex, ey = self._side
        px = self._start[0] - x[:, None]
        py = self._start[1] - y[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            inverse = 1.0 / (dx * ey - dy * ex)
            along = (px * ey - py * ex) * inverse
            across = (px * dy - py * dx) * inverse
        hit = (along > 0) & (across >= 0) & (across <= 1)
        return np.where(hit, along, FAR).min(axis=1)

    def clearance(self, x, y, heading, half_width, half_length):
        """(clearance, wall): least distance from a rectangle to the walls, mm; negative = depth of the deepest overlap.

        x, y, heading: pose of its centre. wall: index of the nearest or deepest segment. The depth is the shortest way out of one
        segment, along a side of the rectangle or across the segment.
        """
        s, c = np.sin(heading), np.cos(heading)
        ax, ay = self._start[0] - x, self._start[1] - y
        # Body frame: x right, y forward.
        x1, y1 = ax * c - ay * s, ax * s + ay * c
        ex, ey = self._side
        x2, y2 = x1 + ex * c - ey * s, y1 + ex * s + ey * c
        # Signed gaps along the three axes that can separate a rectangle from a segment; all negative = overlap.
        nx, ny = self._normal
        nx, ny = nx * c - ny * s, nx * s + ny * c
        reach = half_width * np.abs(nx) + half_length * np.abs(ny)
        line = np.abs(x1 * nx + y1 * ny) - reach
        side = np.maximum(np.minimum(x1, x2), -np.maximum(x1, x2)) - half_width
        front = np.maximum(np.minimum(y1, y2), -np.maximum(y1, y2)) - half_length
        gap = np.maximum(np.maximum(side, front), line)
        wall = int(gap.argmin())
        if gap[wall] <= 0:
            return float(gap[wall]), wall
        distance = self._distances(x1, y1, x2, y2, half_width, half_length, c, s)
        wall = int(distance.argmin())
        return float(distance[wall]), wall

    def _distances(self, x1, y1, x2, y2, half_width, half_length, c, s):
        """Distance of each segment (body frame) from the rectangle, none overlapping it."""
        first = np.hypot(np.maximum(np.abs(x1) - half_width, 0), np.maximum(np.abs(y1) - half_length, 0))
        second = np.hypot(np.maximum(np.abs(x2) - half_width, 0), np.maximum(np.abs(y2) - half_length, 0))
        best = np.minimum(first, second)
        tx, ty = self._tangent
        tx, ty = tx * c - ty * s, tx * s + ty * c
        rx, ry = half_width * _CORNER_X - x1, half_length * _CORNER_Y - y1
        along = np.minimum(np.maximum(rx * tx + ry * ty, 0), self._length)
        corner = np.hypot(rx - along * tx, ry - along * ty).min(axis=0)
        return np.minimum(best, corner)
