"""What all links share: frames in, commands out, and taps that see both."""

import queue
import threading
import time

from link import frames, protocol

from . import messages

_LAST_COUNTER = 0xFFFFFFFF
QUEUE = 4000  # messages; beyond that nobody is reading, and the oldest go


class LinkError(Exception):
    """The link cannot be opened or has broken; the text says what to do."""


class Link:
    """A link to one robot. Subclasses start threads that call `_receive`, and implement `_send` and `close`.

    address: as given. commands: whether the other end listens at all. robot: the last hello, {} before.
    taps: callables (direction, bytes), direction "in" or "out": see every byte as it passes, for recording.
    """

    commands = True

    def __init__(self, address: str):
        self.address = address
        self.robot: dict = {}
        self.taps: list = []
        self.lost = 0  # frames that went missing on the way, by their sequence numbers
        self.refused = 0  # whole frames that hold nothing this version knows: damaged, hostile, or of another version
        self._queue: queue.Queue = queue.Queue()
        self._frames = frames.FrameReader(stray=self._stray)
        self._printed = bytearray()
        self._sequence_in: int | None = None
        self._sequence_out = 0
        self._counter = 0
        self._lock = threading.Lock()
        self._ended = False

    def begin(self) -> None:
        """Somebody looks on now: what can wait for that, the twin, begins."""

    def kept(self) -> str:
        """Where a KEEP that the robot has confirmed was written to, in words."""
        return "robot.json on the robot"

    def get(self, timeout: float | None = None) -> dict | None:
        """The next message; None when none came in `timeout` seconds (None: wait)."""
        try:
            return self._queue.get(timeout=timeout)
        except queue.Empty:
            return None

    def __iter__(self):
        """Messages until the link has ended."""
        while True:
            message = self._queue.get()
            yield message
            if message["type"] == "ended":
                return

    def wait_for(self, kind: str, timeout: float = 5.0) -> dict | None:
        """The next message of this type, others being dropped; None if it does not come in time."""
        end = time.monotonic() + timeout
        while (left := end - time.monotonic()) > 0:
            message = self.get(left)
            if message and message["type"] == kind:
                return message
        return None

    def drive(self, what: str, af: float = 0, ar: float = 0, v: float = 90) -> None:
        """what: "stop", "auto" or "manual"; "manual" needs repeating within 250 ms, or the robot stops. Degrees, V 0..180."""
        self._command(protocol.DRIVE, lambda counter: messages.drive(counter, what, af, ar, v))

    def tune(self, key: str, value) -> None:
        """Change a live parameter; the reply tells if it was refused."""
        self._command(protocol.TUNE, lambda counter: messages.tune(counter, key, value))

    def keep(self) -> None:
        """Write what was tuned to the board's robot.json."""
        self._command(protocol.KEEP, messages.plain)

    def request_parameters(self) -> None:
        """Ask for every parameter."""
        self._command(protocol.LIST, messages.plain)

    def watch(self, scan: bool = False, candidates: bool = False, turns: bool = False) -> None:
        """Ask for raw scans, for the candidates of each decision and for what the turns of the loop are spent on, or no longer."""
        self._command(protocol.WATCH, lambda counter: messages.watch(counter, scan, candidates, turns))

    def point(self, wheel: int, angle: float) -> None:
        """Turn one wheel alone, degrees."""
        self._command(protocol.POINT, lambda counter: messages.point(counter, wheel, angle))

    def go(self, what: str, x: float = 0, y: float = 0, heading: float = 0) -> None:
        """About goals and the pose, where the robot has a map: see `messages.go`."""
        self._command(protocol.GO, lambda counter: messages.go(counter, what, x, y, heading))

    def put_map(self, first: int, size: int, check: int, part: bytes) -> None:
        """A part of a map for the board; `host.map.send` sends all of them."""
        self._command(protocol.PUT_MAP, lambda counter: messages.put_map(counter, first, size, check, part))

    def restart(self) -> None:
        """Restart the robot; it refuses unless it stands. It is a new session then, with what was tuned gone unless it was kept."""
        self._command(protocol.RESTART, messages.plain)

    def greet(self, names: bool = True) -> None:
        """Show that someone listens; names: ask for HELLO and NAMES."""
        self._command(protocol.GREET, lambda counter: messages.greet(counter, names, self._nonce()))

    def close(self) -> None:
        """Let go of the other end."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def arm(self, what: str, **more) -> int:
        """Move the arm, or hold it, see `messages.arm`; what moves needs repeating "go on" within 300 ms, or it freezes. The counter that its reply will have."""
        return self._command(protocol.ARM, lambda counter: messages.arm(counter, what, **more))

    def reach(self, offset: int, data: bytes) -> int:
        """A piece of a trajectory for the arm; likewise."""
        return self._command(protocol.REACH, lambda counter: messages.reach(counter, offset, data))

    def _command(self, kind: int, payload) -> int:
        """payload: callable counter -> bytes. Returns the counter."""
        with self._lock:
            self._counter = min(self._counter + 1, _LAST_COUNTER)  # a stop is obeyed whatever its counter
            data = self._frame(kind, payload(self._counter))
            self._sequence_out += 1
            for tap in self.taps:
                tap("out", data)
            self._send(data)
            return self._counter

    def _nonce(self) -> bytes:
        """What makes the answer to a greeting one of now; for links that others can write to."""
        return b""

    def _frame(self, kind: int, payload: bytes) -> bytes:
        return frames.frame(kind, payload, self._sequence_out)

    def _send(self, data: bytes) -> None:
        raise NotImplementedError

    def _receive(self, data: bytes) -> None:
        """Bytes from the robot, in any pieces."""
        for tap in self.taps:
            tap("in", data)
        for kind, sequence, payload in self._frames.read(data):
            self._take(kind, sequence, payload)

    def _take(self, kind: int, sequence: int, payload: bytes) -> None:
        if self._sequence_in is not None:
            self.lost += (sequence - self._sequence_in - 1) & 0xFFFF if self._started(kind) else 0
        self._sequence_in = sequence
        message = messages.decode(kind, payload, self.robot.get("full_speed", 1280.0))
        if message is None:
            self.refused += 1
            return
        if message["type"] == "hello":
            if not self._is_proven(message, payload):
                return
            self._greeted(message)
        self._put(message)

    def _is_proven(self, hello: dict, payload: bytes) -> bool:
        """Whether a HELLO is the robot's own; False: it is passed over."""
        return True

    def _started(self, kind: int) -> bool:
        return bool(self.robot)

    def _greeted(self, hello: dict) -> None:
        if hello["session"] != self.robot.get("session"):
            self._sequence_in = None  # it has restarted, and counts from the start
        self.robot = hello

    def _stray(self, byte: int) -> None:
        """What is printed on the line between frames: passed on a line at a time."""
        if byte == 10 or len(self._printed) > 500:
            text = self._printed.decode(errors="replace").strip("\r\0")
            self._printed.clear()
            # What is left of a broken frame is no text.
            if text and text.isprintable() and "\ufffd" not in text:
                self._put({"type": "text", "text": text})
        elif byte:
            self._printed.append(byte)

    def _put(self, message: dict) -> None:
        if self._queue.qsize() >= QUEUE:
            try:
                self._queue.get_nowait()
            except queue.Empty:
                pass
        self._queue.put(message)

    def _end(self, text: str) -> None:
        """Say once that nothing more will come."""
        if not self._ended:
            self._ended = True
            self._put({"type": "ended", "text": text})
