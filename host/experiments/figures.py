"""The pictures of docs/results.md, as PNG."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib import pyplot
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from host.twin import courses, load_config
from host.twin.picture import BODY, BOX, FLOOR, OUTSIDE, TOUCHED, WALL, outline, stations, touching_point

from . import plan

LINES = {
    plan.AWS: ("#d1495b", "this robot, all wheels steered"),
    plan.NAWS: ("#1f6f8b", "this robot, last axle straight"),
    plan.RULE24: ("#7a6c9c", "papers' rule (24) as written"),
    plan.DISC_NARROW: ("#e09f3e", "follow the gap, disc as wide as the body"),
    plan.DISC_ROUND: ("#6b705c", "follow the gap, disc round the body"),
}
AF, AR, V = "#d1495b", "#1f6f8b", "#8a8a8a"
LIMIT_MM = 388.9  # (600 + 250) / sqrt 2: no motion passes two right-angle bends narrower than that
_GREY = "#666666"


def pass_rate(rates, path):
    """Share of runs that pass without touching, over the width. rates: {planner: {width: (passed, runs)}}."""
    figure, axes = pyplot.subplots(figsize=(9, 4.6), layout="constrained")
    for planner, widths in rates.items():
        colour, label = LINES[planner]
        xs = sorted(widths)
        ys = [100 * widths[x][0] / widths[x][1] for x in xs]
        axes.plot(xs, ys, "o-", color=colour, label=label, alpha=0.9, linewidth=2.4 if planner == plan.AWS else 1.6, markersize=5, clip_on=False, zorder=5)
    axes.axvline(LIMIT_MM, color=_GREY, linewidth=1, linestyle=":")
    axes.text(LIMIT_MM - 4, 50, f"no motion\npasses below\n{LIMIT_MM} mm", fontsize=8, color=_GREY, va="center", ha="right")
    axes.axvline(600, color=_GREY, linewidth=1, linestyle=":")
    axes.text(604, 50, "body length", fontsize=8, color=_GREY, va="center")
    axes.set(xlabel="width of the Z passage, mm", ylabel="passed without touching, %", ylim=(-1, 101), xlim=(325, max(max(w) for w in rates.values()) + 10))
    axes.grid(axis="y", color="#eeeeee")
    _bare(axes)
    figure.legend(loc="outside upper center", ncols=3, fontsize=8, frameon=False)
    _save(figure, path)


def tracks_and_curves(rows, path):
    """One row a course: the tracks of A and B on the left, AF, AR and V over time on the right.

    rows: [(title, [entry of a shown run])]; the first run's curves are drawn, the tracks of all.
    """
    tall = any(entries[0]["run"]["course"] in ("Z", "U") for _, entries in rows)
    figure, grid = pyplot.subplots(
        len(rows), 2, figsize=(11, (3.3 if tall else 2.3) * len(rows) + 0.3), layout="constrained", width_ratios=(1, 1.25), squeeze=False
    )
    for (title, entries), (left, right) in zip(rows, grid):
        _course(left, entries)
        left.set_title(f"{title}: {verdict(entries[0])}", fontsize=9, loc="left")
        _curves(right, entries)
    handles = [Line2D([], [], color=AF, label="A, middle of the front"), Line2D([], [], color=AR, label="B, middle of the rear")]
    if any(len(entries) > 1 for _, entries in rows):
        handles.append(Line2D([], [], color=_GREY, linestyle="--", linewidth=1, label="dashed: last axle straight"))
    handles.append(Line2D([], [], color=TOUCHED, marker="o", markeredgecolor=WALL, label="touched"))
    figure.legend(handles=handles, loc="outside upper left", ncols=4, fontsize=8, frameon=False)
    _save(figure, path)


def side_by_side(entries, path):
    """The same start, several planners. entries: of shown runs of one course."""
    figure, grid = pyplot.subplots(1, len(entries), figsize=(3.2 * len(entries), 4.0), layout="constrained", squeeze=False)
    for entry, axes in zip(entries, grid[0]):
        _course(axes, [entry], outlines=True)
        axes.set_title(f"{LINES[entry['run']['planner']][1]}\n{verdict(entry)}", fontsize=8.5, loc="left")
    _save(figure, path)


def decision_times(rows, path):
    """Share of the decisions in the three classes of figure 23. rows: [(name, (below 10, 10 to 20, above 20) in %, or None where unknown)]."""
    figure, axes = pyplot.subplots(figsize=(9, 0.42 * len(rows) + 1.2), layout="constrained")
    colours, words = ("#3a7d44", "#e9c46a", "#c8553d"), ("at most 10 ms", "10 to 20 ms", "above 20 ms")
    for i, (_, shares) in enumerate(rows):
        start = 0.0
        for share, colour in zip(shares, colours):
            axes.barh(-i, share, left=start, color=colour, height=0.62)
            if share >= 4:
                axes.text(start + share / 2, -i, f"{share:.0f}", ha="center", va="center", fontsize=8, color="white" if colour != colours[1] else "#333333")
            start += share
    axes.set_yticks([-i for i in range(len(rows))], [name for name, _ in rows], fontsize=8)
    axes.set(xlim=(0, 100), xlabel="share of the decisions, %")
    _bare(axes)
    axes.legend([Line2D([], [], color=c, linewidth=6) for c in colours], words, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=3, fontsize=8, frameon=False)
    _save(figure, path)


def verdict(entry):
    """How a run ended, in words."""
    words = {"pass": "through without touching", "local_collision": "through, but touched", "blocked": "stopped by a wall", "timeout": "not through in 60 s"}
    if "stood still" in entry["reason"]:
        return "stopped by a wall" if entry["contacts"] else "stands: finds no gap"
    return f"{words[entry['result']]}, {entry['time_s']:.1f} s"


def _course(axes, entries, outlines=False):
    """The course with the tracks of the entries; one that is much taller than wide is laid on its side."""
    run = entries[0]["run"]
    layout = courses.make(run["course"], run["width"], run["gap"], run["seed"], reverse=run["reverse"])
    robot = load_config()["robot"]
    half = robot["width"] / 2, robot["length"] / 2
    tracks = [np.array(entry["track"]) for entry in entries]
    low, high = _extent(layout, np.vstack(tracks)[:, 1:3])
    lying = high[1] - low[1] > 1.3 * (high[0] - low[0])
    turn = (lambda points: np.stack([points[..., 1], -points[..., 0]], axis=-1)) if lying else np.asarray
    axes.set_facecolor(OUTSIDE)
    floor = axes.add_patch(Polygon(turn(layout.floor), closed=True, facecolor=FLOOR))
    walls = layout.segments[: len(layout.segments) - 4 * len(layout.boxes)].reshape(-1, 2, 2)
    axes.add_collection(LineCollection(list(turn(walls)), colors=WALL, linewidths=1.6, capstyle="round", zorder=5))
    for box in layout.boxes:
        axes.add_patch(Polygon(turn(box), closed=True, facecolor=BOX, edgecolor=WALL, linewidth=1, zorder=4)).set_clip_path(floor)
    for i, (entry, track) in enumerate(zip(entries, tracks)):
        if i == 0:
            for k in stations(track)[:: 1 if outlines else 2]:
                axes.add_patch(Polygon(turn(outline(track[k, 1:], *half)), closed=True, facecolor=BODY, edgecolor=BODY, alpha=0.13, linewidth=0.5))
            axes.add_patch(Polygon(turn(outline(track[-1, 1:], *half)), closed=True, facecolor="white", edgecolor=WALL, linewidth=1.2, zorder=6))
        heading = np.radians(track[:, 3])
        forward = np.stack([np.sin(heading), np.cos(heading)], axis=1) * half[1]
        style = dict(linewidth=1.5, zorder=8) if i == 0 else dict(linewidth=0.9, linestyle="--", zorder=7)
        axes.plot(*turn(track[:, 1:3] + forward).T, color=AF, **style)
        axes.plot(*turn(track[:, 1:3] - forward).T, color=AR, **style)
        for _, *pose in entry.get("touches", ()):
            axes.plot(*turn(touching_point(pose, half, layout.segments)), "o", color=TOUCHED, markersize=7, markeredgecolor=WALL, zorder=9)
    corners = turn(np.array([low, high]))
    axes.set(xlim=sorted(corners[:, 0]), ylim=sorted(corners[:, 1]), aspect="equal", xticks=[], yticks=[])
    for side in axes.spines.values():
        side.set_visible(False)


def _extent(layout, track):
    """Corners of what is worth showing: the bends or boxes and wherever the robot was, not all of the entrance and the exit."""
    points = layout.segments.reshape(-1, 2)
    low, high = points.min(axis=0) - 40, points.max(axis=0) + 40
    start, goal = np.array(layout.start[:2]), np.array(layout.goal[:2])
    near = np.vstack([track - 400, track + 400, start - 400, start + 400, goal - 400, goal + 400])
    if layout.name == "random":
        near[:2, 0] = low[0], high[0]
    return np.maximum(low, near.min(axis=0)), np.minimum(high, near.max(axis=0))


def _curves(axes, entries):
    end = entries[0]["time_s"]
    for i, entry in enumerate(entries):
        log = np.array([row[:4] for row in entry["log"]], float).reshape(-1, 4)
        log = np.vstack([log, [entry["time_s"], *log[-1, 1:]]]) if len(log) else log
        style = dict(drawstyle="steps-post", linewidth=1.1) if i == 0 else dict(drawstyle="steps-post", linewidth=0.6, linestyle="--", alpha=0.8)
        for column, colour, name in ((1, AF, "AF, deg"), (2, AR, "AR, deg"), (3, V, "V")):
            axes.plot(log[:, 0], log[:, column], color=colour, label=name if i == 0 else None, **style)
    axes.set(xlim=(0, end), ylim=(-95, 130), xlabel="s")
    axes.axhline(0, color="#dddddd", linewidth=0.8, zorder=0)
    axes.legend(loc="lower right", ncols=3, fontsize=7, frameon=False)
    _bare(axes)


def _bare(axes):
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.tick_params(labelsize=8)
    axes.xaxis.label.set_size(9)
    axes.yaxis.label.set_size(9)


def _save(figure, path):
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110, bbox_inches="tight", pad_inches=0.12, metadata={"Software": None})
    pyplot.close(figure)
