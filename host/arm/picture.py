"""A trajectory drawn: the arm at intervals, the path of its end, the obstacles; angle, speed, acceleration and torque of each joint with their limits; and an animation."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib import pyplot
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon

from . import dynamics, kinematics
from .errors import ArmError
from .reach import Reach
from .scenes import Box, Disc

JOINTS = ("#1f6f8b", "#d1495b", "#e09f3e", "#6a4c93", "#3a7d44", "#6b705c")
OBSTACLE, PATH, GREY, PLAYED = "#b8b8b8", "#d1495b", "#777777", "#222222"
_SHOWN = 11  # poses of the arm


def draw(reach: Reach, path: str | Path, played=None, title: str = "") -> None:
    """Draw into a file (.png, .svg or .pdf). played: rehearse.Played, what the firmware in the twin made of it. ArmError if it cannot be written."""
    figure = pyplot.figure(figsize=(11, 9.2), layout="constrained")
    parts = np.array(figure.subfigures(2, 1, height_ratios=(1.1, 1)))
    axes = parts[0].subplots()
    _scene(axes, reach)
    when = np.linspace(0, reach.total, _SHOWN)
    points = kinematics.points(reach.arm, reach.at(when)[0])
    for k, one in enumerate(points):
        ends = k in (0, len(points) - 1)
        shade = 1.0 if ends else 0.25 + 0.3 * k / len(points)
        axes.plot(*one.T, "-", color=JOINTS[0], alpha=shade, linewidth=3 if ends else 1.6, solid_capstyle="round", zorder=3)
        axes.plot(*one[:-1].T, "o", color="white", markeredgecolor=JOINTS[0], alpha=shade, markersize=6 if ends else 3.5, zorder=4)
    dense = kinematics.points(reach.arm, reach.at(np.linspace(0, reach.total, 400))[0])[:, -1]
    axes.plot(*dense.T, color=PATH, linewidth=1.8, zorder=5, label="path of the end")
    nodes = kinematics.points(reach.arm, reach.q)[:, -1]
    axes.plot(*nodes[1:-1].T, "o", color="white", markeredgecolor=PATH, markersize=7, zorder=6, label="node")
    if played is not None:
        real = kinematics.points(reach.arm, np.radians(played.angles[:, : reach.arm.joints]))[:, -1]
        axes.plot(*real.T, "--", color=PLAYED, linewidth=1, zorder=6, label=f"played by the firmware in the twin, {played.rms:.2f} deg rms off")
    axes.annotate("start", points[0, -1], textcoords="offset points", xytext=(8, 4), fontsize=9)
    axes.annotate("end", points[-1, -1], textcoords="offset points", xytext=(-22, -14), fontsize=9)
    _frame(axes, reach)
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1), fontsize=8, frameon=False)
    axes.set_title(title or _words(reach), fontsize=10, loc="left")
    _curves(parts[1].subplots(2, 2, sharex=True), reach, played)
    _save(figure, path)


def animate(reach: Reach, path: str | Path, played=None, frames: int = 60) -> None:
    """An animation (.gif or .png, the latter APNG). ArmError if it cannot be written."""
    figure, axes = pyplot.subplots(figsize=(6.4, 4.4), layout="constrained")
    _scene(axes, reach)
    _frame(axes, reach)
    axes.set_title(_words(reach), fontsize=8, loc="left")
    when = np.concatenate((np.zeros(6), np.linspace(0, reach.total, frames), np.full(12, reach.total)))
    q = reach.at(when)[0]
    if played is not None:
        q = np.radians(np.array([np.interp(when, played.times, column) for column in played.angles[:, : reach.arm.joints].T])).T
    points = kinematics.points(reach.arm, q)
    axes.plot(*kinematics.points(reach.arm, reach.at(np.linspace(0, reach.total, 300))[0])[:, -1].T, color=PATH, alpha=0.25, linewidth=1.5)
    (links,) = axes.plot([], [], "-", color=JOINTS[0], linewidth=5, solid_capstyle="round", zorder=5)
    (joints,) = axes.plot([], [], "o", color="white", markeredgecolor=JOINTS[0], markersize=8, zorder=6)
    (trail,) = axes.plot([], [], color=PATH, linewidth=2, zorder=4)
    clock = axes.text(0.98, 0.03, "", transform=axes.transAxes, ha="right", fontsize=9, color=GREY)

    def show(k):
        links.set_data(*points[k].T)
        joints.set_data(*points[k, :-1].T)
        trail.set_data(*points[: k + 1, -1].T)
        clock.set_text(f"{when[k]:.1f} s")
        return links, joints, trail, clock

    made = FuncAnimation(figure, show, frames=len(when), blit=True)
    try:
        made.save(str(path), writer=PillowWriter(fps=max(round(frames / reach.total), 5)), dpi=80)
    except (OSError, ValueError) as error:
        raise ArmError(f"{path}: cannot be written: {error}") from None
    finally:
        pyplot.close(figure)


def _words(reach):
    told = reach.told
    if "cost" not in told:
        return f"{reach.arm.name}, {reach.total:.2f} s"
    name = {"paper-1": "experiment I", "paper-2": "experiment II"}.get(told.get("scene", ""), reach.arm.name)
    return f"{name}: cost {told['cost']:.2f}, {told['time_s']:.2f} s, joint travel {told['travel_rad']:.2f} rad, path {told['path_m']:.2f} m"


def _scene(axes: Axes, reach):
    reach_mm = reach.arm.lengths.sum()
    for one in reach.obstacles:
        if isinstance(one, Disc):
            axes.add_patch(Circle((one.x, one.y), one.radius, color=OBSTACLE, zorder=2))
        elif isinstance(one, Box):
            local = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (one.width / 2, one.height / 2)
            c, s = np.cos(one.angle), np.sin(one.angle)
            axes.add_patch(Polygon(local @ np.array([[c, s], [-s, c]]) + (one.x, one.y), color=OBSTACLE, zorder=2))
        else:
            out = np.array([np.cos(one.angle), np.sin(one.angle)])
            along = np.array([-out[1], out[0]]) * 4 * reach_mm
            place = np.array([one.x, one.y])
            axes.add_patch(
                Polygon([place + along, place - along, place - along - 4 * reach_mm * out, place + along - 4 * reach_mm * out], color=OBSTACLE, zorder=1)
            )


def _frame(axes, reach):
    """Axes round all that moves and most of what stands."""
    dense = kinematics.points(reach.arm, reach.at(np.linspace(0, reach.total, 100))[0]).reshape(-1, 2)
    rounds = [(one.x + sx * one.radius, one.y + sy * one.radius) for one in reach.obstacles if isinstance(one, Disc) for sx in (-1, 1) for sy in (-1, 1)]
    every = np.vstack([dense, np.array(rounds).reshape(-1, 2)])
    low, high = every.min(axis=0), every.max(axis=0)
    margin = 0.08 * (high - low).max()
    axes.plot(*reach.arm.base, "s", color="#333333", markersize=9, zorder=2)
    axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin), aspect="equal", xlabel="x, m", ylabel="y, m")
    axes.grid(color="#eeeeee")
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _curves(grid, reach, played):
    arm = reach.arm
    when = np.linspace(0, reach.total, 500)
    q, qd, qdd = reach.at(when)
    torque = dynamics.torques(arm, *(np.cumsum(v, axis=1).T for v in (q, qd, qdd))).T
    rows = (
        ("angle, deg", np.degrees(q), None),
        ("speed, deg/s", np.degrees(qd), np.degrees(arm.speeds)),
        ("acceleration, deg/s2", np.degrees(qdd), None),
        ("torque, N m", torque, arm.torques),
    )
    for axes, (name, values, limits) in zip(grid.flat, rows):
        for k in range(arm.joints):
            colour = JOINTS[k % len(JOINTS)]
            axes.plot(when, values[:, k], color=colour, linewidth=1.6, label=f"joint {k + 1}")
            if limits is not None and np.abs(values).max() > 0.5 * limits[k]:
                for sign in (-1, 1):
                    axes.axhline(sign * limits[k], color=colour, linewidth=0.9, linestyle=":")
        if name.startswith("angle") and played is not None:
            axes.plot(played.times, played.angles[:, : arm.joints], "--", color=PLAYED, linewidth=0.8)
        at = np.searchsorted(when, reach.times[1:-1]).clip(0, len(when) - 1)
        if len(at) < 20:  # those of a plan, not of a recording from elsewhere
            for k in range(arm.joints):
                axes.plot(when[at], values[at, k], "o", color="white", markeredgecolor=JOINTS[k % len(JOINTS)], markersize=5, zorder=5)
        axes.set_ylabel(name, fontsize=8)
        axes.tick_params(labelsize=8)
        axes.grid(color="#eeeeee")
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    for axes in grid[1]:
        axes.set_xlabel("time, s", fontsize=8)
    grid[0, 0].legend(fontsize=8, frameon=False, loc="center right")
    grid[1, 1].annotate("dotted: limits", (0.99, 0.86), xycoords="axes fraction", ha="right", fontsize=7, color=GREY)


def _save(figure, path):
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=110)
    except (OSError, ValueError) as error:
        raise ArmError(f"{path}: cannot be written: {error}") from None
    finally:
        pyplot.close(figure)
