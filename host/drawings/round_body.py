"""Drawings in the body frame, nose up: the map of points, the candidates, what one sweeps, and two moves at a time."""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.patches import Circle, Polygon, Wedge

from host.twin.picture import outline

from . import conventions, style

PAPER = {"boxstyle": "square,pad=0.2", "facecolor": style.FLOOR, "edgecolor": "none", "alpha": 0.85}
_STEP = 100  # mm of free length that have one colour
LABELS = {1: "green", 2: "red", 3: "blue", 4: "yellow", 0: "none: dropped"}


def points(robot, moment, path):
    """The map of points, by windows."""
    figure, (axes,) = style.page(5.6, 6.6)
    conventions.frames(axes, robot)
    conventions.lines(axes, robot, 300, 900)
    style.body(axes, robot.size)
    floor = style.seen_from(moment.floor_points, moment.pose)
    windows, seen = robot.windows(moment)
    style.points(axes, floor, style.PALE)
    for window in (4, 3, 2, 1):
        of = seen[windows == window]
        if len(of):
            style.points(axes, of, style.WINDOWS[window], 3.4 if window < 4 else 2.2, label=f"{LABELS[window]}: {len(of)}")
    axes.plot([], [], ".", color=style.PALE, markersize=4.4, markeredgewidth=0, label=f"no window: {len(floor) - int((windows > 0).sum())}")
    axes.add_patch(Circle((0, 0), 200, facecolor="none", edgecolor=style.GREY, linewidth=0.8, linestyle=":", zorder=5))
    axes.text(0, 60, "lidar", ha="center", fontsize=7.5, color=style.GREY, zorder=6)
    axes.plot(0, 0, "o", color=style.GREY, markersize=3, zorder=6)
    axes.text(0, -165, "blind\nwithin\n200 mm", ha="center", fontsize=7.5, color=style.GREY, zorder=6)
    half_width, half_length = robot.size
    for zone, (x, y) in conventions.ZONES.items():
        at = (x * (half_width + 230), y * (half_length + 620) if abs(y) == 1 else y * half_length / 2)
        axes.text(*at, str(zone), ha="center", va="center", fontsize=12, color=style.GREY, zorder=6, bbox=PAPER)
    axes.legend(loc="lower right", fontsize=8, framealpha=0.9)
    axes.set(xlim=(-980, 980), ylim=(-1250, 1250), title=f"{len(floor)} points are remembered")
    style.scale(axes, -940, -1220)
    style.save(figure, path)


def candidates(robot, moment, path):
    """Every candidate, as far as it is free, and the points that end them."""
    figure, (left, right) = style.page(9.4, 5.6, 2)
    killed: dict[tuple, int] = {}
    lines, free_of = [], []
    for mirroring in range(4):
        for k in range(robot.candidates.count):
            if mirroring & 1 and k == robot.candidates.arcs:
                continue  # straight: the same as its mirror image
            free, point = robot.free(moment, mirroring, k)
            lines.append(_end_that_leads(robot, mirroring, robot.way(mirroring, k, free, 90)))
            free_of.append(free)
            if point:
                killed[point] = killed.get(point, 0) + 1
    colours = colormaps["viridis"]
    shown = ScalarMappable(Normalize(0, robot.candidates.look_ahead), colours)
    for low in range(0, robot.candidates.look_ahead, _STEP):
        of = [np.vstack([line, [[np.nan, np.nan]]]) for line, free in zip(lines, free_of, strict=True) if low <= free - 1 < low + _STEP]
        if of:
            left.plot(*np.vstack(of).T, color=colours((low + _STEP / 2) / robot.candidates.look_ahead), linewidth=0.8, zorder=5)
    figure.colorbar(shown, ax=left, shrink=0.6, location="bottom", label="free, mm", pad=0.02)
    for axes in (left, right):
        style.body(axes, robot.size, alpha=0.9)
        style.points(axes, moment.points, style.PALE if axes is left else style.GREY)
        axes.set(xlim=(-720, 860), ylim=(-860, 1060))
    where, count = np.array(list(killed)), np.array(list(killed.values()))
    for number in sorted(set(count)):
        left.plot(*where[count == number].T, "o", markersize=np.sqrt(6 + 5 * number), markerfacecolor="none", color=style.RED, zorder=7)
    most = int(count.argmax())
    left.annotate(
        f"this point ends {count[most]}",
        where[most],
        where[most] + (40, 150),
        color=style.RED,
        fontsize=8,
        arrowprops={"arrowstyle": "-", "color": style.RED, "linewidth": 0.8},
        zorder=8,
    )
    left.set_title(f"{len(lines)} candidates: the way of the end that leads")
    style.scale(left, -680, -820)
    right.set_title("Four of them: where the body is stopped, and by what")
    for at, (mirroring, k) in enumerate(_examples(robot, moment)):
        free, point = robot.free(moment, mirroring, k)
        colour = (style.RED, style.BLUE, style.GREEN, "#7a6c9c")[at]
        way = robot.way(mirroring, k, free)
        style.body(right, robot.size, way[-1], colour, "none", zorder=6, line=1.2)
        right.plot(*way[:, :2].T, color=colour, linewidth=1.2, zorder=7)
        af, ar = robot.steering(mirroring, k)
        ends = f"{free} mm" if point else "free all the way"
        right.plot([], [], color=colour, label=f"AF {style.degrees(af)} AR {style.degrees(ar)}{', backward' if mirroring & 2 else ''}: {ends}")
        if point:
            right.plot(*point, "x", color=colour, markersize=8, markeredgewidth=2, zorder=8)
    right.legend(loc="upper center", bbox_to_anchor=(0.5, -0.02), fontsize=7.5, frameon=False, ncols=2)
    style.save(figure, path)


