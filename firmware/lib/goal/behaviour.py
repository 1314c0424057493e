"""Paper C's method 2: behaviours, the first that wants to acts. Avoid; at a door search; else run to the goal.

Nine sectors of 20 degrees, S1 to the left, S5 ahead, S9 to the right, hold the least distance from the body's outline. Source: paper C, section 1.2.2, with case 3, which it leaves
out: where something is near on both sides, to the side where it is farther; a tie goes by the side of the goal; and back where it is too near on both.
"""

from array import array

from micropython import const

from goal.reactive import Reactive

_FAR = const(350)  # d_max, mm
_NEAR = const(60)  # d_min: stop and back off; paper C has 100 for a round robot among furniture, and this one goes through doors of less room
_SECTORS = const(9)
_TANGENTS = (181, 591, 1220, 2813)  # of 10, 30, 50, 70 degrees, * 1024
_ASIDE = const(1220)  # avoiding: 50 degrees to the side
_NOTHING = const(32767)


class Behaviour(Reactive):
    """See reactive.py. searches: a door is being passed; avoids: -1 to the left, 1 to the right, 0 not."""

    def __init__(self, avoid):
        Reactive.__init__(self, avoid)
        self.sectors = array("h", bytes(2 * _SECTORS))
        self.avoids = 0
        self._backs = 0

    def look(self):
        """Fill the sectors."""
        sectors = self.sectors
        for k in range(_SECTORS):
            sectors[k] = _NOTHING
        ways = self.ways
        for k in range(ways.n):
            d = self.off(k)
            y = ways.y[k] - 8192
            if d > 2 * _FAR or y < 0:
                continue
            x = ways.x[k] - 8192
            at = 0
            while at < 4 and abs(x) * 1024 > _TANGENTS[at] * y:
                at += 1
            at = 4 + at if x > 0 else 4 - at
            if d < sectors[at]:
                sectors[at] = d

    def wanted(self):
        """fx, fy: where to. False: back."""
        self.look()
        sectors = self.sectors
        self.fx = self.x
        self.fy = self.y
        left = min(min(sectors[0], sectors[1]), min(sectors[2], sectors[3]))
        right = min(min(sectors[5], sectors[6]), min(sectors[7], sectors[8]))
        ahead = sectors[4]
        if self._backs:
            self._backs -= 1
            return ahead > 2 * _NEAR
        if self.searches:
            self.avoids = 0
            return True
        if self.avoids:
            if min(left, right, ahead) > _FAR or self.goal_is_free():
                self.avoids = 0
        elif min(left, right, ahead) <= _FAR and not self.goal_is_free():
            if right <= _FAR and left > _FAR:
                self.avoids = -1
            elif min(left, ahead) <= _FAR and right > _FAR:
                self.avoids = 1
            elif left != right:
                self.avoids = -1 if left > right else 1
            else:
                self.avoids = -1 if self.x < 0 else 1
        if self.avoids:
            if ahead < _NEAR:
                self._backs = 8
                return False
            self.fx = self.avoids * _ASIDE
            self.fy = 1024
        return True

    def goal_is_free(self):
        """Whether the sectors within 35 degrees of the goal's bearing are free as far as d_max, or to the goal."""
        need = min(_FAR, max(abs(self.x), abs(self.y)))
        x = self.x
        y = self.y
        if y <= 0:
            return False
        at = 0
        while at < 4 and abs(x) * 1024 > _TANGENTS[at] * y:
            at += 1
        at = 4 + at if x > 0 else 4 - at
        for k in range(max(at - 2, 0), min(at + 3, _SECTORS)):
            if self.sectors[k] < need and (abs(k - at) < 2 or self.sectors[k] < need >> 1):
                return False
        return True
