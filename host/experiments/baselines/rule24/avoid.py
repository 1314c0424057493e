"""The papers' strategy as written: windows and zones, then gap seeking with the point rule (24), then the moves of section 4.3 of paper A.

Once a revolution, from that revolution's points alone. Where the papers are silent the mirror image of what they say is done.
"""

import paper
from scanning import LOOK_AHEAD, Scanning

from perception.windows import BLUE, RED
from planner import reasons

_BESIDE = 150  # mm: an obstacle so near beside the body bars the way to that side
_CRUISE = 108
_AWAY = 71


class Avoid(Scanning):
    """In the place of the firmware's planner."""

    def __init__(self, config):
        super().__init__(config)
        self.planner = paper.Planner(config)
        self.planner.look_ahead = LOOK_AHEAD

    def decide(self):
        """Emergency moves first, then the yellow window."""
        if self.near():
            return
        n = self.points_count
        found = self.planner.decide([self.x_mm[i] for i in range(n)], [self.y_mm[i] for i in range(n)])
        if found:
            self.take(found[0], found[1], _CRUISE, reasons.BEND)
        else:
            self.specific()

    def near(self):
        """Moves of the red and blue windows (experiments of paper A, section 6). True if one was taken."""
        near = [self.within((RED, BLUE), (zone,)) for zone in range(10)]
        if near[1] and near[2]:
            self.take(-30, -38, 109, reasons.CENTRE)
        elif near[9] and near[8]:
            self.take(30, 38, 109, reasons.CENTRE)
        elif near[1]:
            self.take(80, 80, _AWAY, reasons.CENTRE)  # to the left and back
        elif near[9]:
            self.take(-80, -80, _AWAY, reasons.CENTRE)
        elif near[0]:
            self.take(0, 0, _AWAY, reasons.CENTRE)
        elif near[7] or near[8]:
            self.take(0, 30, _CRUISE, reasons.CENTRE)  # the rear to the right
        elif near[2] or near[3]:
            self.take(0, -30, _CRUISE, reasons.CENTRE)
        else:
            return False
        return True

    def specific(self):
        """No gap ahead: section 4.3."""
        half_length = self.config.robot_length // 2
        edge = self.config.robot_width // 2 + _BESIDE
        left = right = False
        nearest_left = nearest_right = 30000
        for i in range(self.points_count):
            x, y = self.x_mm[i], self.y_mm[i]
            if abs(y) <= half_length and abs(x) <= edge:
                left = left or x < 0
                right = right or x >= 0
            elif y > half_length:
                if x < 0:
                    nearest_left = min(nearest_left, -x)
                else:
                    nearest_right = min(nearest_right, x)
        back = 180 - _CRUISE
        if left and right:
            self.take(0, 0, back, reasons.BACK)  # (25)
        elif right or not left and nearest_left < nearest_right:
            self.take(90, 90, back, reasons.CRAB)  # (26): to the left
        else:
            self.take(90, 90, _CRUISE, reasons.CRAB)  # (27): to the right
