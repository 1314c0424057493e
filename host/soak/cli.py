"""Command line of the soak."""

import argparse
import json
import os
import sys
import time
from pathlib import Path

from host.experiments import campaign, planners
from host.experiments.store import Store
from host.twin import image
from host.version import add_version

from . import plan, report
from .execute import execute

STORE = image.ROOT / "out" / "soak" / "cases.jsonl"
HOURS = 24.0  # robot hours to reach
AHEAD = 3  # cases a worker is given at a time


def main(arguments=None):
    """Drive on; returns the exit code: 0 done, 1 broken off, a case failed, or with --check one broke a promise, 2 bad arguments."""
    options = _parser().parse_args(arguments)
    _, sources = planners.snapshot()
    if options.case is not None:
        print(json.dumps(execute(plan.case(options.seed, options.case), sources), indent=1))
        return 0
    store = Store(options.store)
    code = 0
    fresh = []
    try:
        with campaign.executor(options.cluster, options.workers) as pool:
            fresh = _drive(options, sources, store, pool)
    except (campaign.ClusterMissing, image.ToolMissing) as error:
        print(f"python -m host.soak: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("broken off; the same command goes on from here", file=sys.stderr)
        code = 1
    except Exception as error:
        print(f"python -m host.soak: a case failed, the others are kept: {type(error).__name__}: {error}", file=sys.stderr)
        code = 1
    entries = list(store.done.values())
    if options.json:
        print(json.dumps(report.figures(entries)))
    else:
        print(report.markdown(entries))
    if options.write:
        report.write(report.markdown(entries))
    if options.check and report.broken(fresh):
        return 1
    return code


def _drive(options, sources, store, pool):
    """Case after case until there is enough of them, or no time left; the entries that are new."""
    until = time.monotonic() + options.minutes * 60 if options.minutes else float("inf")
    number = 0
    fresh = []
    while report.hours(store.done.values()) < options.hours and time.monotonic() < until:
        some: list[plan.Case] = []
        while len(some) < AHEAD * options.workers:
            case = plan.case(options.seed, number)
            if case.key(sources) not in store.done:
                some.append(case)
            number += 1
        fresh += campaign.complete(some, sources, store, pool, quiet=True, work=execute).values()
        done = report.figures(list(store.done.values()))
        print(
            f"{done['robot_hours']:.2f} h, {done['cases']} cases, {sum(bool(entry['bad']) for entry in fresh)} of the new ones badly",
            file=sys.stderr,
            flush=True,
        )
    return fresh


def _parser():
    parser = argparse.ArgumentParser(
        prog="python -m host.soak",
        description="Drive the firmware in the twin through random courses, rooms and faults, and say what came of it.",
        epilog="Finished cases are kept: the same command goes on where it was broken off. Recordings of what went badly lie in out/soak. Exit code: 0 done, "
        "1 broken off, a case failed, or with --check a new one broke a promise, 2 bad arguments",
    )
    add_version(parser)
    add = parser.add_argument
    add("--minutes", type=float, metavar="M", help="no new cases after so long (default: on and on)")
    add("--hours", type=float, default=HOURS, metavar="H", help=f"robot hours to reach in all (default {HOURS:g})")
    add("--seed", type=int, default=1, metavar="N", help="of the campaign: others have other cases (default 1)")
    add("--case", type=int, metavar="K", help="drive this one case of the campaign again, and print it")
    add("--workers", type=_positive, default=os.cpu_count(), metavar="N", help="processes on this machine (default: one a core)")
    add("--cluster", metavar="ADDRESS", help="hand the cases to the Dask cluster whose scheduler is there, tcp://host:8786")
    add("--store", type=Path, default=STORE, metavar="FILE", help="finished cases (default out/soak/cases.jsonl)")
    add("--check", action="store_true", help="exit code 1 after a contact because of a fault, a hang, an exception in a new case")
    add("--write", action="store_true", help="write the report into docs/safety.md")
    add("--json", action="store_true", help="print the sums as JSON")
    return parser


def _positive(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be at least 1")
    return value
