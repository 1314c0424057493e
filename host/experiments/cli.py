"""Command line of the experiments."""

import argparse
import os
import sys
from pathlib import Path

from host.twin import image
from host.version import add_version

from . import campaign, plan, planners, report
from .store import Store

STORE = image.ROOT / "out" / "experiments.jsonl"
SEEDS = 5
QUICK_FOLDER = image.ROOT / "out" / "experiments-quick"


def main(arguments=None):
    """Run the experiments; returns the exit code: 0 done, 1 broken off or a run failed, 2 bad arguments."""
    options = _parser().parse_args(arguments)
    runs = plan.plan(options.quick, options.seeds)
    _, sources = planners.snapshot()
    store = Store(options.store)
    try:
        with campaign.executor(options.cluster, options.workers) as pool:
            done = campaign.complete(runs, sources, store, pool)
    except (campaign.ClusterMissing, image.ToolMissing) as error:
        print(f"python -m host.experiments: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("broken off; the same command goes on from here", file=sys.stderr)
        return 1
    except Exception as error:
        print(f"python -m host.experiments: a run failed, the others are kept: {type(error).__name__}: {error}", file=sys.stderr)
        return 1
    given = (" --quick" if options.quick else "") + (f" --seeds {options.seeds}" if options.seeds != SEEDS and not options.quick else "")
    folder = options.out or (QUICK_FOLDER if options.quick else image.ROOT / "docs")
    report.write(done, sources, given, folder)
    print(f"written: {folder / 'results.md'}")
    return 0


def _parser():
    parser = argparse.ArgumentParser(
        prog="python -m host.experiments",
        description="Run the papers' experiments in the twin and write docs/results.md.",
        epilog="Finished runs are kept: the same command goes on where it was broken off. Exit code: 0 done, 1 broken off or a run failed, 2 bad arguments",
    )
    add_version(parser)
    add = parser.add_argument
    add("--quick", action="store_true", help="a taste of every section, a minute or one and a half on two cores, written to out/experiments-quick")
    add("--seeds", type=_positive, default=SEEDS, metavar="N", help=f"runs for each width of the pass rates (default {SEEDS})")
    add("--workers", type=_positive, default=os.cpu_count(), metavar="N", help="processes on this machine (default: one a core)")
    add("--cluster", metavar="ADDRESS", help="hand the runs to the Dask cluster whose scheduler is there, tcp://host:8786")
    add("--store", type=Path, default=STORE, metavar="FILE", help="finished runs (default out/experiments.jsonl)")
    add("--out", type=Path, metavar="FOLDER", help="where results.md goes (default docs)")
    return parser


def _positive(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be at least 1")
    return value