def _end_that_leads(robot, mirroring, way):
    """Way of the middle of the front, or, driven backward, of the rear."""
    end = [(0, robot.size[1] * (-1 if mirroring & 2 else 1))]
    return np.array([style.turned(end, pose)[0] for pose in way])


def _examples(robot, moment):
    """[(mirroring, candidate)] ahead right and left, backward, and sideways, of each the one that is free farthest short of the look-ahead."""
    arcs, count = robot.candidates.arcs, robot.candidates.count
    out = []
    for mirroring, first, last in ((0, 0, arcs), (1, 0, arcs), (2, 0, arcs), (1, arcs + 1, count)):
        free = [(robot.free(moment, mirroring, k), k) for k in range(first, last)]
        out.append((mirroring, max(free, key=lambda one: (one[0][1] is not None, one[0][0]))[1]))
    return out


def swept(robot, moment, path):
    """What one candidate sweeps, and how the point is found at which it ends."""
    mirroring, k, _ = moment.first
    free, point = robot.free(moment, mirroring, k)
    if point is None or k >= robot.candidates.arcs:
        mirroring, k = _examples(robot, moment)[0]
        free, point = robot.free(moment, mirroring, k)
    half_width, half_length = robot.size
    margin = robot.candidates.margin
    figure, (axes,) = style.page(7, 5.4)
    way = robot.way(mirroring, k, free, 8)
    for pose in way:
        axes.add_patch(Polygon(outline(pose, half_width + margin, half_length + margin), facecolor="#f3dfb8", edgecolor="none", zorder=1))
    for pose in way[:: max(len(way) // 5, 1)]:
        style.body(axes, robot.size, pose, style.PALE, "none", line=0.8, zorder=3)
    style.body(axes, robot.size, alpha=0.9)
    style.body(axes, robot.size, way[-1], style.RED, "none", line=1.4, zorder=6)
    axes.add_patch(
        Polygon(outline(way[-1], half_width + margin, half_length + margin), facecolor="none", edgecolor=style.RED, linewidth=0.7, linestyle=":", zorder=6)
    )
    style.points(axes, moment.points, style.WALL, 3)
    centre = _centre(way)
    distance = np.hypot(*(np.array(point) - centre))
    angle = np.degrees(np.arctan2(*(np.array(point) - centre)[::-1]))
    turn = way[-1][2]
    low, high = sorted((angle, angle + turn))
    axes.add_patch(Wedge(centre, distance, low, high, width=0.1, facecolor="none", edgecolor=style.BLUE, linewidth=1.6, zorder=7))
    start = centre + distance * np.array([np.cos(np.radians(angle + turn)), np.sin(np.radians(angle + turn))])
    for at in (point, start):
        axes.plot(*np.array([centre, at]).T, color=style.BLUE, linewidth=0.7, linestyle="--", zorder=4)
    axes.plot(*centre, "o", color=style.BLUE, markersize=5, zorder=8)
    axes.plot(*point, "x", color=style.RED, markersize=9, markeredgewidth=2.2, zorder=9)
    axes.plot(*start, "o", color=style.BLUE, markersize=5, zorder=9)
    words = (
        ("here its ring enters\nthe outline and margin", start, (0.03, 0.95), style.BLUE, "left"),
        ("the point that ends it", point, (0.97, 0.95), style.RED, "right"),
        ("turning centre", centre, (0.97, 0.12), style.BLUE, "right"),
    )
    for text, at, place, colour, side in words:
        line = {"arrowstyle": "-", "linewidth": 0.7, "color": colour}
        axes.annotate(text, at, place, textcoords="axes fraction", color=colour, ha=side, va="top", bbox=PAPER, arrowprops=line, zorder=9)
    af, ar = robot.steering(mirroring, k)
    axes.set_title(f"AF {style.degrees(af)}, AR {style.degrees(ar)}: free for {free} mm")
    box = np.vstack([*(outline(pose, half_width, half_length) for pose in way), [centre]])
    low, high = box.min(axis=0) - (180, 60), box.max(axis=0) + (180, 180)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    style.scale(axes, high[0] - 240, low[1] + 25)
    style.save(figure, path)


def _centre(way):
    """Turning centre of a way of poses."""
    turn = np.radians(way[-1][2])
    chord = way[-1][:2] - way[0][:2]
    across = np.array([chord[1], -chord[0]])  # to the right of the chord
    return (way[0][:2] + way[-1][:2]) / 2 + across / (2 * np.tan(turn / 2))


def two_moves(robot, moment, path):
    """The first moves that were tried, and the pair that was chosen."""
    figure, (left, right) = style.page(9.4, 4.9, 2)
    half_width, half_length = robot.size
    for axes in (left, right):
        style.body(axes, robot.size, alpha=0.9)
        style.points(axes, moment.points, style.WALL, 2.6)
        axes.set(xlim=(-600, 1000), ylim=(-760, 840))
    for mirroring, k, length in dict.fromkeys(moment.firsts):
        way = robot.way(mirroring, k, length)
        chosen = (mirroring, k, length) == moment.first
        colour = style.RED if chosen else style.BLUE
        left.plot(*way[:, :2].T, color=colour, linewidth=1.4, zorder=7)
        style.body(left, robot.size, way[-1], colour, "none", line=1.4 if chosen else 0.7, zorder=6 if chosen else 5)
    left.set_title(f"{len(moment.firsts)} first moves; from the end of each, second ones are tried")
    first = robot.way(*moment.first)
    second = _from(robot.way(*moment.second), first[-1])
    for way, colour, name in ((first, style.RED, "first move"), (second, style.BLUE, "second move")):
        for pose in way[6:-1:6]:
            style.body(right, robot.size, pose, colour, "none", line=0.5, alpha=0.45, zorder=5)
        style.body(right, robot.size, way[-1], colour, "none", zorder=7)
        right.plot(*way[:, :2].T, color=colour, linewidth=1.6, zorder=8)
        move = moment.first if colour == style.RED else moment.second
        af, ar = robot.steering(*move[:2])
        right.plot([], [], color=colour, label=f"{name}: AF {style.degrees(af)} AR {style.degrees(ar)}, {move[2]} mm{' back' if move[0] & 2 else ''}")
    right.legend(loc="lower right", fontsize=8, framealpha=0.9)
    right.set_title("The pair that was chosen")
    style.scale(left, -560, -720)
    style.save(figure, path)


def _from(way, start):
    """A way of poses that begins at a pose instead of at 0, 0, 0."""
    places = style.turned(way[:, :2], start)
    return np.column_stack([places, way[:, 2] + start[2]])
