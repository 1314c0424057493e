"""Plays tapes to the firmware under MicroPython and gathers what its stages took."""

import json
import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from host import micropython
from host.twin import image

from . import blocks, machine_code

HERE = Path(__file__).resolve().parent
HEAP = {"time": "192m", "count": "192m", "heap": "3m", "decisions": "192m", "calibrate": "192m"}  # no collection of garbage falls into what is measured
KINDS = ("", "poll", "place", "guard", "work", "update", "command", "points", "paper", "plain", "feed", "turn", "stop", "start", "paper_full")
LIMIT_S = 300


def module_of(path, firmware):
    """Name under which the firmware imports a file: "planner.collision"."""
    parts = path.relative_to(firmware).with_suffix("").parts
    return ".".join(parts[1:] if parts[0] == "lib" else parts)


class BenchError(Exception):
    """The firmware did not get through a tape; the message says why."""


@dataclass
class Log:
    """What one tape gave. rows: (n, 4) int: kind (index in KINDS), value, extra, simulated time us. worst: {kind: counters of its worst row}."""

    rows: np.ndarray
    worst: dict = field(default_factory=dict)


class Bench:
    """The firmware as it is, and a copy with counters, ready to be played tapes.

    firmware: folder with main.py and lib/. `blocks`: the counted blocks with their cost. BenchError, image.ToolMissing.
    """

    def __init__(self, firmware=image.FIRMWARE):
        self.folder = firmware = Path(firmware)
        self.board, self.plain = image.compiled(firmware)
        paths = {module_of(path, firmware): path for path in [firmware / "main.py", *sorted((firmware / "lib").rglob("*.py"))]}
        cutter = blocks.Cutter({name: path.read_text() for name, path in paths.items()})
        machine_code.charge(cutter)
        self.blocks = cutter.blocks
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / "firmware"
            for name, path in paths.items():
                place = copy / path.relative_to(firmware)
                place.parent.mkdir(parents=True, exist_ok=True)
                place.write_text(cutter.counted[name])
            _, self.counted = image.compiled(copy)

    def time(self, tape, again=(0, 0, 0, 0), repeats=2):
        """Log with microseconds here, the least of several plays.

        again: of (so many decisions, so many of them made in full) so many are made by the papers' iteration as well, of the first and again of
        the second, and of the second so many by the plain swept test; once, spread evenly.
        """
        first = self._play("time", tape, self.plain, *map(str, again)).rows
        for _ in range(repeats - 1):
            more = self._play("time", tape, self.plain, "0", "0", "0", "0").rows
            alone = ~np.isin(first[:, 0], [KINDS.index(kind) for kind in ("paper", "paper_full", "plain")])
            if alone.sum() == len(more):
                first[alone, 1] = np.minimum(first[alone, 1], more[:, 1])
        return Log(first)

    def count(self, tape):
        """Log with instructions on the ESP32."""
        with tempfile.NamedTemporaryFile(suffix=".costs") as costs:
            costs.write(np.array([block.instructions for block in self.blocks], "<i4").tobytes())
            costs.flush()
            return self._play("count", tape, self.counted, costs.name)

    def calibrate(self, tape, said=b"", tables=True):
        """(n, 6) int of what board/meter.py wrote down. said: bytes that come on the USB line at once. tables: they are on the board, or made there."""
        with tempfile.TemporaryDirectory() as folder:
            costs, sizes = Path(folder) / "costs", Path(folder) / "sizes"
            costs.write_bytes(np.array([block.instructions for block in self.blocks], "<i4").tobytes())
            sizes.write_text(json.dumps(image.sizes(self.folder)))
            data = play(
                "calibrate",
                tape,
                tape.robot,
                self.board,
                self.counted,
                str(costs),
                str(sizes),
                said=said,
                tables=tables and image.tables(tape.robot, self.folder),
            )
        return np.frombuffer(data, "<i4").reshape(-1, 6)

    def heap(self, tape):
        """{"worst": bytes by which the heap grew most in one loop, "all": in all loops, "buffers": bytes of all buffers on the ESP32}."""
        return json.loads(self._run("heap", tape, self.plain))

    def _play(self, what, tape, firmware, *extra):
        data = self._run(what, tape, firmware, *extra)
        words = np.frombuffer(data, "<i4")
        size = len(KINDS) * len(self.blocks) if what == "count" else 0
        rows = words[: len(words) - size].reshape(-1, 4).copy()
        counters = words[len(words) - size :].reshape(len(KINDS), -1) if size else ()
        return Log(rows, {KINDS[i]: counters[i] for i in range(1, len(KINDS))} if size else {})

    def _run(self, what, tape, firmware, *extra):
        return play(what, tape, tape.robot, self.board, firmware, *extra, tables=image.tables(tape.robot, self.folder))


def play(what, tape, robot, board, firmware, *extra, said=b"", tables=None):
    """Bytes that the runner (board/runner.py, WHAT there) writes when it plays a tape to a compiled firmware. robot: text of its robot.json.

    said: bytes that come on the USB line at once. tables: file of the planner's tables to put on the board.
    """
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "robot.json").write_text(robot)
        (Path(folder) / "said").write_bytes(said)
        if tables:
            shutil.copyfile(tables, Path(folder) / "tables.bin")
        log = Path(folder) / "log"
        command = [
            *micropython.find().command,
            "-X",
            f"heapsize={HEAP[what]}",
            str(HERE / "board" / "runner.py"),
            what,
            str(tape.path),
            str(log),
            str(board),
            str(firmware),
            str(HERE / "baselines"),
            *extra,
        ]
        try:
            with open(Path(folder) / "said", "rb") as line:
                done = micropython.run(command, LIMIT_S, cwd=folder, stdin=line, capture_output=True)
        except subprocess.TimeoutExpired:
            raise BenchError(f"the firmware was not through with {tape.name} after {LIMIT_S} s of computing") from None
        if done.returncode or not log.exists():
            said = (done.stdout + done.stderr).decode(errors="replace")
            trace = said[said.rfind("Traceback") :].strip() if "Traceback" in said else f"it ended with code {done.returncode}\n{said[-300:]}".strip()
            raise BenchError(f"the firmware did not get through {tape.name}:\n{trace}")
        return log.read_bytes()
