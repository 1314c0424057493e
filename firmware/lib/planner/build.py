"""Makes the parts of the planner and joins them. Needed once, at the start: then it is unloaded."""

from array import array

from micropython import const

from perception.local_map import LocalMap
from perception.windows import NO_ZONE, Windows
from planner.candidates import LENGTHS, Candidates
from planner.collision import CollisionCheck
from planner.cost_to_go import CostToGo
from planner.decision import Decision
from planner.free_ways import FreeWays
from planner.move_cost import NOTHING, MoveCost
from planner.plan import Plan
from planner.two_step import MOST, TwoStep

_POINTS = const(320)
_BACKWARD = const(150)  # mm that a move backward costs for being one
_BACKWARD_NAWS = const(300)  # ... where the robot drives worse that way
_NO_POINT = const(32767)
_WAITING = const(0)  # reasons.WAITING


def build(self, config):
    """Everything that an Avoid has. ConfigError is not raised: the config was checked."""
    self.config = config
    self.candidates = candidates = Candidates(config)
    self.map = points = LocalMap(config)
    self.windows = windows = Windows(config, _POINTS)
    cost_to_go = CostToGo(config)
    # The making of a cost to go and the scores of a decision: never at the same time.
    moves = LENGTHS * candidates.count
    scratch = memoryview(cost_to_go.scratch)
    scores = tuple(scratch[moves * k : moves * (k + 1)] for k in range(4))
    self.ways = ways = _free_ways(points, windows, candidates)
    move_cost = MoveCost(cost_to_go, candidates)
    two_step = _two_step(candidates, move_cost, ways, scores)
    self.plan = plan = _plan(candidates, ways, two_step)

    self.decision = decision = Decision()
    decision.stage = 0
    decision.scores = scores
    decision.cost_to_go = cost_to_go
    decision.move_cost = move_cost
    decision.config = config
    decision.map = points
    decision.candidates = candidates
    decision.ways = ways
    decision.two_step = two_step
    decision.plan = plan
    decision.backward = _BACKWARD if config.mode == "AWS" else _BACKWARD_NAWS
    decision.decided = decision.busy = False
    decision.here = 0  # cost to go where the decision began
    decision.side = 0  # the mirroring that is being looked through
    decision.next = 0  # the candidate at which the next slice goes on
    decision.least = NOTHING  # score of the best single move known
    decision.renewing = False
    decision.made_at = array("i", (0, 0, 0))  # where the cost to go was begun, and when
    decision.made_us = 0
    decision.slow = False  # whether making it took long
    decision.late = False  # ... and it has not served yet
    decision.travel = 0  # where and when the last single move was chosen
    decision.chosen_us = 0
    decision.frames_first = config.lidar_frames * 5 // 4  # a revolution and a little: before, the map has gaps
    decision.followed = -1  # frame on which the plan was looked at last
    decision.anchor = array("i", (0, 0, 0))  # where the robot got anywhere last, and how often it has backed up since
    decision.reversals = 0

    self.points_x = ways.x
    self.points_y = ways.y
    self.points_window = windows.window
    self.points_count = 0
    self.points_ordered = True
    self.free_of = ways.free_of
    self.af = self.ar = self.mode = self.window = self.free = self.decisions = 0
    self.v = plan.v
    self.zone = NO_ZONE
    self.block_x = self.block_y = _NO_POINT
    self.why = plan.why


def _words(count):
    return array("H", bytes(2 * count))


def _free_ways(points, windows, candidates):
    ways = FreeWays()
    ways.map = points
    ways.windows = windows
    ways.candidates = candidates
    ways.collision = CollisionCheck(candidates)
    ways.swing = candidates.half_width + candidates.soft + candidates.half_length // 2  # of the tail, see drop_behind()
    ways.x = _words(_POINTS)
    ways.y = _words(_POINTS)
    ways.n = ways.near = ways.frames = 0
    ways.seen = -1
    ways.ordered = True
    ways.free_of = tuple(_words(candidates.count) for _ in range(4))
    ways.soft = _words(candidates.count)
    ways.block = _words(candidates.count)
    return ways


def _two_step(candidates, move_cost, ways, scores):
    two_step = TwoStep()
    two_step.candidates = candidates
    two_step.move_cost = move_cost
    two_step.ways = ways
    two_step.scores = scores
    two_step.mirroring = bytearray(MOST)
    two_step.candidate = bytearray(MOST)
    two_step.length = _words(MOST)
    two_step.costs = array("i", bytes(4 * MOST))
    two_step.n = two_step.near = two_step.ahead = 0  # points as seen from the end of a first move: all, near ones, those not behind
    two_step.second_mirroring = two_step.second_candidate = two_step.second_length = 0
    two_step.begin(0)
    return two_step


def _plan(candidates, ways, two_step):
    plan = Plan()
    plan.candidates = candidates
    plan.ways = ways
    plan.two_step = two_step
    plan.mirroring = plan.candidate = plan.af = plan.ar = plan.free = plan.until = 0
    plan.stand(_WAITING)
    return plan
