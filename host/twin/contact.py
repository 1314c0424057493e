"""Body against walls: least clearance, touches, and walls that hold the body back."""

from dataclasses import dataclass
from math import hypot

TOUCH = 12.0  # mm; a deeper overlap blocks
RELEASE = 2.0  # mm; a contact is over when the body is so far away
RESOLUTION = 2.0  # mm that any point of the body may move between two looks near a wall
HELD = 30.0  # mm; a body that does not get so far away from where it was blocked is held


@dataclass(frozen=True)
class Touch:
    """Where a contact began. time: us, pose: x, y mm, heading radians."""

    time: float
    x: float
    y: float
    heading: float


class Contact:
    """Looks at the walls as often as the body's motion calls for: never while it cannot come nearer than it has been.

    nearest: least clearance so far, mm, negative = depth of overlap. touches: Touch of each contact. held_us: for how long a wall has
    held the body; refused: time (us) at which a motion was last refused, None = never.
    """

    def __init__(self, world, body, half_width, half_length):
        self._world = world
        self._body = body
        self._half = half_width, half_length
        self.touches = []
        self._touching = False
        self.refused = None
        self._held_since = self._held_at = None
        self._fastest = 0.0
        self._last = self.clearance()
        self.nearest = self._last
        self._accept()

    def clearance(self):
        """Clearance of the body where it is now, mm."""
        body = self._body
        return self._world.clearance(body.x, body.y, body.heading, *self._half)[0]

    def follow(self, span):
        """The body has advanced by `span` us: look if it may have come nearer to a wall than ever, and hold it if it went too deep."""
        fastest = self._body.fastest
        self._travel -= max(fastest, self._fastest) * span / 1e6
        self._fastest = fastest
        if self._travel <= 0:
            self._look()

    def walls_moved(self):
        """What has been seen of the walls is of then: look anew at the next motion."""
        self._travel = 0.0

    @property
    def held_us(self):
        return 0.0 if self._held_since is None else self._body.now - self._held_since

    def _look(self):
        body = self._body
        clearance = self.clearance()
        if clearance < -TOUCH and clearance < self._last - 1e-9:
            body.put_back(self._count, self._pose)
            self._hold()
            return
        if self._held_at and hypot(body.x - self._held_at[0], body.y - self._held_at[1]) > HELD:
            self._held_since = self._held_at = None
        self._last = clearance
        self.nearest = min(self.nearest, clearance)
        if clearance <= 0 and not self._touching:
            self._touching = True
            self.touches.append(Touch(body.now, body.x, body.y, body.heading))
        elif clearance > RELEASE:
            self._touching = False
        self._accept()

    def _accept(self):
        """Remember this pose as one to go back to, and how far the body may move before the next look."""
        body = self._body
        self._pose = body.x, body.y, body.heading
        self._count = body.count
        self._travel = RESOLUTION if self._touching else max(self._last - self.nearest, RESOLUTION)

    def _hold(self):
        body = self._body
        self.refused = body.now
        if self._held_since is None:
            self._held_since, self._held_at = body.now, (body.x, body.y)
        self._count = body.count
        self._travel = RESOLUTION
