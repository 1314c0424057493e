"""The picture of a run: walls, the body on its way, the tracks of its front and rear, and where it touched.

matplotlib is imported here and nowhere else, so that a run without a picture does not wait for it.
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib import pyplot
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from .world import World

WALL, FLOOR, OUTSIDE, BOX = "#2b2d33", "#fbfaf7", "#e6e4dd", "#c9c5ba"
FRONT, REAR, BODY, TOUCHED, STANDING = "#d1495b", "#1f6f8b", "#8d99ae", "#e8a400", "#2b2d33"
GOAL = "#4f9d69"
REVERSED_MM = 20.0  # less is no turning back
DOOR, STEERED, BELIEVED = "#9c6b30", "#7a4bb5", "#111111"
EVERY_MM, EVERY_DEG = 120.0, 12.0  # motion from one body outline to the next
SIZE = 8.0  # inches, the longer side
WORDS = {
    "pass": "through without touching",
    "local_collision": "through, but touched",
    "blocked": "blocked",
    "timeout": "not through in time",
    "alarm": "alarm",
    "lost": "lost: it does not know where it is",
    "missed": "stands beside its goal",
}


def draw(result, path):
    """Draw a run.Result into a PNG, SVG or PDF file, as its name ends. ValueError if the file cannot be written."""
    segments = result.layout.segments
    low = segments.reshape(-1, 2).min(axis=0) - 60
    high = segments.reshape(-1, 2).max(axis=0) + 60
    width, height = SIZE * (high - low) / max(high - low)
    figure, axes = pyplot.subplots(figsize=(max(width + 0.8, 5), height + 1.4), layout="constrained")
    figure.set_facecolor("white")
    axes.set_facecolor(OUTSIDE)
    _walls(axes, result.layout)
    _body(axes, result)
    _tracks(axes, result)
    _marks(axes, result)
    if result.errand:
        _errand(axes, result.errand)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xlabel="x, mm", ylabel="y, mm")
    axes.tick_params(colors="#666666", labelsize=8)
    for side in axes.spines.values():
        side.set_visible(False)
    figure.suptitle(_title(result), x=0.02, ha="left", fontsize=10)
    figure.legend(handles=_legend(result), loc="outside lower left", ncols=3 if width > 6 else 2, fontsize=8, frameon=False)
    try:
        figure.savefig(Path(path), dpi=120)
    except OSError as error:
        raise ValueError(f"the picture {path} cannot be written: {error.strerror}") from None
    finally:
        pyplot.close(figure)


def outline(pose, half_width, half_length):
    """Corners of the body, (4, 2), from the front right clockwise. pose: x, y, heading in degrees."""
    x, y, heading = pose
    s, c = np.sin(np.radians(heading)), np.cos(np.radians(heading))
    corners = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)]) * (half_width, half_length)
    return np.array([x, y]) + corners @ np.array([(c, -s), (s, c)])


def stations(track):
    """Indices of the track, (n, 4), at which the body has moved or turned enough to be drawn again, the first and the last included."""
    out, last = [0], track[0]
    for i, point in enumerate(track):
        if np.hypot(*(point[1:3] - last[1:3])) > EVERY_MM or abs(point[3] - last[3]) > EVERY_DEG:
            out.append(i)
            last = point
    return out + [len(track) - 1]


def touching_point(pose, half, segments):
    """The point of the body's outline that is nearest to a wall."""
    corners = outline(pose, *half)
    share = np.linspace(0, 1, 60)[:, None, None]
    points = (corners + share * (np.roll(corners, -1, axis=0) - corners)).reshape(-1, 2)
    start, side = segments[:, :2], segments[:, 2:] - segments[:, :2]
    relative = points[:, None] - start
    along = np.clip((relative * side).sum(-1) / (side * side).sum(-1), 0, 1)
    distance = np.hypot(*np.moveaxis(relative - along[..., None] * side, -1, 0)).min(axis=1)
    return points[distance.argmin()]


