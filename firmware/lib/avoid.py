"""From what stands round the robot to (AF, AR, V), and why.

Here the parts are joined: each lidar frame goes into the map of points (perception/local_map.py); the guard looks at the steering being
driven on every frame; the decision (planner/decision.py) is made in slices, one a call of `step()`; what comes of it is published.
docs/planner.md tells the whole of it.
"""

from micropython import const

from core.unload import forget
from planner.decision import COST_TO_GO, REST
from steering import mode_of

_NO_POINT = const(32767)
_NO_BLOCK = const(65535)
_BLOCKED = const(17)  # reasons.BLOCKED
_RED = const(2)  # perception/windows.py


class Avoid:
    """Decides where to go. See docs/architecture.md for the attributes of a decision; planner/build.py lays them out.

    points_x, points_y    array('H'), mm + 8192 in the body frame; points_window: bytearray, the window of each
    points_count          how many; points_ordered: whether they are in the order of points_window
    """

    def __init__(self, config):
        from planner.build import build

        build(self, config)
        del build
        forget("planner.build", "planner.parts")
        self.configure()

    def configure(self):
        """Take over parameters that may have been tuned. Margins and look-ahead count from the next start: the tables are made with them."""
        config = self.config
        self.decision.move_cost.configure(config)
        self.windows.configure(config)
        self._changes = config.changes

    def frame(self, lidar, odometry):
        """Take in one measurement frame."""
        self.map.frame(lidar, odometry)
        self.decision.cost_to_go.follow(odometry)
        self.ways.frames += 1

    def guard(self, odometry, speed):
        """Look at every frame: True, and v = 90, when the way being driven is no longer free as far as it takes to stop at `speed` mm/s."""
        plan = self.plan
        self._see(odometry)
        # What rolls out in the motors' time constant, and a little.
        if plan.look() >= speed // 9 and not self.map.threatened:
            return False
        plan.stand(_BLOCKED)
        self.decision.stage = REST
        self._publish(1)
        return True

    def observe(self, odometry, why, af, ar, v):
        """Somebody else decides: keep the points and windows up to date, and say why."""
        ways = self.ways
        plan = self.plan
        self._see(odometry)
        plan.stand(why)
        plan.af = af
        plan.ar = ar
        plan.v = v
        plan.free = 0
        ways.block[plan.candidate] = _NO_BLOCK
        self.decision.stage = COST_TO_GO
        self._publish(1 if ways.frames & 7 == 0 else 0)

    def _see(self, odometry):
        ways = self.ways
        ways.see(odometry)
        self.points_count = ways.n
        self.points_ordered = True

    def step(self, odometry):
        """One slice. Returns True when a decision has just been made (af, ar, v and the rest hold it)."""
        if self.config.changes != self._changes:
            self.configure()
        decided = self.decision.step(odometry)
        ways = self.ways
        if decided:
            if self.map.threatened:
                self.plan.stand(_BLOCKED)
            else:
                self.plan.choose_speed(_RED if self.map.doubt else self.windows.urgent, self.config)
            self._publish(1)
        self.points_count = ways.n
        self.points_ordered = ways.ordered
        return decided

    def _publish(self, news):
        """Lay out what belongs to the decision for those who look on; news: 1 if they are to take notice, 0 if not."""
        plan = self.plan
        ways = self.ways
        windows = self.windows
        self.af = plan.af
        self.ar = plan.ar
        self.v = plan.v
        self.free = plan.free
        self.why = plan.why
        self.mode = mode_of(plan.af, plan.ar)
        self.window = windows.urgent
        self.zone = windows.zone()
        block = ways.block[plan.candidate]
        if block == _NO_BLOCK:
            self.block_x = self.block_y = _NO_POINT
        else:
            self.block_x = ways.x[block] - 8192
            self.block_y = ways.y[block] - 8192
        self.decisions += news
