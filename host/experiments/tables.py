"""From finished runs to the tables of docs/results.md."""

import numpy as np

from . import plan

PAPER_TABLE_3 = {
    plan.AWS: {620: "pass", 600: "pass", 580: "pass", 550: "pass", 500: "local collision"},
    plan.NAWS: {620: "pass", 600: "pass", 580: "local collision", 550: "local collision", 500: "no pass"},
}
PAPER_UP_TO_20_MS = 96.0  # %, figure 23 of paper A
PAPER_POINTS = 608, 74  # figure 11
_GRADES = ("pass", "local collision", "no pass")


def markdown(head, rows):
    """A table in Markdown; head and rows are lists of strings."""
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows])


def grade(entry):
    """The paper's words for how a run ended."""
    return {"pass": "pass", "local_collision": "local collision"}.get(entry["result"], "no pass")


def counts(entries):
    """ "7 pass, 1 local collision" of several runs."""
    grades = [grade(entry) for entry in entries]
    return ", ".join(f"{grades.count(word)} {word}" for word in _GRADES if word in grades)


def rates(done):
    """{planner: {width: (passed without touching, runs)}} of the Z course, at the widths driven with all seeds."""
    out: dict = {}
    for run, entry in done.items():
        if run.course == "Z" and not run.timed:
            passed, runs = out.setdefault(run.planner, {}).get(run.width, (0, 0))
            out[run.planner][run.width] = passed + (entry["result"] == "pass"), runs + 1
    most = {planner: max(runs for _, runs in widths.values()) for planner, widths in out.items()}
    return {planner: {width: found for width, found in widths.items() if found[1] == most[planner]} for planner, widths in out.items()}


def table_3(done):
    """Table 3 of paper A, ours beside it: all runs of the five widths."""
    head = ["passage width, mm", *(str(width) for width in plan.PAPER_WIDTHS)]
    rows = []
    for planner in (plan.AWS, plan.NAWS):
        rows.append([f"paper, {planner.upper()}", *(PAPER_TABLE_3[planner][width] for width in plan.PAPER_WIDTHS)])
        ours = []
        for width in plan.PAPER_WIDTHS:
            runs = [entry for run, entry in done.items() if run.planner == planner and run.course == "Z" and run.width == width and not run.timed]
            ours.append(counts(runs) or "-")
        rows.append([f"here, {planner.upper()}", *ours])
    return markdown(head, rows)


def rate_table(found):
    """Pass rates as numbers. found: of `rates`."""
    widths = sorted({width for planner in found.values() for width in planner}, reverse=True)
    rows = [[planner, *("{}/{}".format(*found[planner][width]) if width in found[planner] else "" for width in widths)] for planner in found]
    return markdown(["planner", *(f"{width:g}" for width in widths)], rows)


def last_axle_note(done):
    """What has to be said if the firmware turned the last axle though it was to be held straight."""
    runs = [entry for run, entry in done.items() if run.planner == plan.NAWS and run.shown]
    turned = [entry for entry in runs if any(row[2] for row in entry["log"])]
    if not turned:
        return "In no shown NAWS run the last axle was turned."
    driven = [row for entry in turned for row in entry["log"] if row[2]]
    backing = sum(row[3] < 90 for row in driven)
    return (
        f"Mind: in {len(turned)} of {len(runs)} shown NAWS runs the firmware turned the last axle (AR not 0) in {len(driven)} decisions, "
        f"{backing} of them backing; these runs are kinder than the paper's NAWS."
    )


def run_table(done, course):
    """What became of the shown runs of a course: a row each."""
    rows = []
    for run, entry in done.items():
        if run.shown and run.planner == plan.AWS and run.course in course:
            size = f"gaps of {run.gap:g}" if run.course == "random" else f"{run.width:g}"
            name = f"{run.course}{', from the other end' if run.reverse else ''}"
            rows.append(
                [
                    name,
                    size,
                    str(run.seed),
                    grade(entry),
                    f"{entry['time_s']:.1f}",
                    str(entry["contacts"]),
                    f"{entry['clearance_mm']:.0f}",
                ]
            )
    return markdown(["course", "width, mm", "seed", "result", "time, s", "contacts", "least clearance, mm"], rows)


