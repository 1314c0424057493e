"""The closed loop: firmware, electronics, body, world and lidar, in lockstep."""

from dataclasses import dataclass

import numpy as np

from . import process
from .body import Body
from .delta2b import DELAY_US, Delta2B
from .electronics import Electronics
from .line import Line
from .world import World

STEP_US = 10_000.0  # longest step without a look at the walls
CLOSE = 60.0  # mm; nearer than this every step looks
TOUCH = 12.0  # mm; a deeper overlap blocks
RELEASE = 2.0  # mm; a contact is over when the body is so far away
LIMIT_US = 60e6
STUCK_US = 10e6  # blocked so long without getting `STUCK` mm away ends the run
STUCK = 30.0
ROOM = process.REPLY - process.PAYLOAD
CHUNKS = 4

PASS, LOCAL_COLLISION, BLOCKED, TIMEOUT = "pass", "local_collision", "blocked", "timeout"


@dataclass(frozen=True)
class Decision:
    """What the firmware decided, as read out of it. Angles in 0.1 deg, free and block in mm."""

    time_us: int
    number: int
    af: int
    ar: int
    v: int
    mode: int
    window: int
    zone: int
    free: int
    block_x: int
    block_y: int
    why: int


class Simulation:
    """One run.

    course: Course. vehicle: Vehicle. seed: of the imperfections; other than 0 it perturbs the start as well. watch: Watch.

    result: None until the run is over, then one of PASS, LOCAL_COLLISION, BLOCKED, TIMEOUT; reason: why, when there is more to say.
    """

    def __init__(self, course, vehicle, seed, watch, version=1):
        streams = np.random.SeedSequence([seed, 0x67]).spawn(3)
        start, robot, noise = (np.random.default_rng(stream) for stream in streams)
        self.course = course
        self._vehicle = vehicle
        self._watch = watch
        self._half = vehicle.width / 2, vehicle.length / 2
        self._world = World(course.segments)
        self.body = Body(vehicle, robot, perturbed(course.start, start) if seed else course.start)
        self.lidar = Delta2B(vehicle.lidar, self._world, noise, version)
        self.electronics = Electronics(vehicle, self.body, self.lidar)
        self._line = Line()
        self.decisions = []
        self.overflows = 0
        self.result = None
        self.reason = ""
        self.contacts = 0
        self.touches = []  # (time us, x, y, heading) at which a contact began
        self._touching = False
        self._checked = 0.0, 1, course.start
        self._blocked_at = None  # (time, x, y) of the first refusal in this place
        self.clearance = self.min_clearance = float("inf")
        self._look()

    @property
    def now(self):
        """Simulated time, us."""
        return self.body.now

    def serve(self, request):
        """Let the events and the time of a request happen; returns what `Process.answer` wants."""
        electronics = self.electronics
        self._decide(request)
        self.overflows = request.overflows
        for time, kind, where, value, data in request.events:
            self._move(time)
            if kind == process.I2C_WRITE:
                electronics.i2c_write(time, where, data)
                self._watch.registers(time, where, data)
            elif kind == process.PIN:
                electronics.pin(time, where, value)
            elif kind == process.PWM_DUTY:
                electronics.pwm(time, where, value / 65535)
            elif kind == process.UART_OUTPUT:
                self._watch.uart(time, where, data)
        self._move(request.target)
        inputs = electronics.levels, electronics.addresses, electronics.battery_reading
        if request.kind == process.READ:
            return 0, *inputs, (), electronics.i2c_read(request.address, request.size)
        if request.kind == process.RESET:
            self._end(BLOCKED, "the firmware reset the board")
        if request.kind != process.ADVANCE:
            return 0, *inputs
        batches = self._line.take(request.target, CHUNKS, ROOM)
        rx = self._vehicle.lidar.rx
        for time, data in batches:
            self._watch.lidar(time, data)
        return self._horizon(), *inputs, [(time, data, rx) for time, data in batches]

    def stop(self, reason):
        """End the run from outside."""
        self._end(BLOCKED, reason)

    def _horizon(self):
        """Time before which nothing more arrives."""
        first = self._line.first_arrival()
        return int(self.lidar.due + DELAY_US) if first is None else first

    def _decide(self, request):
        probe = request.probe
        if probe[0] and (not self.decisions or self.decisions[-1].number != probe[0]):
            self.decisions.append(Decision(request.now, *probe))
            self._watch.decision(self.decisions[-1])

    def _move(self, time):
        """Let the body and the lidar go on to the time, us."""
        body, electronics, lidar = self.body, self.electronics, self.lidar
        while body.now < time and self.result is None:
            end = min(time, electronics.latch, lidar.due, body.now + STEP_US)
            if end > body.now:
                body.advance(end)
            if self.clearance < CLOSE or body.now - self._checked[0] >= STEP_US:
                self._look()
            if end == electronics.latch:
                electronics.take_pulses()
            if end == lidar.due:
                self._line.send(end + DELAY_US, lidar.take(body.poses_at))

    def _look(self):
        """Contact with the walls, the goal, the limits."""
        body = self.body
        checked, count, pose = self._checked
        now_pose = body.x, body.y, body.heading
        if now_pose != pose or not body.now:
            clearance, _ = self._world.clearance(*now_pose, *self._half)
            if clearance < -TOUCH and clearance < self.clearance - 1e-9:
                body.put_back(count, pose)
                self._refused()
            else:
                self.clearance = clearance
                self._touch(clearance)
        self._checked = body.now, body.count, (body.x, body.y, body.heading)
        if self.course.through(body.x, body.y):
            self._end(LOCAL_COLLISION if self.contacts else PASS)
        elif body.now >= LIMIT_US:
            self._end(BLOCKED if self._blocked_at else TIMEOUT, "60 s are over")

    def _touch(self, clearance):
        self.min_clearance = min(self.min_clearance, clearance)
        if clearance <= 0 and not self._touching:
            self._touching = True
            self.contacts += 1
            self.touches.append((self.body.now, self.body.x, self.body.y, self.body.heading))
        elif clearance > RELEASE:
            self._touching = False

    def _refused(self):
        body = self.body
        if self._blocked_at is None or np.hypot(body.x - self._blocked_at[1], body.y - self._blocked_at[2]) > STUCK:
            self._blocked_at = body.now, body.x, body.y
        elif body.now - self._blocked_at[0] > STUCK_US:
            self._end(BLOCKED, "held by a wall for 10 s")

    def _end(self, result, reason=""):
        if self.result is None:
            self.result, self.reason = result, reason


class Watch:
    """Told what happens; the base class ignores it all. Times in us."""

    def lidar(self, time, data):
        """Bytes from the lidar, the first of which arrives at the time."""

    def registers(self, time, address, data):
        """An I2C write that ended at the time."""

    def decision(self, decision):
        """The firmware has a new decision."""

    def commands(self):
        """Bytes to send on the board's USB serial line now."""
        return b""

    def uart(self, time, gpio, data):
        """The firmware sent bytes on a UART."""

    def serial(self, data):
        """The firmware printed bytes on the USB serial line."""

    def step(self, simulation):
        """Called after each exchange with the firmware."""


def perturbed(start, random):
    """A start pose up to 40 mm and 5 degrees off."""
    x, y, heading = start
    dx, dy = random.uniform(-40, 40, 2)
    return x + dx, y + dy, heading + np.radians(random.uniform(-5, 5))
