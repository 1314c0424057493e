"""Between a link and whoever looks on: keeps the latest of everything, for those who come later, and records."""

import threading
import time
from pathlib import Path
from urllib.parse import urlencode

from host import recording
from host.link import AddressError, LinkError, connect, parse
from host.link.base import Link
from host.link.playback import PlaybackLink

from . import commands, recordings, runs
from .recorder import LinkRecorder

# What those who come later are told too: the latest of each of these types.
LATEST = (
    "hello",
    "names",
    "world",
    "health",
    "decision",
    "points",
    "wheels",
    "pose",
    "truth",
    "scan",
    "candidates",
    "playback",
    "run",
    "other",
    "pace",
    "box",
    "screen",
    "ended",
)

RECORDINGS = Path("out")  # where a page records, and the only folder from which it opens recordings
# What a page may ask of the twin: no files, and no code of the asker's choice. The command line takes every option.
PAGE_OPTIONS = ("width", "gap", "seed", "mirror", "reverse", "angle", "scale", "mode", "speed", "autostart", "fault", "screen")

ASK_S, ASKED = 3.0, 10  # how long to wait for the parameters, and how often to ask


class Station:
    """One robot watched by any number of listeners.

    listeners: callables that take a message; called from the link's thread. The twin waits for the first.
    """

    def __init__(self, address: str, record: str | None = None):
        self.listeners: list = []
        self.address = address
        self._record_next = record
        self._latest: dict = {}
        self._parameters: dict = {}
        self._twin_s: str | None = None  # where the twin records itself, so that it can be replayed
        self._kept = ""  # robot.json that the twin kept, for its next run
        self._recorder: LinkRecorder | None = None
        self._given = address  # by the person who started the monitor: may be opened again, whatever it is
        self._lock = threading.Lock()
        self.link: Link | None = None
        self._asked: Link | None = None  # whose parameters are being asked for, or were
        self.open(address)

    def open(self, address: str) -> None:
        """Let go of the robot there is, and connect to another. Raises AddressError or LinkError, and keeps the old one then."""
        record, self._record_next = self._record_next, None
        # The twin writes a recording that can be replayed; of another robot only what went over the link can be recorded.
        twin = address.startswith("twin:")
        link = connect(address + (("&" if "?" in address else "?") + f"record={record}" if twin and record else ""), begin=False)
        self.close()
        self.address = address
        self._twin_s = record if twin else None
        self._latest.clear()
        self._parameters.clear()
        self.link = link
        if record and not twin:
            self.record(record)
        threading.Thread(target=self._pump, args=(link,), daemon=True).start()
        self._tell(self._connected())
        if isinstance(link, PlaybackLink):
            self._show(runs.whole(link.story))
        if self.listeners:
            self._begin(link)

    def _show(self, message: dict) -> None:
        """Tell all who look on, and those who come later."""
        with self._lock:
            self._latest[message["type"]] = message
        self._tell(message)

    def compare(self, path: str) -> None:
        """Show another recording beside what is open; "": no longer. Raises AddressError or RecordingError."""
        self._show(runs.other(in_recordings(path)) if path else {"type": "other"})

    def run_again(self, changes: dict) -> None:
        """Run the recording that is open through the firmware with other settings, in a thread, and show that beside it. Raises ValueError."""
        link = self.link
        if not isinstance(link, PlaybackLink):
            raise ValueError("only a recording can be run again with other settings; open one")
        path = parse(self.address).place

        def work():
            try:
                self._show(runs.again(path, changes))
            except (recording.RecordingError, ValueError, TypeError, AttributeError) as error:
                self._tell({"type": "refused", "do": "run_again", "text": str(error)})

        threading.Thread(target=work, daemon=True).start()

    def listen(self, hear) -> None:
        """Tell a newcomer what the others have seen, and from now on what they see."""
        for message in self.known():
            hear(message)
        self.listeners.append(hear)
        if self.link is not None:
            self._begin(self.link)

    def _begin(self, link: Link) -> None:
        link.begin()
        if link.commands and link is not self._asked:
            self._asked = link
            threading.Thread(target=self._ask, args=(link,), daemon=True).start()

    def _connected(self) -> dict:
        commands = bool(self.link and self.link.commands)
        courses = course_names() if self.address.startswith("twin:") else []
        return {"type": "connected", "address": self.address, "commands": commands, "recording": self.recording, "courses": courses}

    def close(self) -> None:
        """Close the link and a recording that is under way."""
        self.stop_recording()
        if self.link is not None:
            self.link.close()
            self.link = None

    def known(self) -> list[dict]:
        """What a newcomer has to be told to see what the others see."""
        with self._lock:
            return [self._connected(), *(self._latest[kind] for kind in LATEST if kind in self._latest), *self._parameters.values()]

    @property
    def recording(self) -> str | None:
        """Path of the recording under way."""
        return str(self._recorder.path) if self._recorder else None

    def record(self, path: str | None = None) -> None:
        """Record what goes over the link from now on. Raises RecordingError."""
        self.stop_recording()
        path = path or time.strftime("out/%Y%m%d-%H%M%S.rec")
        with self._lock:
            known, parameters = dict(self._latest), dict(self._parameters)
        if self.link is None:
            raise recording.RecordingError("nothing to record: no robot is connected")
        self._recorder = LinkRecorder(path, self.link, self.address, known, parameters, self._trouble)
        self._tell({"type": "recording", "path": self.recording})

    def _trouble(self, text: str) -> None:
        """From the link's thread: the recording has broken off."""
        self._recorder = None
        self._tell({"type": "recording", "path": None})
        self._tell({"type": "text", "text": text})

    def stop_recording(self) -> None:
        if self._recorder:
            path = self.recording
            self._recorder.close()
            self._recorder = None
            self._tell({"type": "recording", "path": None, "saved": path})

    def command(self, what: dict) -> dict | None:
        """Carry out what a page asks: {"do": ..., ...}; a message for the asker alone, or None. Raises ValueError with a text for the person."""
        link = self.link
        do = what.get("do")
        try:
            if do == "open":
                self.open(self._allowed(str(what["address"])))
            elif do == "again":
                address = self._next_address(what)
                if what.get("record") and address.startswith("twin:"):
                    self._record_next = time.strftime("out/%Y%m%d-%H%M%S-twin.rec")
                self.open(address)
            elif do == "recordings":
                return {"type": "recordings", "list": recordings.newest(RECORDINGS)}
            elif do == "record":
                self.record(in_recordings(what["path"]) if what.get("path") else None)
                if what.get("scans") and link is not None and link.commands:
                    link.watch(scan=True, candidates=bool(what.get("candidates")))  # half of what the cable carries: only for who asks
            elif do == "end_recording":
                self.stop_recording()
            elif do == "play" and isinstance(link, PlaybackLink):
                self._play(link, what)
            elif do in commands.HERE:
                return commands.HERE[do](self, what)
            elif link is None or not link.commands:
                raise ValueError("nothing to command: this is a recording")
            elif do in commands.TO_ROBOT:
                commands.TO_ROBOT[do](link, what)
            else:
                raise ValueError(f"{do!r} is not known")
        except (AddressError, LinkError, recording.RecordingError) as error:
            raise ValueError(str(error)) from None
        except OSError as error:  # a full disk, a folder that may not be read
            raise ValueError(f"{do}: {error.strerror or error}") from None
        except (KeyError, TypeError) as error:
            raise ValueError(f"{do}: {error} is missing or wrong") from None
        return None

    def _next_address(self, what: dict) -> str:
        """The address there is, with another course if the page chose one, and with what was kept in the twin. Raises AddressError."""
        scheme, place, options = parse(self.address)
        if scheme != "twin":
            return self.address
        if self._kept:
            options["config"] = self._kept
        if course := what.get("course"):
            # What was given on the command line stays, but for the shape of another course.
            for name in ("width", "gap", "angle", "length", "side", "start", "goal", "record"):
                options.pop(name, None)
            place = str(course)
            if place not in course_names():
                raise AddressError(f"{place!r} is not a course; courses are {', '.join(course_names())}")
            for name in PAGE_OPTIONS:
                if what.get(name) not in (None, ""):
                    options[name] = str(what[name])
                elif name in what:
                    options.pop(name, None)  # the page has it, and left it out
        return f"twin:{place}" + ("?" + urlencode(options, safe="/:,") if options else "")

    def _allowed(self, address: str) -> str:
        """An address that a page may open. Raises AddressError: a page must neither read this computer's files nor run code on it."""
        if address in (self._given, self.address):
            return address
        scheme, place, options = parse(address)
        if scheme == "file":
            return f"file:{in_recordings(place)}"
        if scheme == "twin" and place.lower() not in (known := [name.lower() for name in course_names()]):
            raise AddressError(f"{place!r} is not a course; courses are {', '.join(known)}; the file of a world can be given on the command line only")
        if scheme == "twin" and (other := [name for name in options if name not in PAGE_OPTIONS]):
            raise AddressError(f"twin option {other[0]!r} can be given on the command line only; a page may give {', '.join(PAGE_OPTIONS)}")
        return address

    @staticmethod
    def _play(link: PlaybackLink, what: dict) -> None:
        if "rate" in what:
            link.rate = float(what["rate"])
        if "playing" in what:
            if what["playing"] and link.position >= link.length:
                link.seek(0.0)
            link.playing = bool(what["playing"])
        if "position" in what:
            link.seek(float(what["position"]))

    def _ask(self, link: Link) -> None:
        """Ask for parameters and names until all are here: a datagram may be lost, and a robot may just be starting."""
        for _ in range(ASKED):
            if not self._has_parameters():
                link.request_parameters()
            if "names" not in self._latest:
                link.greet()
            end = time.monotonic() + ASK_S
            while time.monotonic() < end and link is self.link:
                if self._has_parameters() and "names" in self._latest:
                    return
                time.sleep(0.1)
            if link is not self.link:
                return

    def _has_parameters(self) -> bool:
        with self._lock:
            known = list(self._parameters.values())
        return bool(known) and len(known) == known[0].get("of", 1)

    def _pump(self, link: Link) -> None:
        for message in link:
            if link is not self.link:
                return
            if message["type"] == "hello" and message["session"] != self._latest.get("hello", message)["session"]:
                self._restarted(link)
            with self._lock:
                if message["type"] == "parameter":
                    self._parameters[message["key"]] = message
                elif message["type"] in LATEST:
                    self._latest[message["type"]] = message
            if recorder := self._recorder:
                recorder.message(message)
            if message["type"] == "reply" and message["command"] == "keep" and message["status"] == "ok":
                message = {**message, "kept": self._where_kept(link)}
            self._tell(message)
            if message["type"] == "ended" and self._twin_s:
                self._tell({"type": "recording", "path": self.recording, "saved": self._twin_s})

    def _where_kept(self, link: Link) -> str:
        try:
            where = link.kept()
        except OSError as error:
            return f"robot.json of this run alone: a copy cannot be written ({error.strerror})"
        if self.address.startswith("twin:"):
            self._kept = where
            where += ", from which the twin drives until the monitor is closed; later with the address option config=" + where
        return where

    def _restarted(self, link: Link) -> None:
        """The robot has restarted, which is no error: its parameters may be others now."""
        with self._lock:
            self._parameters.clear()
        threading.Thread(target=self._ask, args=(link,), daemon=True).start()

    def _tell(self, message: dict) -> None:
        for listener in list(self.listeners):
            listener(message)


def course_names() -> list[str]:
    """The twin's courses; asked only where the twin is opened, because it needs numpy."""
    from host.twin import courses

    return list(courses.NAMES)


def in_recordings(path) -> str:
    """A file of the recordings' folder, named with or without it. Raises AddressError for all others."""
    folder = RECORDINGS.resolve()
    given = Path(str(path))
    target = (given if given.parts[:1] == RECORDINGS.parts or given.is_absolute() else RECORDINGS / given).resolve()
    if folder not in target.parents or target.suffix != ".rec":
        raise AddressError(f"{path}: a page records into, and opens, files of the folder {RECORDINGS} whose names end in .rec; others by the command line")
    return str(target.relative_to(Path.cwd())) if Path.cwd() in target.parents else str(target)
