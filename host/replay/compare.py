"""What was decided and written then, beside what is now."""

from bisect import bisect_right
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

from host.recording import Decision

from .tape import Log


@dataclass(frozen=True)
class Difference:
    """Time in us at which the two part; then, now: Decision, or (address, bytes) of a write; None where there is none."""

    time_us: int
    then: Any
    now: Any


@dataclass(frozen=True)
class Comparison:
    """compared: how many of the recorded entries have a counterpart or lack it. differences: in order of time."""

    compared: int
    differences: list[Difference]


def decisions_by_number(then: Log, now: Log) -> Comparison:
    """Each decision beside the one of the same number: for the same settings, where all must agree.

    Both logs are read out of the firmware whenever it waits; one that fell between two such moments in one of the logs is left out.
    """
    found = {decision.number: decision for _, decision in now.decisions}
    last = max(found, default=0)
    differences = []
    compared = 0
    for time, decision in then.decisions:
        other = found.get(decision.number)
        if other is None and decision.number < last:
            continue
        compared += 1
        if other != decision:
            differences.append(Difference(time, decision, other))
    return Comparison(compared, differences)


def decisions_by_time(then: Log, now: Log) -> Comparison:
    """Each decision beside the one in force at the middle of its life: for other settings, where the numbers run apart.

    The middle, because the moments at which the two were read out may be a loop's turn apart. What counts is what the robot is told to
    do and why: AF, AR, V, mode, window, zone, why.
    """
    times = [time for time, _ in now.decisions]
    differences = []
    ends = [time for time, _ in then.decisions[1:]] + [then.end_us]
    for (time, decision), end in zip(then.decisions, ends):
        index = bisect_right(times, (time + end) // 2) - 1
        other = now.decisions[index][1] if index >= 0 else None
        if other is None or _conduct(other) != _conduct(decision):
            differences.append(Difference(time, decision, other))
    return Comparison(len(then.decisions), differences)


def writes(then: Log, now: Log) -> Comparison:
    """Each I2C write beside the one at its place: time, address and every byte."""
    end = then.end_us
    differences = []
    for old, new in zip_longest(then.writes, (write for write in now.writes if write[0] <= end)):
        if old != new:
            time = min(write[0] for write in (old, new) if write)
            differences.append(Difference(time, old and old[1:], new and new[1:]))
    return Comparison(len(then.writes), differences)


def _conduct(decision: Decision) -> tuple:
    return decision.af, decision.ar, decision.v, decision.mode, decision.window, decision.zone, decision.why