def ratio_table(done):
    """The time over the best possible, by course and size: a row each, ours only."""
    groups: dict = {}
    for run, entry in done.items():
        if run.planner in (plan.AWS, plan.NAWS) and not run.timed and not run.reverse and "best_s" in entry:
            size = f"gaps of {run.gap:g}" if run.course == "random" else f"{run.width:g}"
            groups.setdefault((run.planner == plan.NAWS, run.course == "random", run.course, -run.gap, -(run.width or 0), size), []).append(entry)
    rows = []
    for (straight, _, course, _, _, size), entries in sorted(groups.items()):
        passed = [entry for entry in entries if entry["result"] == "pass"]
        ratios = sorted(entry["time_over_best"] for entry in passed if entry["time_over_best"] is not None)
        best = sorted(entry["best_s"] for entry in entries if entry["best_s"] is not None)
        row = [f"{course}{', last axle straight' if straight else ''}", size, f"{len(passed)}/{len(entries)}", str(sum(entry["contacts"] for entry in entries))]
        row += [f"{np.median(best):.1f}" if best else "no way"]
        row += [f"{np.median(ratios):.2f}", f"{ratios[-1]:.2f}"] if ratios else ["-", "-"]
        if passed:
            row += [f"{sum(entry['reversals'] == 0 for entry in passed)}/{len(passed)}"]
            row += [f"{np.median([entry[name] for entry in passed]):.0f}" for name in ("stops", "path_mm", "steering_deg")]
        else:
            row += ["-"] * 4
        rows.append(row)
    head = [
        "course",
        "width or gap, mm",
        "passed",
        "contacts",
        "best, s",
        "time / best, median",
        "worst",
        "without reversal",
        "stops",
        "way, mm",
        "steering, deg",
    ]
    return markdown(head, rows)


def classes(times):
    """Share in % of decision times, ms: at most 10, 10 to 20, above 20."""
    times = np.asarray(times)
    return tuple(100 * float(share) for share in ((times <= 10).mean(), ((times > 10) & (times <= 20)).mean(), (times > 20).mean()))


def time_rows(done):
    """[(run, milliseconds of each decision on the ESP32, here, longest slice)] of the timed runs."""
    return [(run, entry["chip_ms"], entry["here_ms"], entry["slice_ms"]) for run, entry in done.items() if run.timed and entry["chip_ms"]]


def time_table(done):
    """Figure 23 as numbers."""
    rows = []
    for run, chip, here, longest in time_rows(done):
        rows.append(
            [
                f"{run.planner.upper()} {run.width:g}",
                str(len(chip)),
                *(f"{share:.1f}" for share in classes(here)),
                *(f"{share:.1f}" for share in classes(chip)),
                f"{np.median(chip):.1f}",
                f"{max(chip):.1f}",
                f"{longest:.1f}",
            ]
        )
    head = ["run", "decisions", "here: up to 10 ms, %", "10-20, %", "above 20, %", "ESP32: up to 10 ms, %", "10-20, %", "above 20, %"]
    return markdown([*head, "ESP32 median, ms", "longest, ms", "longest slice, ms"], rows)


def point_table(done):
    """Points before and after windowing."""
    rows = [["paper", str(PAPER_POINTS[0]), "", str(PAPER_POINTS[1])]]
    for run, entry in done.items():
        if run.timed and entry["points"]:
            seen, inside = np.median(np.array(entry["points"]), axis=0)
            rows.append([f"here, {run.planner.upper()} Z {run.width:g}", str(entry["measured"]), f"{seen:.0f}", f"{inside:.0f}"])
    return markdown(["", "measured in a revolution", "remembered, thinned, within reach", "in the windows"], rows)
