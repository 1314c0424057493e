"""Rooms as people have them: how the robot gets on in many of them.

    python -m host.experiments.rooms KIND [--seeds N] [--first N] [--jobs N] [--chip X|inf]

KIND: alley, alley-long, alley-side, hallway, furnished, people, dust. One line a run, then a summary. What a run is held against: an alley against driving straight
out backward, dust against the same run without it. Exit code 1 if a robot touched something by its own motion, or is not through.
"""

import argparse
import math
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from host.twin import Observer, rooms, run
from host.twin.faults.lidar import _Lidar, with_points

KINDS = ("alley", "alley-long", "alley-side", "hallway", "furnished", "people", "dust")
SHARES = 0.01, 0.03
ROLLING = 20.0  # mm/s: faster than this it is under way


class Effect(Observer):
    """Other points in every frame. change(signals, counts, bearings in degrees -180..180) -> signals, counts; counts in quarter mm."""

    def __init__(self, change):
        self._change = change
        self._original: Callable | None = None

    def step(self, simulation):
        if self._original is None:
            self._original = simulation.fault.frame
            self._bearings = _Lidar()
            self._bearings.mount = simulation.lidar.mount
            simulation.fault.frame = self._frame

    def _frame(self, time, data):
        def change(signals, counts):
            return self._change(signals, counts, self._bearings.bearings(data))

        assert self._original is not None
        return self._original(time, with_points(data, change))


class Dust(Effect):
    """A share of the beams ends at something that is not there, 200 to 1200 mm off."""

    def __init__(self, share):
        random = np.random.default_rng(5)

        def change(signals, counts, bearings):
            false = random.random(len(counts)) < share
            return np.where(false, 50, signals), np.where(false, random.integers(800, 4800, len(counts)), counts)

        super().__init__(change)


def under_way_s(result):
    """Time from the first motion to the end, s."""
    track = result.track
    speed = np.hypot(np.diff(track[:, 1]), np.diff(track[:, 2])) / np.maximum(np.diff(track[:, 0]), 1e-3)
    moving = np.flatnonzero(speed > ROLLING)
    return float(track[-1, 0] - track[moving[0], 0]) if len(moving) else 0.0


def straight_out_s(result, cruise=108):
    """How long driving straight out of an alley backward takes at cruising speed, s: from the start until the centre is over the goal's line."""
    x, y, heading, _ = result.layout.goal
    way = (x - result.layout.start[0]) * math.sin(heading) + (y - result.layout.start[1]) * math.cos(heading)
    return way / (result.vehicle.full_speed * (cruise - 90) / 90)


def runs(kind, seed, **more):
    """[(what, Result)] of one seed."""
    if kind.startswith("alley"):
        size = dict(width=560, length=3500) if kind == "alley-long" else dict(side=kind == "alley-side")
        return [(kind, run("alley", seed=seed, limit_s=60, record=False, **size, **more))]
    if kind == "dust":
        course = (dict(course="Z", width=600), dict(course="Z", width=550), dict(course="random", gap=400))[seed % 3]
        return [(f"dust {share:.0%}", run(seed=seed, watch=Dust(share), limit_s=90, record=False, **course, **more)) for share in (0, *SHARES)]
    course = getattr(rooms, kind)(seed)
    return [(course.name, run(course, seed=seed + 1, record=False, **more))]


def tell(kind, seed, found):
    """A line for each run; returns [(passed, contacts, ratio or None)]."""
    out = []
    for what, result in found:
        took = under_way_s(result)
        against = straight_out_s(result) if kind in ("alley", "alley-long") else under_way_s(found[0][1]) if kind == "dust" else None
        ratio = took / against if against else None
        out.append((result.result == "pass", result.contacts, ratio))
        text = f"{what} {seed}: {result.result} after {took:.1f} s under way" + (f", {ratio:.2f} of what it is held against" if ratio else "")
        text += f", least clearance {result.min_clearance_mm:.0f} mm, contacts {result.contacts}, touched by others {result.touched_by}"
        print(text + (f" ({result.reason})" if result.reason else ""), flush=True)
    return out


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m host.experiments.rooms", description=__doc__.split("\n")[0])
    parser.add_argument("kind", choices=KINDS, metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--seeds", type=int, default=30, metavar="N", help="how many (default 30)")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="the first of them (default 0)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="at a time (default 2)")
    parser.add_argument("--chip", type=float, default=1.0, metavar="X|inf", help="factor on the speed of the ESP32 that computes (default 1)")
    options = parser.parse_args(arguments)
    if options.seeds < 1 or options.jobs < 1 or options.first < 0:
        parser.error("--seeds and --jobs must be 1 or more, --first 0 or more")
    seeds = range(options.first, options.first + options.seeds)
    told = []
    with ThreadPoolExecutor(options.jobs) as pool:
        for seed, found in zip(seeds, pool.map(lambda seed: runs(options.kind, seed, chip=options.chip), seeds)):
            told += tell(options.kind, seed, found)
    passed, touched = sum(t[0] for t in told), sum(1 for t in told if t[1])
    ratios = sorted(t[2] for t in told if t[2] and t[2] != 1)
    text = f"{passed} of {len(told)} passed, {touched} touched"
    print(text + (f"; ratio median {ratios[len(ratios) // 2]:.2f}, worst {ratios[-1]:.2f}" if ratios else ""))
    return 0 if passed == len(told) and not touched else 1


if __name__ == "__main__":
    sys.exit(main())
