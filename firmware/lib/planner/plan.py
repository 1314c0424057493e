"""What is being driven: one steering, or the two moves of a plan one after the other as long as the points agree; and how fast."""

from micropython import const

_STANDING = const(90)
_ARRIVED = const(4)  # mm before its end a move is over
_RED = const(2)  # perception/windows.py
_SLACK = const(10)  # mm that the way ahead may be short of what is left of a move: points waver
_PLAN = const(5)  # reasons.PLAN


class Plan:
    """The steering chosen last, how far it goes, and why. Laid out by planner/build.py.

    mirroring, candidate    which one: bit 0 of mirroring left, bit 1 backward
    af, ar, v               0.1 deg; speed 0..180, 90 stands
    free                    mm that the points leave it
    limit                   mm to drive on it at most
    moves                   of a plan: 0 there is none, the steering is decided again all the time; 1 in the first move; 2 in the second
    why                     planner/reasons.py
    """

    def take(self, mirroring, candidate):
        """Choose a steering; how far it is free was checked before."""
        candidates = self.candidates
        self.mirroring = mirroring
        self.candidate = candidate
        self.af = candidates.af_of(mirroring, candidate)
        self.ar = candidates.ar_of(mirroring, candidate)
        self.free = self.ways.free_of[mirroring][candidate]

    def begin(self, moves, length, odometry, why):
        """The steering taken is a move of `length` mm: number `moves` of a plan."""
        self.moves = moves
        self.limit = length
        self.until = odometry.travel256 + (length << 8)
        self.why = why

    def stand(self, why):
        self.v = _STANDING
        self.limit = 0
        self.moves = 0
        self.why = why

    def look(self):
        """How far the steering is free among the points as they are now."""
        self.free = free = self.ways.free(self.mirroring, self.candidate)
        return free

    def left(self, odometry):
        """What is left of the move that is being driven, mm."""
        return (((self.until - odometry.travel256) & 0x3FFFFFF ^ 0x2000000) - 0x2000000) >> 8

    def arrived(self, odometry):
        return self.left(odometry) <= _ARRIVED

    def follow(self, odometry):
        """Go on with the plan if the points still allow it. False when it is over."""
        left = self.left(odometry)
        lengths = self.candidates.lengths
        if left > _ARRIVED:
            self.limit = left
            if self.free >= min(left, 2 * lengths[0]) - _SLACK:
                return True
        elif self.moves == 1 and self.two_step.found:
            second = self.two_step
            mirroring = second.second_mirroring
            length = second.second_length
            if self.ways.free(mirroring, second.second_candidate) >= min(length, lengths[1]):
                self.take(mirroring, second.second_candidate)
                self.begin(2, length, odometry, _PLAN)
                return True
        self.moves = 0
        return False

    def choose_speed(self, urgent, config):
        """V for the way ahead, 0..180 with 90 standing. urgent: the most urgent window that has a point."""
        way = min(self.free, self.limit)
        if way <= 0:
            self.v = _STANDING
            return
        cruise = config.drive_cruise - _STANDING
        # Stop within the free way: it takes about speed / 10 mm.
        v = min((60 + way * 3) * 90 // config.motors_full_speed, cruise)
        lengths = self.candidates.lengths
        if 0 < urgent <= _RED and self.free < lengths[2]:
            v = min(v, cruise // 2)  # what the robot only passes, or leaves behind, does not slow it
        elif self.ways.soft[self.candidate] < lengths[1]:
            v = min(v, cruise * 4 // 5)  # it gets narrow soon
        v = max(v, 4)
        self.v = _STANDING - v if self.mirroring & 2 else _STANDING + v
