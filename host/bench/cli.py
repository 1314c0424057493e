"""Command line of the bench."""

import argparse
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tqdm import tqdm

from host.twin import image
from host.version import add_version

from . import calibrate, decisions, figures, scans, stages
from .machine_code import FormatError
from .measure import Bench, BenchError

BUFFERS_BUDGET = 70_000
START_BUDGET_MS = 4000
TURN_BUDGET_MS, LINK_BUDGET_MS = 9.5, 1.5
RATIO_TO_PAPER, RATIO_TO_PLAIN = 100, 20
WORKERS = 2
PAPER_EACH, PLAIN_EACH = 64, 2  # decisions of each tape that the baselines make as well: the plain one takes a second for one


def main(arguments=None):
    """Run the bench; returns the exit code: 0 done, 1 decisions differ, 2 bad arguments or the firmware did not run."""
    options = _parser().parse_args(arguments)
    try:
        image.compiled(Path(options.firmware))
        if options.decisions:
            return _compare(options)
        if options.calibrate:
            return _calibrate(options)
        if options.all_courses:
            found = worst(scans.ALL, options.firmware, quiet=options.json)
        else:
            found, inner = measure(scans.QUICK if options.quick else scans.COURSES, options.firmware, quiet=options.json)
            found |= figures.times(Path(options.firmware))
    except (BenchError, FormatError, image.ToolMissing, SyntaxError, ValueError) as error:
        print(f"python -m host.bench: {error}", file=sys.stderr)
        return 2
    if options.json:
        print(json.dumps(found))
    elif options.all_courses:
        print(report_worst(found))
    else:
        print(report(found, inner))
    return 0


def measure(courses=scans.COURSES, firmware=image.FIRMWARE, quiet=True):
    """(figures, inner steps) over the courses; see stages.figures and stages.steps."""
    here, modelled, heap, logs = stages.Samples(), stages.Samples(), [], []
    tapes = _tapes(courses, firmware, quiet)
    bench = Bench(firmware)

    def play(tape):
        counted = bench.count(tape)
        found = stages.samples(counted, True)
        if tape.surprise:
            return tape, counted, bench.time(tape, repeats=1), None
        return tape, counted, bench.time(tape, (found.count, len(found.whole), PAPER_EACH, PLAIN_EACH)), bench.heap(tape)

    with ThreadPoolExecutor(WORKERS) as pool, tqdm(total=len(tapes), desc="playing them back", disable=quiet or None) as bar:
        for _tape, counted, timed, grown in pool.map(play, tapes):
            logs.append(counted)
            for into, log, chip in ((modelled, counted, True), (here, timed, False)):
                into.extend(stages.samples(log, chip))
            if grown:
                heap.append(grown)
            bar.update()
    return stages.figures(here, modelled, heap), stages.steps(bench, logs)


def _compare(options):
    """Print whether two firmwares do the same."""
    with tqdm(desc="playing to both firmwares", unit=" tapes", disable=options.json or None) as bar:
        found = decisions.compare(options.decisions, scans.QUICK if options.quick else scans.COURSES, options.firmware, bar.update)
    text, code = decisions.report(found)
    print(text)
    return code


def _calibrate(options):
    """Print what the twin's prices make of the firmware's work, and fit them to it."""
    with tqdm(desc="counting", unit=" tapes", disable=options.json or None) as bar:
        named, calls = calibrate.rows(calibrate.COURSES[:1] if options.quick else calibrate.COURSES, Path(options.firmware), bar.update)
    fitted = calibrate.fit(named, calls)
    print("With the prices in use (host/twin/board/prices.py):\n\n" + calibrate.report(named, calls, calibrate.committed()["OF"]))
    if options.write:
        calibrate.write(fitted)
        print("\nThe twin has the fitted prices now.")
    else:
        print("\nFitted:\n\n" + calibrate.listing(fitted))
    return 0


def _tapes(courses, firmware, quiet):
    with tqdm(total=len(courses), desc="driving the courses", disable=quiet or None) as bar:
        return scans.tapes(courses, firmware, WORKERS, bar.update)


def worst(courses=scans.ALL, firmware=image.FIRMWARE, quiet=True):
    """{"runs": how many, "stages": {stage: {"worst_ms_esp32", "course" in which}}}, modelled only."""
    tapes = _tapes(courses, firmware, quiet)
    bench = Bench(firmware)
    found: dict[str, tuple[float, str]] = {}
    with ThreadPoolExecutor(WORKERS) as pool, tqdm(total=len(tapes), desc="playing them back", disable=quiet or None) as bar:
        for tape, log in zip(tapes, pool.map(bench.count, tapes), strict=True):
            samples = stages.samples(log, True)
            for name in stages.BUDGET_MS:
                dearest = max(getattr(samples, name), default=0.0) / 1000
                if dearest > found.get(name, (0.0, ""))[0]:
                    found[name] = dearest, tape.name + (", surprised" if tape.surprise else "")
            bar.update()
    rows = {name: {"worst_ms_esp32": round(dearest, 3), "course": course} for name, (dearest, course) in found.items()}
    return {"runs": len(tapes), "stages": rows}


