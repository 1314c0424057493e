"""A trajectory played by the firmware in the twin, as fast as it goes, and how well its servos followed: registers in, angles out."""

import json
from collections import deque
from dataclasses import dataclass

import numpy as np

from host.link import messages
from host.twin import Observer, run
from link import frames, protocol

from . import board
from .errors import ArmError
from .play import PIECE
from .reach import Reach

_LIMIT_S = 60.0
_ALIVE_US = 100_000
_SAMPLE_US = 10_000
_TAIL_S = 0.3


@dataclass(frozen=True)
class Played:
    """times (T,) s from the start of playing; angles, wanted (T, servos) deg; set_points [(s, angles told)]; rms and worst: tracking error, deg; overloaded: joints."""

    times: np.ndarray
    angles: np.ndarray
    wanted: np.ndarray
    rms: float
    worst: float
    overloaded: tuple[int, ...]
    log: tuple[str, ...]


class Stage(Observer):
    """The person at the robot: wakes the arm, uploads, lets it go to where the trajectory begins, plays, keeps it alive."""

    def __init__(self, reach: Reach):
        self._data = board.encode(reach)
        self._stream = frames.FrameReader()
        self._out: deque[bytes] = deque()
        self._counter = 0
        self._alive = 0.0
        self._now = 0.0
        self._fault: int | None = None
        self._state: dict = {}
        self._step = self._wait
        self._waits_for: int | None = None
        self._reply = ""
        self.done_us: float | None = None
        self.began_us: float | None = None
        self.samples: list[tuple[float, np.ndarray]] = []
        self.log: list[str] = []
        self.failed = ""
        self.overloaded: tuple[int, ...] = ()

    def serial(self, data):
        for kind, _, payload in self._stream.read(data):
            message = messages.decode(kind, payload)
            if message is None:
                continue
            if message["type"] == "health":
                self._fault = message["fault"]
            elif message["type"] == "arm":
                self._state = message
            elif message["type"] == "log":
                self.log.append(message["text"])
            elif message["type"] == "reply" and message["counter"] == self._waits_for:
                self._waits_for = None
                self._reply = message["text"]
                if message["status"] != "ok":
                    self.failed = message["text"]

    def commands(self):
        if self._now - self._alive > _ALIVE_US and self._counter:
            self._alive = self._now
            self._tell(protocol.ARM, lambda counter: messages.arm(counter, "go on"))
        out = b"".join(self._out)
        self._out.clear()
        return out

    def step(self, simulation):
        self._now = simulation.now
        arm = simulation.electronics.arm
        arm.advance(self._now)
        if not self.samples or self._now - self.samples[-1][0] >= _SAMPLE_US:
            self.samples.append((self._now, arm.angles.copy()))
        self.overloaded = tuple(sorted(arm.overloaded))
        if self.failed or self.done_us is not None and self._now - self.done_us > _TAIL_S * 1e6:
            simulation.stop("pass", "")
        elif self._waits_for is None:
            self._step()

    def _tell(self, kind, payload, wait=False):
        self._counter += 1
        self._out.append(frames.frame(kind, payload(self._counter), self._counter & 0xFFFF))
        if wait:
            self._waits_for = self._counter
            self._state = {}

    def _arm(self, what, then, **more):
        self._tell(protocol.ARM, lambda counter: messages.arm(counter, what, **more), wait=True)
        self._step = then

    # What is done, one thing after the other; each is called again until it sets the next.

    def _wait(self):
        if self._fault == 0 and self._state:
            self._arm("home", self._woken)

    def _woken(self):
        if self._state.get("state") == "holds":
            self._at = 0
            self._step = self._upload

    def _upload(self):
        if self._at >= len(self._data):
            self._arm("play", self._approached, approach=True)
            return
        at, self._at = self._at, self._at + PIECE
        self._tell(protocol.REACH, lambda counter: messages.reach(counter, at, self._data[at : at + PIECE]), wait=True)

    def _approached(self):
        if self._reply and self._state.get("state") == "holds":
            self._arm("play", self._begun)
        elif not self._reply:
            self._begun()

    def _begun(self):
        self.began_us = self._now
        self._step = self._plays

    def _plays(self):
        if self._state.get("state") == "holds" and self.done_us is None:
            if self._state["why"] != "nothing":
                self.failed = f"the arm froze: {self._state['why']}"
            self.done_us = self._now


def rehearse(reach: Reach, engine: str = "micropython", **more) -> Played:
    """Play it in the twin. ArmError if the board refuses it or the arm freezes. more: of host.twin.run."""
    stage = Stage(reach)
    source = json.loads(json.dumps(reach.arm.source))
    changes = {"drive.autostart": False} | more.pop("changes", {})
    run("Z", width=550, changes=changes, engine=engine, watch=stage, arm=source, limit_s=_LIMIT_S + reach.total, record=False, **more)
    if stage.failed or stage.began_us is None or stage.done_us is None:
        raise ArmError(stage.failed or "the twin came to no end: " + "; ".join(stage.log[-3:]))
    times = (np.array([when for when, _ in stage.samples]) - stage.began_us) / 1e6
    angles = np.array([angles for _, angles in stage.samples])
    during = (times >= 0) & (times <= reach.total)
    times, angles = times[during], angles[during]
    q, _, _ = reach.at(times)
    wanted = np.hstack([np.degrees(q), reach.extra_at(times)])
    error = angles - wanted
    rms = float(np.sqrt((error**2).mean(axis=0)).max())
    return Played(times, angles, wanted, rms, float(np.abs(error).max()), stage.overloaded, tuple(stage.log))
