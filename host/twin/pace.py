"""How fast a run goes: faster or slower than real time, standing still, or a decision at a time; may be changed while it runs."""

import threading
import time

_LOOK_S = 0.05  # how often a run that stands still is asked whether it shall go on


class Pace:
    """speed: factor on real time, None = as fast as possible. All methods may be called from any thread.

    paused: it stands still in time; the robot's clock stands too, and nothing of the run is lost by it.
    """

    def __init__(self, speed: float | None = None):
        self._speed = speed
        self._began: tuple[float, float] | None = None  # real time, s, and the run's, us, from which both are counted
        self._going = threading.Event()
        self._going.set()
        self._stepping = False

    @property
    def speed(self) -> float | None:
        return self._speed

    @speed.setter
    def speed(self, speed: float | None) -> None:
        self._speed = speed
        self._began = None

    @property
    def paused(self) -> bool:
        return not self._going.is_set()

    def pause(self) -> None:
        self._going.clear()

    def go_on(self) -> None:
        self._stepping = False
        self._began = None
        self._going.set()

    def step(self) -> None:
        """Go on until the next decision has been made and told (`decided`), then stand still."""
        self._began = None
        self._stepping = True
        self._going.set()

    def decided(self) -> None:
        """A decision has been told."""
        if self._stepping:
            self._stepping = False
            self._going.clear()

    def wait(self, now_us: float) -> bool:
        """Wait until the run may be at this time; False while it stands still: ask again then."""
        if not self._going.is_set() and not self._going.wait(_LOOK_S):
            return False
        speed = self._speed
        began = self._began
        if began is None:
            began = self._began = time.monotonic(), now_us
        if speed:
            ahead = (now_us - began[1]) / 1e6 / speed - (time.monotonic() - began[0])
            if ahead > 0:
                time.sleep(ahead)
        return True
