"""How much more than its live data the heap needs while everything is asked of the robot at once, and whether anything stays behind.

A round: greeting with names, the list of all parameters, raw scans and candidates switched on, a value tuned and kept, all while it drives.
Every other round tunes one that counts at once, the rounds between one that counts from the next start.
"""

import json
import struct
from dataclasses import dataclass
from pathlib import Path

from host.link import messages
from host.twin import image
from link import frames as whole_frames
from link import protocol

from . import trace

ROUNDS = 100
TURNS_A_ROUND = 400
_PORTION = 8  # bytes the firmware reads from the line in one turn of its loop
_STEP = 256
_HEAP = 256 * 1024
_MOST = 32 * 1024


@dataclass
class Answers:
    """What came back. refused: texts of the replies that were no OK; parameters, hellos, names, scans: how many messages."""

    refused: list[str]
    replies: int
    parameters: int
    hellos: int
    names: int
    scans: int


def commands(rounds: int) -> bytes:
    """The bytes of so many rounds; zeros between the commands let turns of the loop pass."""
    out = [_pause(400)]
    counter = 0
    for k in range(rounds):
        tuned = ("avoid.margin", 9 + k % 3) if k % 2 else ("drive.cruise", 106 + k % 3)
        for kind, payload, turns in (
            (protocol.WATCH, messages.watch(counter + 1, True, True), 15),
            (protocol.GREET, messages.greet(counter + 2, True), 40),
            (protocol.LIST, messages.plain(counter + 3), 40),
            (protocol.TUNE, messages.tune(counter + 4, *tuned), 40),
            (protocol.KEEP, messages.plain(counter + 5), 240),
            (protocol.WATCH, messages.watch(counter + 6, False, False), TURNS_A_ROUND - 375),
        ):
            out += [whole_frames.frame(kind, payload), _pause(turns)]
        counter += 6
    return b"".join(out)


def _pause(turns: int) -> bytes:
    return bytes(_PORTION * turns)


def answers(output: bytes) -> Answers:
    """What the robot's output answers to the rounds."""
    replies, parameters, hellos, names, scans = [], 0, 0, 0, 0
    for kind, _, payload in whole_frames.decode(output):
        if kind == protocol.REPLY:
            replies.append(struct.unpack_from(protocol.REPLY_FORMAT, payload)[2:] + (payload[struct.calcsize(protocol.REPLY_FORMAT) :].decode(),))
        parameters += kind == protocol.PARAMETER
        hellos += kind == protocol.HELLO
        names += kind == protocol.NAMES
        scans += kind == protocol.SCAN
    return Answers([text for status, text in replies if status != protocol.OK], len(replies), parameters, hellos, names, scans)


def live_after(config: dict, rounds: int, firmware: Path = image.FIRMWARE) -> tuple[int, Answers]:
    """(bytes of the heap after so many rounds and a collection, the answers)."""
    with trace.board(config, firmware, commands(rounds)) as folder:
        run = trace.start(folder, turns=rounds * TURNS_A_ROUND + 3000)  # by then what is loaded for a command has been let go
        if run.live is None:
            raise trace.Failed("not even in a heap of 1 MiB")
        return run.live, answers(run.output)


def highest(config: dict, firmware: Path = image.FIRMWARE, rounds: int = 4) -> int:
    """Bytes over the live data: the least that must be free, in steps of 256, for the rounds to pass and every command to be obeyed."""
    turns = rounds * TURNS_A_ROUND + 2000
    with trace.board(config, firmware, commands(rounds)) as folder:
        large = trace.start(folder, turns=turns)
        wanted = answers(large.output)
        if large.live is None or wanted.refused:
            raise trace.Failed(f"refused even in a heap of 1 MiB: {json.dumps(wanted.refused[:3])}")

        def passes(free: int) -> bool:
            run = trace.start(folder, turns=turns, heap=_HEAP, leave=free)
            if run.live is None:
                return False
            got = answers(run.output)
            return not got.refused and got.replies == wanted.replies and got.parameters == wanted.parameters and got.names == wanted.names

        low, high = 0, _MOST
        if not passes(high):
            raise trace.Failed(f"not even with {high} bytes free beside the live data")
        while high - low > _STEP:
            middle = (low + high) // 2 // _STEP * _STEP
            low, high = (low, middle) if passes(middle) else (middle, high)
        return high