def report_worst(found):
    """What worst() gave as a table."""
    lines = [f"The worst of {found['runs']} runs, ms on the ESP32 (modelled)", "", f"{'stage':10}{'worst':>9}{'budget':>9}   course"]
    for name, row in found["stages"].items():
        mark = "!" if row["worst_ms_esp32"] > stages.BUDGET_MS[name] else " "
        lines.append(f"{name:10}{_cell(row['worst_ms_esp32'], 2)}{stages.BUDGET_MS[name]:9.1f} {mark} {row['course']}")
    return "\n".join(lines)


def report(found, inner):
    """The figures as a table, the budgets beside them."""
    lines = [
        f"{'':10}{'ESP32, ms (modelled)':^30}{'here, us (MicroPython)':^32}",
        f"{'stage':10}{'median':>9}{'worst':>9}{'budget':>9}   {'best':>9}{'median':>9}{'worst':>9}   what",
    ]
    for name, stage in found["stages"].items():
        worst, budget = stage["worst_ms_esp32"], stages.BUDGET_MS[name]
        mark = " " if worst is None or worst <= budget else "!"
        lines.append(
            f"{name:10}{_cell(stage['median_ms_esp32'], 2)}{_cell(worst, 2)}{budget:9.1f} {mark} "
            f"{_cell(stage['best_us_here'])}{_cell(stage['median_us_here'])}{_cell(stage['worst_us_here'])}   {stages.WORDS[name]}"
        )
    whole = found["whole_decision"]
    lines.append(
        f"{'whole':10}{_cell(whole['median_ms_esp32'], 2)}{_cell(whole['worst_ms_esp32'], 2)}{'':9}   "
        f"{'':9}{_cell(whole['median_us_here'])}{_cell(whole['worst_us_here'])}   all slices of a decision; going on with a plan is none"
    )
    lines += ["", f"{'':54}{'now':>9}{'to reach':>10}"]
    rows: tuple[tuple[str, float | None, str], ...] = (
        ("main.py's first line to first decision, modelled, ms", found["start_ms_esp32"], f"{START_BUDGET_MS}"),
        ("worst turn, screen and raw scans on, modelled, ms", found["turn_worst_ms_esp32"], f"{TURN_BUDGET_MS}"),
        ("  ... of which link.update, worst", found["link_worst_ms_esp32"], f"{LINK_BUDGET_MS}"),
        ("heap taken by a loop in the steady state, bytes", found["heap_bytes_per_loop"], "0"),
        ("buffers and tables on the ESP32, bytes", found["buffers_bytes_esp32"], f"{BUFFERS_BUDGET}"),
        ("times faster than the papers' iteration", found["ratio_to_paper"], f"{RATIO_TO_PAPER}"),
        ("  ... those alone that do not go on with a plan", found["ratio_to_paper_in_full"], ""),
        ("times faster than the swept test untabled", found["ratio_to_plain"], f"{RATIO_TO_PLAIN}"),
    )
    for words, value, limit in rows:
        lines.append(f"{words:54}{value if isinstance(value, int) else format(value or 0, '.1f'):>9}{limit:>10}")
    lines += ["", "Inner steps of the worst of each part (function: line of the loop, times, share of the part's time):"]
    for part, shares in inner.items():
        lines.append(f"  {part:8}" + "; ".join(f"{name} {times} {share:.0%}" for name, times, share in shares))
    lines += ["", "! over budget. ESP32: executed instructions x CPI 2 at 240 MHz, bus at 400 kHz; the assumptions are in host/bench/costs.py."]
    return "\n".join(lines)


def _cell(value, digits=0):
    return f"{'-':>9}" if value is None else f"{value:9.{digits}f}"


def _parser():
    parser = argparse.ArgumentParser(
        prog="python -m host.bench",
        description="Measure how long the firmware's stages take, here and on the ESP32 (modelled).",
        epilog="exit code: 0 done, 1 decisions differ, 2 bad arguments, nothing compared, or the firmware did not run",
    )
    add_version(parser)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--calibrate", action="store_true", help="compare what the twin charges for computing with what is executed, and fit its prices")
    parser.add_argument("--write", action="store_true", help="with --calibrate: put the fitted prices into host/twin/board/prices.py")
    parser.add_argument("--quick", action="store_true", help="two short runs instead of thirteen long ones")
    which.add_argument("--all-courses", action="store_true", help="the worst of each stage over a hundred runs of all kinds, modelled only; ten minutes")
    which.add_argument("--decisions", metavar="REF", help="compare decisions and register writes with those of a git commit's firmware, or a folder's")
    parser.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    parser.add_argument("--firmware", default=image.FIRMWARE, help="folder of the firmware (default: this one)")
    return parser
