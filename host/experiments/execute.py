"""One run, wherever it happens: what goes in and out can be pickled and is small."""

from dataclasses import asdict

import numpy as np

from host.twin import Observer
from host.twin import run as drive

from . import plan, planners

LARGE_HEAP = 4 * 1024 * 1024
TRACK_S = 0.05  # no more poses than one in this time are kept


STANDS_S = 12.0  # longer than a wall holds the body before the twin calls it blocked


class _Patience(Observer):
    """Ends a run in which the robot stands: a planner without a memory will not think of anything else."""

    def __init__(self):
        self._at = None
        self._since = 0.0

    def step(self, simulation):
        at = round(simulation.body.x / 10), round(simulation.body.y / 10)
        if at != self._at:
            self._at, self._since = at, simulation.now
        elif simulation.now - self._since > STANDS_S * 1e6:
            simulation.stop("timeout", f"stood still for {STANDS_S:g} s")


def execute(run, sources):
    """Drive a plan.Run with the sources of that hash; returns a dict that JSON can hold. Called on workers too."""
    firmware = planners.firmware(run.planner, sources)
    # The others compute with lists and floats: they are compared by what they decide, not by the heap they need.
    heap = None if run.planner in (plan.AWS, plan.NAWS) else LARGE_HEAP
    if run.timed:
        return _head(run, sources) | _timed(run, firmware)
    done = drive(
        run.course,
        run.width,
        run.gap,
        run.seed,
        run.mode,
        config=firmware / "robot.json",
        reverse=run.reverse,
        firmware=firmware,
        record=False,
        heap=heap,
        watch=None if run.planner in (plan.AWS, plan.NAWS) else _Patience(),
    )
    out = _head(run, sources) | {"result": done.result, "reason": done.reason[:300], "time_s": round(done.time_s, 3), "contacts": done.contacts}
    out |= {"clearance_mm": round(done.min_clearance_mm, 1), "decisions": done.decisions, "wall_s": round(done.wall_s, 2)}
    out |= done.against_best()
    out |= {name: getattr(done, name) for name in ("first_motion_s", "stops", "reversals")}
    out |= {"path_mm": round(done.path_mm), "steering_deg": round(done.steering_deg)}
    if run.shown:
        steps = np.unique((done.track[:, 0] / TRACK_S).astype(int), return_index=True)[1]
        out["track"] = np.round(done.track[np.append(steps, len(done.track) - 1)], 2).tolist()
        out["log"] = [[round(d.time_us / 1e6, 3), d.af / 10, d.ar / 10, d.v, d.window, d.why] for d in done.log]
        out["touches"] = [[round(value, 2) for value in touch] for touch in done.touches]
    return out


def _head(run, sources):
    return {"key": run.key(sources), "sources": sources, "run": asdict(run)}


def _timed(run, firmware):
    """Decision times and numbers of points of one run, from the bench."""
    from host.bench import scans, stages
    from host.bench.measure import Bench

    course = {"course": run.course, "width": run.width, "seed": run.seed, "mode": run.mode}
    tape = next(tape for tape in scans.tapes([course], firmware, 1) if not tape.surprise)
    bench = Bench(firmware)
    chip, here = stages.samples(bench.count(tape), True), stages.samples(bench.time(tape, repeats=1), False)
    return {
        "chip_ms": [round(us / 1000, 3) for us in chip.whole],
        "slice_ms": round(max(chip.decision) / 1000, 3),
        "here_ms": [round(us / 1000, 4) for us in here.whole],
        "measured": scans.returns(tape),
        "points": [list(pair) for pair in chip.points],
    }
