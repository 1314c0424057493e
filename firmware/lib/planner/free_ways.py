"""How far each candidate steering is free among the points as the body sees them."""

from planner.collision import drop_behind, mirror


class FreeWays:
    """The points in the body frame, and what was found of the candidates. Laid out by planner/build.py.

    x, y         array('H'), mm + 8192, of `n` points; the `near` ones at the outline come first
    ordered      whether windows.window goes with them point by point: checks of many candidates put them in another order
    free_of      by mirroring (bit 0 left, bit 1 backward): array('H'), mm that each candidate is free; 65535 where it need not be checked
    soft, block  of those checked last: mm until it gets narrow, and the number of the point that ends it, 65535 none
    frames       lidar frames taken in so far; `seen`: how many they were at the last see()
    """

    def see(self, odometry):
        """The points from where the body is now, and the window of each."""
        self.seen = self.frames
        self.look(odometry.x >> 5, odometry.y >> 5, (odometry.heading + 50) // 100)

    def look(self, x, y, heading):
        """The points from a pose (1/8 mm, 0.1 deg), in the order of the map: which of them serve must not depend on what was checked before."""
        env = self.candidates
        windows = self.windows
        self.n = n = self.map.view(x, y, heading, self.x, self.y, env.look_ahead + env.half_length)
        windows.sort(self.x, self.y, n)
        self.near = windows.near
        self.ordered = True

    def free(self, mirroring, candidate):
        """mm that one candidate is free."""
        self.check(mirroring, candidate, candidate + 1, 0)
        return self.free_of[mirroring][candidate]

    def check(self, mirroring, first, last, floor):
        """Candidates first..last-1 in a mirroring; those shorter than floor mm are given up early."""
        self.mirror(mirroring)
        n = self.drop_behind() if last - first > 1 else self.n  # checking several changes the order of the points anyhow
        self.collision.prepare(n, self.near, 1, floor)
        self.collision.check(self.x, self.y, first, last, self.free_of[mirroring], self.soft, self.block)
        self.mirror(mirroring)

    def mirror(self, mirroring):
        """Mirror the points, or put them back."""
        if mirroring & 1:
            mirror(self.x, self.n)
        if mirroring & 2:
            mirror(self.y, self.n)

    def drop_behind(self):
        """Bring the points that no candidate can meet to the end; returns how many are before them."""
        env = self.candidates
        self.ordered = False
        return drop_behind(self.n, self.x, self.y, self.near, env.half_length + env.soft, self.swing)
