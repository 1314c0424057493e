"""The closed loop: firmware, electronics, body, world and lidar, in lockstep."""

import numpy as np

from host.recording import Decision

from . import wire
from .body import Body
from .contact import Contact
from .delta2b import DELAY_US, Delta2B
from .electronics import Electronics
from .faults import Fault
from .line import Line
from .scene import Encounters, Scene
from .world import World

STEP_US = 10_000.0
LIMIT_US = 60e6
SCREEN_US = 15_000  # without a lidar that turns the firmware stops so often for its screen
STUCK_US = 10e6  # held by a wall for so long: the run is over
ROOM = wire.REPLY - wire.PAYLOAD

PASS, LOCAL_COLLISION, BLOCKED, TIMEOUT = "pass", "local_collision", "blocked", "timeout"


class Simulation:
    """One run.

    course: Course. vehicle: Vehicle. seed: of the imperfections; other than 0 it perturbs the start as well. watch: Observer. fault: what
    fails, see `faults`. arm: arm.Arm or None.

    now: simulated time, us. limit: when the run has failed, us; an Observer may put it off. endless: while true the run does not end by itself; an
    Observer sets it while a person drives.
    body, lidar, electronics, contact, scene, met: the parts; an Observer may change what they hold, to see what the firmware does.
    result: None until the run is over, then one of PASS, LOCAL_COLLISION, BLOCKED, TIMEOUT; reason: why, when there is more to say.
    """

    def __init__(self, course, vehicle, seed, watch, version=1, fault=None, arm=None):
        streams = np.random.SeedSequence([seed, 0x67]).spawn(3)
        start, robot, noise = (np.random.default_rng(stream) for stream in streams)
        self.course = course
        self.vehicle = vehicle
        self.fault = fault or Fault()
        self._lidar_wire = vehicle.lidar.rx, vehicle.lidar.baud
        self._watch = watch
        self.limit = self.limit_us = course.limit_s * 1e6 or LIMIT_US
        self.endless = False
        self.scene = Scene(course)
        self.body = Body(vehicle, robot, perturbed(course.start, start) if seed else course.start)
        self.lidar = Delta2B(vehicle.lidar, self.scene, noise, version)
        self.electronics = Electronics(vehicle, self.body, self.lidar, arm)
        self.contact = Contact(self.scene.walls, self.body, vehicle.width / 2, vehicle.length / 2)
        self.met = Encounters(self.scene, self.body, vehicle.width / 2, vehicle.length / 2)
        self.now = 0
        self._line = Line(vehicle.lidar.baud)
        self.screen = None if vehicle.screen is None else _screen(vehicle.screen)
        self.decisions = []
        self.overflows = 0
        self.result = None
        self.reason = ""

    def serve(self, request):
        """Let the events and the time of a request happen; returns what `Process.answer` wants."""
        electronics = self.electronics
        self._decide(request)
        self.overflows = request.overflows
        for time, kind, where, value, data in request.events:
            self._move(time)
            if kind == wire.I2C_WRITE:
                electronics.i2c_write(time, where, data)
                self._watch.registers(time, where, data)
            elif kind == wire.PIN:
                electronics.pin(time, where, value)
                self.fault.pin(time, where, value)
            elif kind == wire.PWM_DUTY:
                electronics.pwm(time, where, value / 65535)
            elif kind == wire.UART_OUTPUT:
                self._watch.uart(time, where, data)
                if self.screen is not None and where == self.vehicle.screen.tx:
                    self.screen.receive(time, data)
        self._run_up_to(request.target)
        self.now = request.target
        self.fault.look(self)
        inputs = electronics.levels | self.fault.levels, electronics.addresses, electronics.battery_reading
        if request.kind == wire.READ:
            data = electronics.i2c_read(request.address, request.size)
            self._watch.read(request.now, request.address, data)
            return 0, *inputs, (), data
        if request.kind == wire.RESET:
            self._watch.reset(request.now, request.address)
            electronics.release_pins(request.now)
        if request.kind != wire.ADVANCE:
            return 0, *inputs
        batches = self._line.take(request.target, wire.CHUNKS, ROOM)
        line = self._lidar_wire
        for time, data in batches:
            self._watch.lidar(time, data)
        pieces = [(time, data, *line) for time, data in batches]
        return self._horizon(), *inputs, pieces + self._from_screen(request, pieces)

    def stop(self, result, reason):
        """End the run from outside."""
        self._end(result, reason)

    def go_on(self, time):
        """Let the world go on to the time, us, without the firmware: the chips do what they were told last."""
        self._run_up_to(time)

    def put_box(self, x, y, size):
        """A square box, `size` mm, about a place; only one, and none with a size of 0. ValueError where the robot stands."""
        sides = np.zeros((0, 4))
        if size:
            h = size / 2
            corners = np.array([[x - h, y - h], [x + h, y - h], [x + h, y + h], [x - h, y + h]], float)
            sides = np.hstack([corners, np.roll(corners, -1, axis=0)])
            body = self.body
            if World(sides).clearance(body.x, body.y, body.heading, self.vehicle.width / 2, self.vehicle.length / 2)[0] <= 0:
                raise ValueError("there stands the robot: a box goes beside it")
        self.scene.walls.put(np.vstack([self.course.segments, sides]))
        self.contact.walls_moved()

    def _from_screen(self, request, pieces):
        """What the screen has sent by then, beside the lidar's pieces: it arrives when the firmware stops for the lidar anyway, or it would stop in the middle of a frame."""
        screen = self.screen
        if screen is None or self.vehicle.screen.rx is None or request.target == request.now:
            return []
        found = screen.line.take(request.target, wire.CHUNKS - len(pieces), ROOM - sum(len(piece[1]) for piece in pieces))
        found = [(max(time, request.now + 1), data) for time, data in found]
        for time, data in found:
            self._watch.screen(time, data)
        return [(time, data, self.vehicle.screen.rx, screen.baud) for time, data in found]

    def _horizon(self):
        """Time before which nothing more arrives."""
        first = self._line.first_arrival()
        first = int(self.lidar.due + DELAY_US) if first is None else first
        wake = self.fault.wake
        first = int(wake) if self.now < wake < first else first
        return first if self.screen is None else min(first, self.now + SCREEN_US)

    def _decide(self, request):
        probe = request.probe
        if probe[0] and (not self.decisions or self.decisions[-1].number != probe[0]):
            self.decisions.append(Decision._make((*probe, request.now)))
            self._watch.decision(self.decisions[-1])

    def _move(self, time):
        """Let the body go on to the time, us, and the lidar with it."""
        while self.body.now < time and self.result is None:
            self._step(min(time, self._next()))

    def _run_up_to(self, time):
        """As far as something happens by the time; what is left of it waits for the next event, and saves a step."""
        while self._next() <= time and self.result is None:
            self._step(self._next())

    def _next(self):
        """Time of the next thing to happen by itself, us."""
        return min(self.electronics.latch, self.lidar.due, self.body.now + STEP_US)

    def _step(self, end):
        body, contact = self.body, self.contact
        span = end - body.now
        if span > 0:
            body.advance(end)
            contact.follow(span)
            self.scene.at(end)
            self.met.look()
        if end == self.electronics.latch:
            self.electronics.take_pulses()
        if end == self.lidar.due:
            data = self.fault.frame(end, self.lidar.take(body.poses_at))
            if data and not self.lidar.unplugged:
                self._line.send(end + DELAY_US, data)
        if self.endless:
            return
        if self.course.through(body.x, body.y):
            self._end(LOCAL_COLLISION if contact.touches or self.met.touches else PASS)
        elif contact.held_us > STUCK_US:
            self._end(BLOCKED, "held by a wall for 10 s")
        elif end >= self.limit:
            held = contact.refused is not None and end - contact.refused < STUCK_US
            self._end(BLOCKED if held else TIMEOUT, f"{self.limit_us / 1e6:g} s are over")

    def _end(self, result, reason=""):
        if self.result is None:
            self.result, self.reason = result, reason


