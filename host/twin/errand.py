"""Sends the robot on its errand through a house over its own serial line, and notes what comes of it."""

import struct
from math import hypot, pi

import numpy as np

from host import compat

from .simulation import LOCAL_COLLISION, PASS, Observer
from .world import World

compat.install()
from link import frames, protocol  # noqa: E402

ALARM, LOST, MISSED = "alarm", "lost", "missed"
ALARMS = (None, "door shut", "goal walled in", "no progress")
REACHED = 300.0  # mm: so near to its goal it has reached it
AT_DOOR = 600.0
LOOK_US = 100_000.0
WAIT_US = 1_000_000.0  # it is seen to stand for so long after an alarm
STATES = ("none", "going", "there", "alarm", "searching", "lost")
METHODS = ("gap", "field", "behaviour")
GIVE_UP, THERE, LATER, HERE, ON, PATROL, METHOD, SEARCH = range(8)  # of GO


class Errand(Observer):
    """house: house.House; plan: house.Plan. facts() gives the figures of --json."""

    def __init__(self, house, plan):
        self.house, self._plan = house, plan
        self._frames = frames.FrameReader()
        self._out = b""
        self._counter = 1000
        self._begun = False
        self._goal = None  # the latest message
        self._errors, self._door_errors = [], []
        self._closing = World(house.closing) if len(house.closing) else None
        self._next_look = 0.0
        self._last = None
        self._over = None
        self._went_on = False
        self.path = 0.0
        self.seen = self.alarm_at = self.set_out = self.found_at = None
        self.alarm = None
        self.alarms = []
        self.track = []  # s, x, y as the robot believes it, mm
        self.steer = []  # s, x, y
        self.confident_wrong = 0.0
        self.ends = []

    def serial(self, data):
        for kind, _, payload in self._frames.read(data):
            if kind == protocol.GOAL:
                _, *told = struct.unpack(protocol.GOAL_FORMAT, payload)
                self._goal = {
                    "state": STATES[told[0]], "alarm": ALARMS[told[1]], "method": METHODS[told[2]], "known": told[3] == 2, "x": told[4], "y": told[5],
                    "steer": told[11:13], "searches": told[18],
                }  # fmt: skip

    def commands(self):
        out, self._out = self._out, b""
        return out

    def _send(self, what, x=0.0, y=0.0, heading=0.0):
        self._counter += 1
        payload = struct.pack(protocol.GO_FORMAT, self._counter, what, round(x), round(y), round((heading + 180) % 360 * 10) - 1800)
        self._out += frames.frame(protocol.GO, payload, self._counter & 0xFFFF)

    def step(self, simulation):
        body = simulation.body
        self._travel(body)
        if simulation.now >= self._next_look:
            self._next_look = simulation.now + LOOK_US
            self._see(simulation)
        goal, self._goal = self._goal, None
        if goal is None or self._plan.by_hand and self._begun:
            return
        if not self._begun:
            self._begun = True
            self._begin()
            return
        self._note(simulation, goal)
        self._end(simulation, goal)

    def _begin(self):
        if self.house.told:
            self._send(HERE, *self.house.told)
        if self._plan.method:
            self._send(METHOD, METHODS.index(self._plan.method))
        if not self._plan.by_hand:
            self._send(THERE, *self.house.goal)

    def _travel(self, body):
        here = float(body.x), float(body.y)
        if self._last is None or hypot(here[0] - self._last[0], here[1] - self._last[1]) > 5:
            if self._last is not None:
                self.path += hypot(here[0] - self._last[0], here[1] - self._last[1])
            self._last = here

    def _see(self, simulation):
        if self._closing is None or self.seen is not None:
            return
        body = simulation.body
        bearings = np.linspace(0, 2 * pi, 720, endpoint=False)
        xs, ys = np.full(720, float(body.x)), np.full(720, float(body.y))
        there = self._closing.ranges(xs, ys, bearings)
        if (there <= simulation.scene.ranges(xs, ys, bearings) + 1).any() and there.min() < 8000:
            self.seen = simulation.now / 1e6

    def _note(self, simulation, goal):
        now = simulation.now / 1e6
        body = simulation.body
        error = hypot(goal["x"] - body.x, goal["y"] - body.y)
        if goal["known"] and goal["state"] in ("going", "there", "alarm"):
            if self.found_at is None:
                self.found_at = now
            if error > REACHED:
                self.confident_wrong = max(self.confident_wrong, error)
        if goal["state"] == "going":
            if self.set_out is None:
                self.set_out = now
            self._errors.append(error)
            if any(hypot(body.x - d.x, body.y - d.y) < AT_DOOR for d in self.house.house.doors):
                self._door_errors.append(error)
            self.track.append((now, goal["x"], goal["y"]))
            if any(goal["steer"]):
                self.steer.append((now, *goal["steer"]))
        self.last = goal

    def _end(self, simulation, goal):
        state = goal["state"]
        if state == "there":
            body = simulation.body
            near = hypot(self.house.goal[0] - body.x, self.house.goal[1] - body.y) <= REACHED
            touched = simulation.contact.touches or simulation.met.touches
            simulation.stop(MISSED if not near else LOCAL_COLLISION if touched else PASS, "" if near else "it believes to be at its goal, and is not")
        elif state == "lost":
            simulation.stop(LOST, "it does not know where it is")
        elif state == "alarm":
            if self._over is None:
                self.alarm, self.alarm_at = goal["alarm"], simulation.now / 1e6
                self.alarms.append((goal["alarm"], self.alarm_at))
                self._over = simulation.now + WAIT_US
            elif simulation.now >= self._over:
                plan = self._plan
                if plan.go_on and not self._went_on and plan.opens is not None:
                    if simulation.now / 1e6 > plan.opens + 3:
                        self._went_on = True
                        self._over = None
                        self.alarm = self.alarm_at = None
                        self._send(ON)
                else:
                    simulation.stop(LOCAL_COLLISION if simulation.contact.touches or simulation.met.touches else ALARM, goal["alarm"])
        elif self._over is not None:
            self._over = None

    def facts(self, simulation):
        """What --json adds."""
        body = simulation.body
        last = getattr(self, "last", None) or {"searches": 0}

        def root(errors):
            return round(float(np.sqrt(np.mean(np.square(errors)))), 1) if errors else None

        return {
            "path_mm": round(self.path), "goal_error_mm": round(hypot(self.house.goal[0] - body.x, self.house.goal[1] - body.y)),
            "alarm": self.alarm, "alarm_at_s": self.alarm_at and round(self.alarm_at, 2), "seen_at_s": self.seen and round(self.seen, 2),
            "set_out_s": self.set_out and round(self.set_out, 2), "replans": max(last["searches"] - 1, 0), "pose_rms_mm": root(self._errors),
            "pose_max_mm": round(max(self._errors), 1) if self._errors else None,
            "pose_door_mm": round(max(self._door_errors), 1) if self._door_errors else None,
            "method": last.get("method"), "alarms": [[what, round(when, 2)] for what, when in self.alarms], "found_at_s": self.found_at and round(self.found_at, 2),
            "confident_wrong_mm": round(self.confident_wrong) or None,
        }  # fmt: skip
