"""Runs the firmware on a MicroPython with the board's words and stub devices, and gets the trace of its start.

A trace is a list of events, each a list, in their order:

    ["code", module, [bytes, ...]]         a module with this machine code is loaded, one number a function
    ["heap", what, live, peak]             bytes of the heap after `what`, and the most it had to hold since the event before
    ["uart", who, receive, send]           a UART with rings of so many bytes is made
    ["radio", "on" or "connected"]
"""

import functools
import json
import os
import shutil
import struct
import subprocess
import tempfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from host import micropython
from host.bench import machine_code
from host.boards import build
from host.link import messages
from host.twin import courses, image
from host.twin.delta2b import Delta2B
from host.twin.vehicle import Vehicle
from host.twin.world import World
from link import auth, protocol
from link import frames as whole_frames

BOARD = Path(__file__).resolve().parent / "board"
NETWORK = "net", "12345678"  # what host/twin/board/network.py has in reach
OPTIONS = {
    "usb": {},
    "wifi": {"wifi": {"ssid": NETWORK[0], "password": NETWORK[1]}},
    "screen": {"wifi": {"ssid": NETWORK[0], "password": NETWORK[1]}, "screen": {"kind": "nextion"}},
}
TURNS = 1500  # turns of the loop that sleep, 1 ms each
LARGE = 1 << 20
_TABLES = 3 / 128  # of a heap goes into the collector's tables
_STEP = 1024
_LOWEST = 48 * 1024  # what a smaller heap holds is no question: the first area is larger
_KEY = bytes(32)
_SESSION = bytes(8)  # of a robot whose random bytes are zeros, see board/measure.py
_PATIENCE_S = 120


class Failed(Exception):
    """The firmware did not come to its loop for another reason than memory; the text is what it said."""


def merged(config: dict, changes: dict) -> dict:
    """A robot.json with some of its groups changed."""
    return {**config, **{group: {**config.get(group, {}), **values} for group, values in changes.items()}}


@contextmanager
def board(config: dict, firmware: Path = image.FIRMWARE, commands: bytes = b""):
    """A folder with the board's files, compiled for this machine as `make flash` compiles them for the chip, and with the stub devices."""
    port = micropython.find()
    with tempfile.TemporaryDirectory(prefix="budget-") as name:
        folder = Path(name)
        build.build(folder, firmware, port.architecture)
        (folder / "robot.json").write_text(json.dumps(config))
        (folder / "board").mkdir()
        for source in (*BOARD.glob("*.py"), image.BOARD / "network.py", image.BOARD / "socket.py"):
            shutil.copy(source, folder / "board")
        (folder / "lidar.bin").write_bytes(lidar_bytes())
        (folder / "commands.bin").write_bytes(commands)
        (folder / "datagrams.bin").write_bytes(datagrams())
        (folder / "network.key").write_bytes(_KEY)
        if (firmware / "lib" / "planner" / "tables.py").exists():
            build.put_tables((folder / "robot.json").read_bytes(), folder)
        yield folder


def start(folder: Path, what: str = "end", heap: int = LARGE, turns: int = TURNS, leave: int = 0) -> "Run":
    """Run the firmware of a board's folder. heap: bytes, the collector's tables included; leave: of it, once the loop runs; 0: all. Raises Failed."""
    port = micropython.find()
    command = [*port.command, "-X", f"heapsize={heap * port.heap_factor}", "board/measure.py", what, str(turns), str(bare()), str(leave)]
    with open(folder / "commands.bin", "rb") as commands:
        done = micropython.run(command, _PATIENCE_S, cwd=folder, stdin=commands, capture_output=True, env={**os.environ, "PYTHONHASHSEED": "0"})
    told = folder / "told"
    lines = told.read_text().splitlines() if told.exists() else []
    told.unlink(missing_ok=True)
    run = Run([line.split() for line in lines], done.stdout)
    if run.live is None and run.failed is None and what != "rooms":
        said = (done.stdout[-2000:] + done.stderr[-2000:]).decode(errors="replace").strip()
        if "MemoryError" in said or "memory allocation failed" in said:
            run.failed = 0
        else:
            raise Failed(said[-1500:])
    return run


class Run:
    """What a run told. live: bytes after its turns; failed: events before memory ran out; stubs: bytes of the stub devices; output: what it sent."""

    def __init__(self, lines: list[list[str]], output: bytes):
        numbers = {words[0]: int(words[1]) for words in lines if words[0] in ("live", "failed", "stubs")}
        self.live = numbers.get("live")
        self.failed = numbers.get("failed")
        self.stubs = numbers.get("stubs", 0)
        self.events = [words[1:] for words in lines if words[0].isdigit()]
        self.output = output


