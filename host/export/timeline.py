"""Everything a recording tells, as messages in order of time."""

from collections.abc import Iterator
from heapq import merge

from host.link.playback import story
from host.recording import Decision, Reader, Stream


def timeline(reader: Reader) -> Iterator[tuple[float, dict]]:
    """(seconds, message): those of `host.link.playback.story`, but the decisions read out of the firmware where there are any.

    Of the decisions in the telemetry some may have been dropped on the way.
    """
    recorded = [(record.time_us / 1e6, _message(record)) for record in reader.stream(Stream.DECISION)]
    told = (entry for entry in story(reader) if not (recorded and entry[1]["type"] == "decision"))
    return merge(told, recorded, key=lambda entry: entry[0])


def _message(record) -> dict:
    decision = Decision.unpack(record.data)
    return {
        "type": "decision", "time": record.time_us / 1e6, "number": decision.number, "af": decision.af / 10, "ar": decision.ar / 10,
        "v": decision.v, "mode": decision.mode, "window": decision.window, "zone": None if decision.zone == 255 else decision.zone,
        "free": decision.free, "block": None if decision.block_x == 32767 else [decision.block_x, decision.block_y], "why": decision.why,
    }  # fmt: skip


def word(reasons: tuple[str, ...], number: int) -> str:
    """A decision's reason in words, as far as the recording knows them."""
    return reasons[number] if number < len(reasons) else str(number)
