"""The recordings a page can open, each with its length, how it ended, and the robot's way for a small picture."""

from functools import lru_cache
from pathlib import Path

from host import recording
from host.link import messages
from host.recording import Pose, Stream
from link import frames, protocol

MOST = 24  # of the newest
WAY = 80  # places of a way
LARGEST = 64_000_000  # bytes; what is longer is listed without being looked through


def newest(folder: Path) -> list[dict]:
    """Newest first: {path, bytes, length: s or None, result: text, way: [[x, y] mm]}."""
    found = [(path.stat(), path) for path in folder.glob("**/*.rec")]
    found.sort(key=lambda entry: entry[0].st_mtime, reverse=True)
    return [{"path": str(path), "bytes": state.st_size, **_looked_through(path, state.st_mtime_ns, state.st_size)} for state, path in found[:MOST]]


@lru_cache(maxsize=200)
def _looked_through(path: Path, _changed: int, size: int) -> dict:
    """length, result and way of a recording; looked through again only when the file has changed."""
    if size > LARGEST:
        return {"length": None, "result": "too long to be looked through", "way": []}
    try:
        reader = recording.Reader(path)
        last_us, result = 0, ""
        true, believed = [], []
        telemetry = frames.FrameReader()
        for record in reader:
            last_us = max(last_us, record.time_us)
            if record.stream == Stream.EVENT:
                result = record.data.decode(errors="replace")
            elif record.stream == Stream.POSE:
                pose = Pose.unpack(record.data)
                true.append((pose.x, pose.y))
            elif record.stream == Stream.TELEMETRY:
                believed += _poses(telemetry.read(record.data))
    except recording.RecordingError as error:
        return {"length": None, "result": str(error), "way": []}
    way = true or believed
    step = max(1, len(way) // WAY)
    return {
        "length": round(last_us / 1e6, 1),
        "result": result or ("cut off" if reader.cut else "ended by hand"),
        "way": [[round(x), round(y)] for x, y in way[::step]],
    }


def _poses(found) -> list[tuple[float, float]]:
    decoded = (messages.decode(kind, payload) for kind, _, payload in found if kind == protocol.POSE)
    return [(message["x"], message["y"]) for message in decoded if message]