def _walls(axes, layout):
    floor = axes.add_patch(Polygon(layout.floor, closed=True, facecolor=FLOOR))
    walls = layout.segments[: len(layout.segments) - 4 * len(layout.boxes)]
    axes.add_collection(LineCollection(walls.reshape(-1, 2, 2), colors=WALL, linewidths=2.2, capstyle="round", zorder=5))
    for box in layout.boxes:
        axes.add_patch(Polygon(box, closed=True, facecolor=BOX, edgecolor=WALL, linewidth=1.5, zorder=4)).set_clip_path(floor)


def _body(axes, result):
    half = result.vehicle.width / 2, result.vehicle.length / 2
    indices = stations(result.track)
    for i in indices[:-1]:
        axes.add_patch(Polygon(outline(result.track[i, 1:], *half), closed=True, facecolor=BODY, edgecolor=BODY, alpha=0.16, linewidth=0))
        axes.add_patch(Polygon(outline(result.track[i, 1:], *half), closed=True, fill=False, edgecolor=BODY, alpha=0.55, linewidth=0.6))
    for _, *pose in result.touches:
        axes.add_patch(Polygon(outline(pose, *half), closed=True, fill=False, edgecolor=TOUCHED, linewidth=1.2, zorder=8))
        axes.plot(*touching_point(pose, half, result.layout.segments), "o", color=TOUCHED, markersize=9, markeredgecolor=WALL, zorder=9)
    x, y, heading = last = result.track[-1, 1:]
    axes.add_patch(Polygon(outline(last, *half), closed=True, facecolor="white", edgecolor=STANDING, linewidth=1.6, zorder=7))
    nose = np.array([np.sin(np.radians(heading)), np.cos(np.radians(heading))]) * half[1]
    arrow = dict(arrowstyle="-|>", color=STANDING, linewidth=1.2)
    axes.annotate("", (x + 0.8 * nose[0], y + 0.8 * nose[1]), (x - 0.2 * nose[0], y - 0.2 * nose[1]), arrowprops=arrow, zorder=8)


def _tracks(axes, result):
    track = result.track
    heading = np.radians(track[:, 3])
    forward = np.stack([np.sin(heading), np.cos(heading)], axis=1) * result.vehicle.length / 2
    axes.plot(*(track[:, 1:3] + forward).T, color=FRONT, linewidth=1.5, zorder=6)
    axes.plot(*(track[:, 1:3] - forward).T, color=REAR, linewidth=1.5, zorder=6)


def reversals(track):
    """Indices of a track, (n, 4), at which the body changes between ahead and backward, and goes on so for REVERSED_MM at least."""
    heading = np.radians(track[:-1, 3])
    rolled = (np.diff(track[:, 1]) * np.sin(heading) + np.diff(track[:, 2]) * np.cos(heading)).cumsum()
    out, sign, farthest, at = [], 0, 0.0, 0
    for i, where in enumerate(rolled):
        if sign == 0:
            sign = int(np.sign(where)) if abs(where) > REVERSED_MM else 0
            farthest, at = where, i
        elif (where - farthest) * sign > 0:
            farthest, at = where, i
        elif (farthest - where) * sign > REVERSED_MM:
            out.append(at + 1)
            sign, farthest, at = -sign, where, i
    return out


def tightest(result):
    """(index of the track, the point of the body's outline nearest to a wall) where the walls were nearest."""
    world = World(result.layout.segments)
    half = result.vehicle.width / 2, result.vehicle.length / 2
    near = [world.clearance(x, y, np.radians(heading), *half)[0] for _, x, y, heading in result.track]
    at = int(np.argmin(near))
    return at, touching_point(result.track[at, 1:], half, result.layout.segments)


