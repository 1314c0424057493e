"""Measures the calls of the robot's parts from outside: in microseconds here, or in instructions on the ESP32."""

import gc
import sys
from array import array

import lockstep
import log
from log import COMMAND, FEED, GUARD, KINDS, PAPER, PAPER_FULL, PLACE, PLAIN, POINTS, POLL, START, STOP, TURN, UPDATE, WORK
from sums import clear_counters, sum_counters

from planner.decision import REST


class Watch:
    """Measures the calls of one robot's parts. What a part calls of another is that other's."""

    def __init__(self, robot):
        self.robot = robot
        self.before = 0  # of the odometry, to be added to the frame
        self.inner = [0] * 8  # what the calls made from each open call took
        self.depth = 0
        self.stage = REST  # of the decision, after the slice before
        avoid = robot.avoid
        self.wrap(robot, "step", self.after_step)
        self.wrap(robot.odometry, "advance", self.after_advance)
        self.wrap(robot.lidar, "poll", self.after_poll)
        self.wrap(avoid, "frame", self.after_place)
        self.wrap(avoid, "guard", self.after_guard)
        self.wrap(avoid, "step", self.after_work, "work")
        self.wrap(robot.drive, "command", self.after_command)
        self.wrap(robot.drive, "update", self.after_update)
        self.wrap(robot.drive, "stop", self.after_stop)

    def wrap(self, part, name, after, kind=None):
        function = getattr(part, name)

        def call(*arguments):
            self.depth += 1
            self.inner[self.depth] = 0
            self.begin()
            began = lockstep.now
            out = function(*arguments)
            own = self.end(kind or name)
            self.depth -= 1
            self.inner[self.depth] += own + self.inner[self.depth + 1]
            after(own, out, lockstep.now - began)
            self.resume()
            return out

        setattr(part, name, call)

    def after_step(self, value, out, waited):
        if out:
            log.write(TURN, value, value + self.inner[self.depth + 1])

    def after_advance(self, value, out, waited):
        self.before = value

    def after_poll(self, value, out, waited):
        if out:
            log.write(POLL, value + self.before, lockstep.now - lockstep.last_byte_us)
            self.before = 0

    def after_place(self, value, out, waited):
        log.write(PLACE, value, 0)

    def after_guard(self, value, out, waited):
        # A robot whose motors are off already, though it may still roll, has nothing to answer with.
        log.write(GUARD, value, 1 if out is True and self.robot.drive.told_v256 else 0)

    def after_work(self, value, out, waited):
        avoid = self.robot.avoid
        # Going on with a plan that still holds costs next to nothing: it is no decision to compare.
        goes_on = out and self.stage == REST
        self.stage = avoid.decision.stage
        log.write(WORK, value, 2 if goes_on else 1 if out else 0)
        if out:
            inside = 0
            for i in range(avoid.points_count):
                if avoid.points_window[i]:
                    inside += 1
            log.write(POINTS, avoid.points_count, inside)
            self.decided(avoid, not goes_on)

    def after_command(self, value, out, waited):
        log.write(COMMAND, value, 0)

    def after_update(self, value, out, waited):
        if waited or out:
            log.write(UPDATE, value, waited)

    def after_stop(self, value, out, waited):
        if waited:
            log.write(STOP, value, waited)

    def decided(self, avoid, in_full):
        pass


class Stopwatch(Watch):
    """Microseconds here. clock: the interpreter's own time module; of `decisions` the papers' iteration makes `paper_count` too, and as many of
    the `full` ones made in full, of which the plain swept test makes `plain_count`, spread evenly."""

    def __init__(self, robot, clock, decisions, full, paper_count, plain_count):
        import paper
        import plain

        # What the start has let go of is loaded again: the table of a module that stays holds no more names than the loop asks for.
        for name in [name for name in sys.modules if name.startswith("params.")]:
            sys.modules.pop(name)
        from params.config import Config
        from params.parse import load

        config = Config(load("robot.json"))  # the running robot keeps only what its loop asks for
        iteration = paper.Planner(config)
        # Of what the baseline makes again: of how many, how many, and which it is now.
        self.baselines = (
            (PAPER, iteration, False, decisions, paper_count, [0]),
            (PAPER_FULL, iteration, True, full, paper_count, [0]),
            (PLAIN, plain.Planner(config, robot.avoid.candidates), True, full, plain_count, [0]),
        )
        self.clock = clock
        self.now = clock.ticks_us
        self.began = [0] * 8
        super().__init__(robot)

    def begin(self):
        self.began[self.depth] = self.now()

    def end(self, name):
        return self.clock.ticks_diff(self.now(), self.began[self.depth]) - self.inner[self.depth]

    def resume(self):
        pass

    def decided(self, avoid, in_full):
        # Now and then the decision is made by the baselines as well; the time that takes is nobody's.
        made = None  # one decision may be among all that are compared and among those in full: the iteration makes it once
        for kind, planner, full_only, of, times, count in self.baselines:
            if of == 0 or (full_only and not in_full):
                continue
            count[0] += 1
            if count[0] * times // of == (count[0] - 1) * times // of:
                continue
            if planner is not made:
                made = planner
                took = self.again(planner, avoid)
            log.write(kind, took, avoid.points_count)

    def again(self, planner, avoid):
        """What the planner takes for the points of this decision."""
        xs = [avoid.points_x[i] - 8192 for i in range(avoid.points_count)]
        ys = [avoid.points_y[i] - 8192 for i in range(avoid.points_count)]
        gc.collect()
        gc.enable()  # they make objects of every float
        began = self.now()
        planner.decide(xs, ys)
        took = self.clock.ticks_diff(self.now(), began)
        gc.disable()
        gc.collect()
        return took


class Counter(Watch):
    """Instructions on the ESP32, from the counters of the firmware's blocks. costs: file of what each block costs, i32 each."""

    def __init__(self, robot, costs):
        from counters import COUNTERS

        with open(costs, "rb") as file:
            self.costs = array("i", file.read())
        self.size = len(self.costs)
        self.own = [0] * 8
        self.counters = COUNTERS
        self.worst = [0] * KINDS
        self.worst_counters = [array("i", bytes(4 * self.size)) for _ in range(KINDS)]
        self.kinds = {
            "poll": POLL,
            "frame": PLACE,
            "guard": GUARD,
            "work": WORK,
            "command": COMMAND,
            "update": UPDATE,
            "advance": FEED,
            "step": TURN,
            "stop": STOP,
        }
        super().__init__(robot)
        log.write(START, sum_counters(COUNTERS, self.costs, self.size), 0)  # all that came before the loop

    def begin(self):
        """What has been counted since the enclosing call began or went on is its own."""
        self.own[self.depth - 1] += sum_counters(self.counters, self.costs, self.size)
        self.own[self.depth] = 0
        clear_counters(self.counters, self.size)

    def end(self, name):
        last = sum_counters(self.counters, self.costs, self.size)
        kind = self.kinds[name]
        if last > self.worst[kind]:
            self.worst[kind] = last
            target = self.worst_counters[kind]
            for i in range(self.size):
                target[i] = self.counters[i]
        return self.own[self.depth] + last

    def resume(self):
        clear_counters(self.counters, self.size)
