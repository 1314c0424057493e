"""Faults of wheels and body: the motors do as they are told, and the robot does not."""

from math import cos, hypot, sin

import numpy as np

from .base import Fault, named

_LEASH = 100.0  # mm
_PUSH = 150.0  # mm/s
_PUSH_S = 1.0
_BACK_S = 3.0  # it may try once to back out


@named("slip", "all wheels turn on the spot", within_ms=1500, again_s=_BACK_S, wheels=slice(None), share=0.0)
@named("slip-half", "all wheels slip: the robot goes at half the speed", within_ms=1500, again_s=_BACK_S, wheels=slice(None), share=0.5)
@named("side-dead", "the motors on the left get no current", within_ms=1500, again_s=_BACK_S, wheels=slice(0, None, 2), share=0.0)
@named("motor-dead", "one motor in front gets no current", wheels=slice(1, 2), share=0.0)
@named("reversed", "all motors turn the wrong way", within_ms=1500, again_s=_BACK_S, wheels=slice(None), share=-1.0)
class Grip(Fault):
    def __init__(self, wheels, share):
        self._wheels, self._share = wheels, share

    def begin(self, simulation):
        gain = simulation.body.gain.copy()
        gain[self._wheels] *= self._share
        simulation.body.set_gain(gain)


@named("servos-dead", "the four servos in front stay where they are", within_ms=1500, again_s=_BACK_S, wheels=4)
@named("servo-dead", "one servo in front stays where it is", wheels=1)
class Servos(Fault):
    def __init__(self, wheels):
        self._wheels = wheels

    def begin(self, simulation):
        simulation.body.stuck[: self._wheels] = True


@named("held", "something holds the robot: it gets 100 mm farther, and no more", within_ms=1500, again_s=_BACK_S)
class Held(Fault):
    def begin(self, simulation):
        body = simulation.body
        self._place = body.x, body.y
        self._keep(body)

    def go_on(self, simulation):
        body = simulation.body
        if hypot(body.x - self._place[0], body.y - self._place[1]) > _LEASH:
            body.put_back(self._count, self._pose)
        self._keep(body)

    def _keep(self, body):
        self._count = body.count
        self._pose = body.x, body.y, body.heading


@named("pushed", "somebody pushes the robot back for a second, 150 mm in all")
class Pushed(Fault):
    def begin(self, simulation):
        self._until = simulation.now + _PUSH_S * 1e6
        self._last = simulation.now

    def go_on(self, simulation):
        body = simulation.body
        way = _PUSH * (min(simulation.now, self._until) - self._last) / 1e6
        self._last = min(simulation.now, self._until)
        body.x -= way * sin(body.heading)
        body.y -= way * cos(body.heading)


@named("turned", "somebody turns the robot by 20 degrees at once")
class Turned(Fault):
    def begin(self, simulation):
        simulation.body.heading += np.radians(20)