@functools.cache
def bare() -> int:
    """Bytes that this machine's MicroPython has in its heap before it runs anything."""
    done = subprocess.run([*micropython.find().command, "-c", "import gc; gc.collect(); print(gc.mem_alloc())"], capture_output=True, check=True)
    return int(done.stdout)


def objects(heap: int) -> int:
    """Bytes for objects in a heap of so many bytes."""
    return int(heap * (1 - _TABLES))


def record(folder: Path, pieces: dict[str, list[int]]) -> list[list]:
    """The trace of the start of the firmware in a board's folder. pieces: module -> bytes of its machine code, see `native_pieces`."""
    run = start(folder, "trace")
    if run.live is None:
        raise Failed("not even in a heap of 1 MiB")
    peaks = _peaks(folder, len(run.events), max(int(words[-1]) for words in run.events), run.stubs)
    trace: list[list] = []
    for (kind, *what, live), peak in zip(run.events, peaks, strict=True):
        _add_heap(trace, {"heap": what[0] if what else "", "loop": "the loop"}.get(kind, f"what comes before {what[0]}" if what else ""), int(live), peak)
        if kind == "code" and pieces.get(what[0]):
            trace.append(["code", what[0], pieces[what[0]]])
        elif kind == "uart":
            trace.append(["uart", what[0], int(what[1]), int(what[2])])
        elif kind == "radio":
            trace.append(["radio", what[0]])
    return trace


def _add_heap(trace: list[list], what: str, live: int, peak: int) -> None:
    """Several in a row are one: the last of them, named after the one that needed most."""
    peak = max(live, peak)
    if trace and trace[-1][0] == "heap":
        _, before, _, highest = trace.pop()
        if highest >= peak:
            what, peak = before, highest
    trace.append(["heap", what, live, peak])


def _peaks(folder: Path, events: int, live: int, stubs: int) -> list[int]:
    """For each event the least heap, in bytes for objects, in which the firmware comes to it; by bisection, exact to 1 KiB."""

    @functools.cache
    def reached(heap: int) -> int:
        run = start(folder, heap=heap)
        return events if run.failed is None else run.failed

    found = [0] * events
    low, high = _LOWEST, (live + 48 * 1024) // _STEP * _STEP
    while reached(high) < events:
        high += 32 * 1024

    def split(low: int, high: int) -> None:
        first, last = reached(low), reached(high)
        if first == last:
            return
        if high - low <= _STEP:
            for event in range(first, last):
                found[event] = max(found[event], objects(high) - stubs)
            return
        middle = (low + high) // 2 // _STEP * _STEP
        split(low, middle)
        split(middle, high)

    split(low, high)
    highest = 0
    for event in range(events):
        highest = max(highest, found[event])
        found[event] = highest
    return found


def native_pieces(firmware: Path = image.FIRMWARE) -> dict[str, list[int]]:
    """Bytes of machine code for the ESP32 of each module that has any, a number a function: {"core.trig": [120, 130]}."""
    found = {}
    for source in sorted((firmware / "lib").rglob("*.py")):
        text = source.read_text()
        if "viper" in text or "native" in text:
            sizes = [len(code) for code in machine_code.viper_functions(machine_code.compile_for_esp32(text))]
            if sizes:
                found[".".join(source.relative_to(firmware / "lib").with_suffix("").parts)] = sizes
    return found


@functools.cache
def lidar_bytes(frames: int = 320) -> bytes:
    """What the lidar sends while the robot stands at the start of a Z course, 550 mm wide; speed faults left out."""
    config = json.loads((image.FIRMWARE / "robot.json").read_text())
    course = courses.make("Z", 550)
    lidar = Delta2B(Vehicle.from_settings(config).lidar, World(course.segments), np.random.default_rng(1))
    lidar.spin(0, 0.62)
    x, y, heading = course.start[:3]

    def stands(times):
        return np.full(len(times), x), np.full(len(times), y), np.full(len(times), heading)

    out: list[bytes] = []
    while len(out) < frames:
        data = lidar.take(stands)
        if len(data) > 60:
            out.append(data)
    return b"".join(out)


def datagrams() -> bytes:
    """Greetings with a right tag, as a laptop sends them over WiFi: each with its length before it (2 bytes).

    Names are asked for by the third of eight, which comes when the live data have been taken: what is loaded for them comes and goes.
    """
    out = []
    for counter in range(1, 65):
        payload = messages.greet(counter, counter % 8 == 3)
        head = struct.pack("<BBHH", protocol.VERSION, protocol.GREET, 0, len(payload) + auth.TAG)
        data = whole_frames.frame(protocol.GREET, payload + auth.Signer(_KEY).tag(_SESSION, head + payload))
        out.append(struct.pack("<H", len(data)) + data)
    return b"".join(out)