def _marks(axes, result):
    """Start, goal, where it turned back, and the tightest place."""
    note = dict(fontsize=8, color=STANDING, zorder=11)
    x, y = result.track[0, 1:3]
    axes.plot(x, y, "o", color="white", markeredgecolor=STANDING, markersize=7, zorder=10)
    axes.annotate("start", (x, y), (9, 0), textcoords="offset points", va="center", **note)
    gx, gy, *line = result.layout.goal
    heading, half = line or (0.0, 0.0)
    if not line:  # a place, of a world from a file
        axes.plot(gx, gy, "*", color=GOAL, markersize=12, markeredgecolor="white", zorder=11)
    elif np.isfinite([gx, gy, half]).all():
        across = np.array([np.cos(heading), -np.sin(heading)]) * min(half, result.layout.width / 2 if result.layout.width else half)
        ends = np.array([(gx, gy) - across, (gx, gy) + across])
        axes.plot(*ends.T, color=GOAL, linewidth=1.6, linestyle=(0, (4, 2)), zorder=6)
        axes.annotate("goal", ends[0], (-6, 0), textcoords="offset points", ha="right", va="center", **{**note, "color": GOAL})
    turned = reversals(result.track)
    if turned:
        axes.plot(*result.track[turned, 1:3].T, "D", color="white", markeredgecolor=STANDING, markersize=5, zorder=10)
    _, place = tightest(result)
    if not result.touches:
        axes.plot(*place, "o", fillstyle="none", color=TOUCHED, markersize=11, markeredgewidth=1.8, zorder=10)


def _errand_words(result):
    facts = result.house
    words = f"method {facts['method']}, way {facts['path_mm'] / 1000:.2f} m, pose {facts['pose_rms_mm']} mm rms"
    return f"alarm: {facts['alarm']}, {words}" if facts["alarm"] else words


def _errand(axes, errand):
    """Where the robot was sent, what it steered for, where it believed to be, and the doors as the map has them."""
    house = errand.house
    axes.plot(*house.goal, "*", color=GOAL, markersize=15, markeredgecolor="white", zorder=11)
    for door in house.house.doors:
        ends = [door.point(0, side * door.width / 2) for side in (-1, 1)]
        axes.plot(*zip(*ends), color=DOOR, linewidth=2.5, linestyle=(0, (2, 1.2)), zorder=3)
    if errand.steer:
        _, xs, ys = zip(*errand.steer)
        corners = [(x, y) for k, (x, y) in enumerate(zip(xs, ys)) if not k or (x, y) != (xs[k - 1], ys[k - 1])]
        axes.plot(*zip(*corners), "o", color=STEERED, markersize=4.5, alpha=0.8, zorder=10)
    if errand.track:
        axes.plot(*zip(*[place[1:] for place in errand.track]), color=BELIEVED, linewidth=1.2, linestyle="--", zorder=9)


def _title(result):
    width = _errand_words(result) if result.errand else f"gaps of {result.gap_mm:g} mm" if result.course == "random" else f"{result.width_mm:g} mm wide"
    figures = f"{result.time_s:.1f} s, "
    if result.contacts:
        figures += f"{result.contacts} contact{'s' * (result.contacts > 1)}, up to {-result.min_clearance_mm:.0f} mm deep"
    else:
        figures += f"least clearance {result.min_clearance_mm:.0f} mm"
    if result.touched_by:
        figures += f", touched by others {result.touched_by} times while it stood"
    return f"{Path(result.course).name}, {width}, {result.mode.upper()}, seed {result.seed}\n{WORDS[result.result]}; {figures}"


def _legend(result):
    out = [Line2D([], [], color=FRONT, label="A, middle of the front"), Line2D([], [], color=REAR, label="B, middle of the rear")]
    if turned := len(reversals(result.track)):
        out.append(Line2D([], [], linestyle="", color="white", marker="D", markeredgecolor=STANDING, label=f"turned back, {turned} time{'s' * (turned > 1)}"))
    if not result.touches:
        out.append(
            Line2D(
                [],
                [],
                linestyle="",
                fillstyle="none",
                color=TOUCHED,
                marker="o",
                markeredgewidth=1.8,
                label=f"nearest to a wall, {result.min_clearance_mm:.0f} mm",
            )
        )
    if result.errand:
        out += [
            Line2D([], [], color=BELIEVED, linestyle="--", label="centre, as the robot believes it"),
            Line2D([], [], color=STEERED, marker="o", linestyle="", label="steered for: corners and sub-goals"),
            Line2D([], [], color=GOAL, marker="*", linestyle="", markersize=11, label="goal"),
            Line2D([], [], color=DOOR, linestyle=(0, (2, 1.2)), linewidth=2.5, label="door on the map"),
        ]
    if result.touches:
        out.append(Line2D([], [], color=TOUCHED, marker="o", markeredgecolor=WALL, linewidth=1.2, label="touched"))
    return out
