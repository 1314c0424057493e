"""Paper C's method 1: an artificial potential field. What is steered for pulls, the nearest point in each of eight zones round the body pushes away.

Source: paper C, section 1.2.1, and O. Khatib, Real-Time Obstacle Avoidance for Manipulators and Mobile Robots, 1986.
"""

from array import array

from micropython import const

from goal.reactive import Reactive

_REACH = const(380)  # mm from the outline: what is farther off does not push
_PULL = const(1024)
_PUSH = const(1200)  # by what touches


class Field(Reactive):
    """See reactive.py."""

    def __init__(self, avoid):
        Reactive.__init__(self, avoid)
        self._least = array("h", bytes(2 * 27))  # by zone: least distance, and the way there

    def wanted(self):
        """The sum of what pulls and pushes. Never False: it does not back out."""
        least = self._least
        for zone in range(9):
            least[3 * zone] = _REACH
        for k in range(self.ways.n):
            d = self.off(k)
            if d < _REACH:
                dx = self.dx
                dy = self.dy
                at = 3 * ((1 if dx > 0 else 2 if dx < 0 else 0) + (3 if dy > 0 else 6 if dy < 0 else 0))
                if d < least[at]:
                    least[at] = d
                    least[at + 1] = dx
                    least[at + 2] = dy
        length = max(abs(self.x), abs(self.y), 1)
        fx = self.x * _PULL // length
        fy = self.y * _PULL // length
        for at in range(3, 27, 3):
            d = max(least[at], 1)
            if d < _REACH:
                push = (_REACH - d) * (_REACH - d) // _REACH * _PUSH // _REACH
                fx -= least[at + 1] * push // d
                fy -= least[at + 2] * push // d
        self.fx = fx
        self.fy = fy
        return True