class Observer:
    """Told what happens; the base class ignores it all. Times in us."""

    def board(self, folder):
        """The board is there; its files, robot.json among them, lie in the folder until the run is over."""

    def lidar(self, time, data):
        """Bytes from the lidar, the first of which arrives at the time."""

    def registers(self, time, address, data):
        """An I2C write that ended at the time."""

    def read(self, time, address, data):
        """An I2C read that ended at the time."""

    def decision(self, decision):
        """The firmware has a new decision."""

    def commands(self):
        """Bytes to send on the board's USB serial line now."""
        return b""

    def command(self, data):
        """Bytes are being sent on the board's USB serial line."""

    def uart(self, time, gpio, data):
        """The firmware sent bytes on a UART."""

    def screen(self, time, data):
        """Bytes from the screen, the first of which arrives at the time."""

    def reset(self, time, cause):
        """The board resets itself; cause as machine.reset_cause() gives it afterwards."""

    def serial(self, data):
        """The firmware printed bytes on the USB serial line."""

    def step(self, simulation):
        """Called after each exchange with the firmware."""


def _screen(panel):
    from .screen import Screen  # what paints takes its time to load

    return Screen(panel.kind, panel.baud)


def perturbed(start, random):
    """A start pose up to 40 mm and 5 degrees off."""
    x, y, heading = start
    dx, dy = random.uniform(-40, 40, 2)
    return x + dx, y + dy, heading + np.radians(random.uniform(-5, 5))
