"""A recording as a link: plays what was received, as fast or slow as wanted, from wherever wanted."""

import bisect
import threading
import time

from host import recording
from link import frames

from . import messages
from .address import AddressError, parse
from .base import Link, LinkError

STATE = ("hello", "names", "world", "health", "scan", "candidates", "points", "wheels", "pose", "truth", "playback")
HISTORY_S = 20.0  # of decisions, told again after a jump, for the charts
_TICK_S = 0.04
_TELL_S = 0.2


class PlaybackLink(Link):
    """file:PATH. Takes no commands; plays at once. Raises LinkError if the file is no recording.

    story: [(s, message)], all of it. length: seconds. position: where it is. playing, rate: may be set at any time.
    """

    commands = False

    def __init__(self, address: str, path: str):
        super().__init__(address)
        try:
            reader = recording.Reader(path)
            self.story = sorted(story(reader), key=lambda entry: entry[0])
        except recording.RecordingError as error:
            raise LinkError(str(error)) from None
        self._times = [moment for moment, _ in self.story]
        self.length = self._times[-1] if self._times else 0.0
        self.position = 0.0
        self.playing = True
        self.rate = 1.0
        self._cut = reader.cut
        for text in reader.damage:
            self._put({"type": "text", "text": text})
        self._open = True
        self._moves = threading.Lock()
        self._next = 0
        threading.Thread(target=self._play, daemon=True).start()

    def seek(self, position: float) -> None:
        """Go to this many seconds from the start: tells the state there, and the decisions that led to it."""
        with self._moves:
            self.position = min(max(position, 0.0), self.length)
            self._next = bisect.bisect_right(self._times, self.position)
            latest = {}
            recent = []
            for moment, message in self.story[: self._next]:
                latest[message["type"]] = message
                if message["type"] == "decision" and moment >= self.position - HISTORY_S:
                    recent.append(message)
            self._put({"type": "jump"})
            for kind in STATE:
                if kind in latest:
                    self._put(latest[kind])
            for message in recent:
                self._put(message)
            self._tell()

    def close(self) -> None:
        self._open = False

    def _send(self, data: bytes) -> None:
        """A recording does what it did."""

    def _play(self) -> None:
        last = time.monotonic()
        told = 0.0
        while self._open:
            now = time.monotonic()
            with self._moves:
                if self.playing:
                    self.position = min(self.position + (now - last) * self.rate, self.length)
                    while self._next < len(self.story) and self._times[self._next] <= self.position:
                        self._put(self.story[self._next][1])
                        self._next += 1
                    if self._next == len(self.story):
                        self.playing = False
                        if self._cut:
                            self._put({"type": "text", "text": f"{self._cut}; this is all there is"})
                        self._tell()
                if now - told >= _TELL_S:
                    told = now
                    self._tell()
            last = now
            time.sleep(_TICK_S)

    def _tell(self) -> None:
        self._put({"type": "playback", "position": round(self.position, 2), "length": round(self.length, 2), "playing": self.playing, "rate": self.rate})


def story(reader: recording.Reader):
    """[(seconds, message)] in order of time."""
    header = reader.header
    world = _world(header)
    yield 0.0, {"type": "names", "reasons": list(header.reasons), "faults": []}
    telemetry = frames.FrameReader()
    full_speed = 1280.0
    for record in reader:
        moment = record.time_us / 1e6
        if record.stream == recording.Stream.TELEMETRY:
            for kind, _, payload in telemetry.read(record.data):
                message = messages.decode(kind, payload, full_speed)
                if message:
                    full_speed = message.get("full_speed", full_speed)
                    yield moment, message
        elif record.stream == recording.Stream.POSE:
            if world is not None:
                # Where the robot thinks it is begins anywhere: only true poses fit between the walls.
                yield 0.0, world
                world = None
            x, y, heading = recording.Pose.unpack(record.data)
            yield moment, {"type": "truth", "x": round(x, 1), "y": round(y, 1), "heading": round(heading, 2), "clearance": None, "time": moment}
        elif record.stream == recording.Stream.EVENT:
            yield moment, {"type": "event", "text": record.data.decode(errors="replace"), "time": moment}


def _world(header: recording.Header) -> dict | None:
    """The walls of a recording of the twin, built again from its address."""
    if not header.source.startswith("twin:"):
        return None
    try:
        from host.twin import courses

        from .twin import arguments_of, world_of

        address = parse(header.source)
        wanted = arguments_of(address.place, address.options)
        names = ("course", "width", "gap", "seed", "mirror", "reverse", "angle", "scale", "length", "side", "start", "goal")
        given = {key: value for key, value in wanted.items() if key in names}
        return world_of(courses.make(given.pop("course"), **given))
    except (AddressError, ValueError, TypeError, ImportError):
        return None  # recorded with another version of the twin: the drive can be seen without the walls
