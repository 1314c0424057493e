"""Fields of cylinders as in the BARN data set, one after the other.

    python -m host.experiments.fields [--seeds N] [--first N] [--jobs N]

One line a field, then a summary. A field that no robot of this size can pass is told, and does not count. Exit code 1 if the robot touched something, or is not through one that can
be passed.
"""

import argparse
import sys
from concurrent.futures import ThreadPoolExecutor

from host.twin import run
from host.twin.fields import field


def one(seed):
    """(Result, its figures against the best) of a field."""
    result = run(field(seed), seed=seed + 1, record=False)
    return result, result.against_best()


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m host.experiments.fields", description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=300, metavar="N", help="how many (default 300)")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="the first of them (default 0)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="at a time (default 2)")
    options = parser.parse_args(arguments)
    if options.seeds < 1 or options.jobs < 1 or options.first < 0:
        parser.error("--seeds and --jobs must be 1 or more, --first 0 or more")
    seeds = range(options.first, options.first + options.seeds)
    passable = passed = touched = 0
    ratios = []
    with ThreadPoolExecutor(options.jobs) as pool:
        for seed, (result, best) in zip(seeds, pool.map(one, seeds)):
            text = "no way" if best["best_s"] is None else f"{best['time_over_best'] or '-'} times the best {best['best_s']} s"
            print(
                f"field {seed}: {result.result} after {result.time_s:.1f} s, {text}, clearance {result.min_clearance_mm:.0f} mm, contacts {result.contacts}",
                flush=True,
            )
            touched += result.contacts > 0
            if best["best_s"] is not None:
                passable += 1
                passed += result.result == "pass"
                ratios += [best["time_over_best"]] if best["time_over_best"] else []
    ratios.sort()
    text = f"{passed} of {passable} that can be passed were, {touched} touched"
    print(text + (f"; time over the best: median {ratios[len(ratios) // 2]:.2f}, worst {ratios[-1]:.2f}" if ratios else ""))
    return 0 if passed == passable and not touched else 1


if __name__ == "__main__":
    sys.exit(main())
