"""Playing on a robot, or its twin, by its address: upload, go to where it begins, play, and say again and again that somebody is there."""

import json
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from host.link import connect
from host.link.base import Link

from . import board
from .errors import ArmError
from .model import Arm
from .reach import Reach

PIECE = 150  # bytes of a trajectory in one command
ALIVE_S = 0.1  # between two words of life; the arm freezes after 0.3 s without
_REPLY_S, _HELLO_S, _LONGEST_S = 5.0, 20.0, 180.0


class Player:
    """A Link, and what its arm is known to do. Every call waits; messages that are not the arm's go to `heed`."""

    def __init__(self, link: Link, heed: Callable[[dict], None] | None = None):
        self.link = link
        self.state: dict = {}
        self._heed = heed
        self._alive = 0.0
        self._fault: int | None = None

    def greeted(self) -> None:
        """Wait until the robot has said who it is. ArmError if it does not."""
        until = time.monotonic() + _HELLO_S
        while not self.link.robot:
            if time.monotonic() > until:
                raise ArmError("the robot does not answer: look at its address, power and cable")
            self._take(0.2)

    def ask(self, **command) -> str:
        """Send a command to the arm and wait for its reply, whose text is returned. ArmError if it was refused."""
        return self._reply(self.link.arm(**command))

    def upload(self, reach: Reach) -> int:
        """The number of bytes. ArmError if the board refuses them."""
        data = board.encode(reach)
        for at in range(0, len(data), PIECE):
            self._reply(self.link.reach(at, data[at : at + PIECE]))
        return len(data)

    def wake(self) -> None:
        """Wait for the arm's first state; where it has no power, switch it on, at its rest pose."""
        self._wait_for(lambda: bool(self.state), 3.0, "this robot's arm says nothing: is there an arm.json on its board?")
        self._wait_for(lambda: self._fault == 0, _HELLO_S, "the robot has a fault, or its stop button is pressed: the arm does not move (see the monitor)")
        if self.state["state"] == "off":
            self.go(what="home")

    def go(self, **command) -> str:
        """A movement, kept alive until it is over; the text of its reply. ArmError if it is refused or freezes; whatever ends the waiting holds the arm."""
        text = self.ask(**command)
        self.state = {}  # what it told before it began
        try:
            self._wait_for(lambda: self.state.get("state") == "holds", _LONGEST_S, "the arm is still moving")
        except BaseException:
            self.link.arm(what="hold")
            raise
        if self.state["why"] != "nothing":
            raise ArmError(f"the arm is frozen where it was: {self.state['why']}")
        return text

    def play(self) -> None:
        """What is on the board, from its beginning, where the arm goes first, slowly."""
        if self.go(what="play", approach=True):
            self.go(what="play")

    def _reply(self, counter: int) -> str:
        until = time.monotonic() + _REPLY_S
        while time.monotonic() < until:
            message = self._take(0.1)
            if message and message["type"] == "reply" and message["counter"] == counter:
                if message["status"] != "ok":
                    raise ArmError(message["text"])
                return message["text"]
        raise ArmError("the robot did not reply: is its link good?")

    def _wait_for(self, done: Callable[[], bool], limit_s: float, otherwise: str) -> None:
        until = time.monotonic() + limit_s
        while not done():
            if time.monotonic() > until:
                raise ArmError(otherwise)
            self._take(0.05)

    def _take(self, timeout: float) -> dict | None:
        now = time.monotonic()
        if self.state.get("state") in ("moves", "plays") or not self.state:
            if self.link.robot and now - self._alive > ALIVE_S:
                self._alive = now
                self.link.arm(what="go on")
        message = self.link.get(timeout=timeout)
        if message is None:
            return None
        if message["type"] == "arm":
            self.state = message
        elif message["type"] == "health":
            self._fault = message["fault"]
        elif message["type"] == "ended":
            raise ArmError(message["text"])
        if self._heed is not None:
            self._heed(message)
        return message


def with_arm(address: str, arm: Arm | None) -> str:
    """The address; that of a twin without an arm gets this one."""
    if address.startswith("twin:") and "arm=" not in address and arm is not None:
        place = Path(tempfile.gettempdir()) / f"gapseeker-arm-{board.ident(arm):04x}.json"
        place.write_text(json.dumps(arm.source))
        start = "" if "autostart=" in address else "&autostart=0"
        address += ("&" if "?" in address else "?") + f"arm={place}{start}"
    return address


def play(address: str, reach: Reach, say: Callable[[str], None]) -> None:
    """Upload a trajectory to the robot at an address and play it."""
    with connect(with_arm(address, reach.arm)) as link:
        player = Player(link)
        player.greeted()
        player.wake()
        say(f"uploaded: {player.upload(reach)} bytes")
        player.play()
        say("played")


def home(address: str, arm: Arm | None, say: Callable[[str], None]) -> None:
    """To the rest pose, slowly."""
    with connect(with_arm(address, arm)) as link:
        player = Player(link)
        player.greeted()
        player.wake()
        player.go(what="home")
        say("the arm is in its rest pose")
