"""From what was written down for each tape to the figures of each stage."""

from dataclasses import dataclass, field

import numpy as np

from . import costs
from .measure import KINDS

BUDGET_MS = {"frame": 1.5, "guard": 5.0, "decision": 5.0, "act": 5.0, "reaction": 12.0}
WORDS = {
    "frame": "parse, check, place, forget: one frame of the lidar",
    "guard": "what is driven now tested against all points, on every frame",
    "decision": "one slice of the decision",
    "act": "steering of all wheels, register bursts of three chips",
    "reaction": "last byte that shows something new to first register byte",
}
POLL, PLACE, GUARD, WORK, UPDATE, COMMAND, POINTS, PAPER, PLAIN, FEED, TURN, STOP, _START, PAPER_FULL = (KINDS.index(name) for name in KINDS[1:])


@dataclass
class Samples:
    """What each occurrence of a stage took, us. `whole` is a decision with all its slices; those that only went on with a plan are none.

    points: (n, 2) points seen, in windows.
    paper, full, plain: what a baseline took; paper_of and so on: what the same decisions took here, in the same order. `paper` is of all decisions,
    those among them that only went on with a plan, `full` and `plain` of those that are `whole`. count: of all decisions.
    """

    frame: list = field(default_factory=list)
    guard: list = field(default_factory=list)
    decision: list = field(default_factory=list)
    act: list = field(default_factory=list)
    reaction: list = field(default_factory=list)
    whole: list = field(default_factory=list)
    paper: list = field(default_factory=list)
    paper_of: list = field(default_factory=list)
    full: list = field(default_factory=list)
    full_of: list = field(default_factory=list)
    plain: list = field(default_factory=list)
    plain_of: list = field(default_factory=list)
    points: list = field(default_factory=list)
    count: int = 0

    def extend(self, other):
        """Add those of another tape."""
        for name, values in vars(other).items():
            if name == "count":
                self.count += values
            else:
                getattr(self, name).extend(values)


def samples(log, modelled):
    """Samples of one log. modelled: its values are instructions on the ESP32, and the bus counts; else us here, and it does not."""
    out = Samples()
    scale = costs.us(1) if modelled else 1.0
    frame = whole = since = command = 0.0
    last = last_whole = 0.0  # what the decision made last took: since the one before, and with all its slices if it was made in full
    period, before, turn, waited = 1e4, None, 0.0, 0.0
    pending = None  # what a reaction has taken until now, and when the guard saw it
    for kind, value, extra, now in log.rows.tolist():
        us = value * scale
        if kind == POLL:
            if frame:
                out.frame.append(frame)
            frame, command = us, 0.0
            waited = extra
            if before is not None and 0 < now - before < 20_000:
                period = 0.9 * period + 0.1 * (now - before)
            before = now
        elif kind == PLACE:
            frame += us
        elif kind == GUARD:
            out.guard.append(us)
            if extra and pending is None:
                # The frame waits for the loop to come round: for its sleep to end, or for what is left of a long turn.
                pending = (max(waited, turn - period) if modelled else 0.0) + frame + us, now
        elif kind == WORK:
            out.decision.append(us)
            whole += us if extra < 2 else 0.0
            since += us
            if extra:
                out.count += 1
                last, since = since, 0.0
            if extra == 1:
                out.whole.append(whole)
                last_whole, whole = whole, 0.0
        elif kind == COMMAND:
            command += us
        elif kind == STOP:
            if pending:
                # The guard stops the motors itself: no servo period is waited for.
                out.reaction.append(pending[0] + us)
                pending = None
        elif kind == UPDATE:
            if extra:
                out.act.append(command + us + (extra if modelled else 0))
                if pending:
                    taken, seen = pending
                    # The burst begins where the computing ends; until then the servo period may have to be waited for.
                    out.reaction.append(taken + command + us + (now - extra - seen if modelled else 0))
            pending = None  # nothing to write: the motors were off already
            command = 0.0
        elif kind == POINTS:
            out.points.append((value, extra))
        elif kind == PAPER:
            out.paper.append(us)
            out.paper_of.append(last)
        elif kind == PAPER_FULL:
            out.full.append(us)
            out.full_of.append(last_whole)
        elif kind == PLAIN:
            out.plain.append(us)
            out.plain_of.append(last_whole)
        elif kind == TURN:
            turn = extra * scale
    return out


def figures(here, modelled, heap):
    """The object that --json prints. here, modelled: Samples of all tapes; heap: what `Bench.heap` gave for each tape."""
    stages = {}
    for name in BUDGET_MS:
        us, chip = getattr(here, name), getattr(modelled, name)
        stages[name] = {
            "worst_ms_esp32": _round(max(chip) / 1000) if chip else None,
            "median_ms_esp32": _round(np.median(chip) / 1000) if chip else None,
            "best_us_here": _round(min(us)) if us else None,
            "median_us_here": _round(np.median(us)) if us else None,
            "worst_us_here": _round(max(us)) if us else None,
            "samples": len(chip),
        }
    return {
        "stages": stages,
        "whole_decision": {
            "worst_ms_esp32": _round(max(modelled.whole) / 1000),
            "median_ms_esp32": _round(np.median(modelled.whole) / 1000),
            "worst_us_here": _round(max(here.whole)),
            "median_us_here": _round(np.median(here.whole)),
        },
        "heap_bytes_per_loop": max(one["worst"] for one in heap),
        "buffers_bytes_esp32": max(one["buffers"] for one in heap),
        "ratio_to_paper": _ratio(here.paper, here.paper_of),
        "ratio_to_paper_in_full": _ratio(here.full, here.full_of),
        "ratio_to_plain": _ratio(here.plain, here.plain_of),
    }


def steps(bench, logs):
    """Inner steps of the worst occurrence of each part: {part: [(module.function:line, times, share of its time)]}, the dearest loops first."""
    out = {}
    for part in ("poll", "place", "guard", "work", "update"):
        worst = max(logs, key=lambda log: _cost(bench, log.worst[part])).worst[part]
        total = _cost(bench, worst)
        found: dict[str, tuple[int, int]] = {}
        for block in bench.blocks:
            if worst[block.number]:
                loop = bench.blocks[block.inside]
                name = f"{block.module}.{block.function}" + (f":{loop.line}" if loop.loop else "")
                times, cost = found.get(name, (0, 0))
                found[name] = max(times, int(worst[loop.number])), cost + int(worst[block.number]) * block.instructions
        ranked = sorted(found.items(), key=lambda item: -item[1][1])
        out[part] = [(name, times, cost / total) for name, (times, cost) in ranked[:6] if cost > 0.03 * total]
    return out


def _cost(bench, counters):
    return sum(int(n) * block.instructions for n, block in zip(counters, bench.blocks) if n)


def _ratio(theirs, ours):
    """How many times longer the same decisions took in all."""
    return _round(sum(theirs) / sum(ours)) if ours else None


def _round(value):
    return round(float(value), 3)
