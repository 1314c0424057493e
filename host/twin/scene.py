"""All that stands and moves round the robot: the walls of a course, and the boxes that move in it."""

import numpy as np

from .contact import RELEASE, Touch
from .world import World

MOVING = 5.0  # mm/s of any point of the body, above which a contact is its own


class Scene:
    """walls: World of what stands. What moves is where it was at the time told last by `at`."""

    def __init__(self, course):
        self.walls = World(course.segments)
        self._moving = course.moving
        self._boxes = None
        self.at(0.0)

    def at(self, time):
        """Let what moves be where it is at the time, us."""
        if self._moving:
            self._boxes = World(np.vstack([mover.at(time / 1e6) for mover in self._moving]))

    @property
    def moving(self):
        """(n, 4): sides of what moves, as `Course.segments`; None where nothing does."""
        return None if self._boxes is None else self._boxes.segments

    def ranges(self, x, y, bearing):
        """As World.ranges."""
        ranges = self.walls.ranges(x, y, bearing)
        return ranges if self._boxes is None else np.minimum(ranges, self._boxes.ranges(x, y, bearing))

    def gap(self, body, half_width, half_length):
        """Clearance between the body and what moves, mm, negative = depth; None where nothing does."""
        return None if self._boxes is None else self._boxes.clearance(body.x, body.y, body.heading, half_width, half_length)[0]


class Encounters:
    """Contacts with what moves: those by the robot's own motion, and those of a robot that stood (`touched_by`). Nothing holds anybody back: people give way.

    touches, touched_by: Touch of each. nearest: least clearance while the robot moved, mm.
    """

    def __init__(self, scene, body, half_width, half_length):
        self._scene, self._body, self._half = scene, body, (half_width, half_length)
        self.touches, self.touched_by = [], []
        self._touching = None  # the list that the contact going on counts in
        self.nearest = np.inf

    def look(self):
        gap = self._scene.gap(self._body, *self._half)
        if gap is None:
            return
        body = self._body
        moves = body.fastest > MOVING
        if moves:
            self.nearest = min(self.nearest, gap)
        if gap > RELEASE:
            self._touching = None
        elif gap <= 0 and self._touching is not self.touches and (moves or self._touching is None):
            # One that began while the robot stood becomes its own when it drives on against what stands there.
            self._touching = self.touches if moves else self.touched_by
            self._touching.append(Touch(body.now, body.x, body.y, body.heading))
