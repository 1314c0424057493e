"""Drawings of the cost to go: footprint masks, what a grid is made of, and the costs."""

from array import array

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Bbox, BboxTransformTo

from planner.cost_to_go import sample
from planner.footprint_masks import masks as footprint_masks

from . import style
from .moments import TURNS, N

_NOTHING = 0xF0  # a row of a mask without a place
_NOWHERE = 20000  # cost of a pose without a way out


def masks(robot, path):
    """Which places of the grid a point closes, in four orientations."""
    half_width, half_length = robot.size
    cell = half_length / 6
    table = footprint_masks(2 * half_width, 2 * half_length, robot.candidates.margin, half_length * 2 * 8 // 12)
    shapes = TURNS // 2 + 1  # of the others there are mirror images
    high = len(table) // (2 * 4 * shapes)
    table = np.frombuffer(bytes(table), np.uint8).astype(int).reshape(4, shapes, high, 2)
    reach = high // 2
    figure, grid = style.page(9.6, 3.1, 4)
    for axes, t in zip(grid, (0, 2, 4, 9), strict=True):
        mirrored = t >= shapes
        rows = table[1, TURNS - t] if mirrored else table[0, t]
        for row in range(high):
            for (mask, colour), zorder in zip(((rows[row, 0], "#f0c987"), (rows[row, 1], style.RED)), (2, 3), strict=True):
                if mask != _NOTHING:
                    first, last = (mask >> 4) - 8, (mask & 15) - 8
                    first, last = (-last, -first) if mirrored else (first, last)
                    boxes = [Bbox.from_bounds((column - 0.5) * cell, (row - reach - 0.5) * cell, cell, cell) for column in range(first, last + 1)]
                    squares = Path.make_compound_path(*(Path.unit_rectangle().transformed(BboxTransformTo(box)) for box in boxes))
                    axes.add_patch(PathPatch(squares, facecolor=colour, edgecolor="white", linewidth=0.6, zorder=zorder))
        point = (-cell / 4, -cell / 4)
        style.body(axes, robot.size, (*point, 15 * t), style.WALL, "none", line=1, style="--", zorder=5)
        axes.plot(*point, "o", color=style.WALL, markersize=4, zorder=6)
        reach_mm = (reach + 1) * cell
        axes.set(xlim=(-reach_mm, reach_mm), ylim=(-reach_mm, reach_mm))
        axes.set_title(f"heading {15 * t}°", loc="center")
    for colour, name in ((style.RED, "closed"), ("#f0c987", "near: expensive")):
        grid[0].add_patch(Rectangle((9e3, 9e3), 1, 1, facecolor=colour, label=name))
    figure.legend(loc="outside lower center", ncols=2, frameon=False)
    style.save(figure, path)


def noses(grid, heading):
    """Heading of the nose, degrees, in each of the 12 orientations: the half turn ends at the orientation that is closed altogether."""
    shut = [t for t in range(TURNS) if grid.closed[t].all()]
    if len(shut) != 1:
        return np.arange(TURNS) * 15
    middle = min((shut[0] + 6, shut[0] + 18), key=lambda t: abs((t * 15 - heading + 180) % 360 - 180))
    return np.array([15 * t + (180 if 6 < (t - middle) % 24 < 18 else 0) for t in range(TURNS)])


def costs(robot, moment, path):
    """Closed, near and visited places; and the cost to go with the heading that is best in each."""
    grid = moment.grid
    x0, y0 = grid.corner
    side = N * grid.cell
    extent = (x0, x0 + side, y0, y0 + side)
    figure, (visited, one, best) = style.page(10.4, 4.4, 3)
    t = round(moment.pose[2] / 15) % TURNS
    for axes in (visited, one, best):
        axes.set(xlim=extent[:2], ylim=extent[2:])

    within = connected(grid, moment.pose)
    shown = visited.imshow(grid.revisit / 2, origin="lower", extent=extent, cmap="YlOrBr", vmin=1, vmax=max(grid.revisit.max() / 2, 4), zorder=1)
    figure.colorbar(shown, ax=visited, location="bottom", shrink=0.8, label="revisit cost: a step costs so many times as much", pad=0.02)
    visited.set_title("Where it has been")

    mm = in_mm(grid)
    top = np.nanmax(np.where(within, mm, np.nan))
    colours = colormaps["viridis_r"].with_extremes(bad="none")
    one.imshow(np.where(grid.closed[t], 1.0, np.nan), origin="lower", extent=extent, cmap=ListedColormap([style.GREY]), zorder=1)
    one.imshow(mm[t], alpha=np.where(within[t], 1, 0.3), origin="lower", extent=extent, cmap=colours, vmin=0, vmax=top, zorder=2)
    near = grid.near[t] & ~grid.closed[t]
    rows, columns = np.nonzero(near)
    one.plot(x0 + (columns + 0.5) * grid.cell, y0 + (rows + 0.5) * grid.cell, "x", color="white", markersize=2.6, markeredgewidth=0.7, zorder=3)
    one.set_title(f"One orientation of twelve: {15 * t}°")

    nose = noses(grid, moment.pose[2])
    least = np.nanargmin(np.where(np.isnan(mm), np.inf, mm), axis=0)
    lowest = np.take_along_axis(mm, least[None], axis=0)[0]
    inside = within.any(axis=0)
    best.imshow(lowest, alpha=np.where(inside, 1, 0.3), origin="lower", extent=extent, cmap=colours, vmin=0, vmax=top, zorder=2)
    shown = ScalarMappable(Normalize(0, top), colours)
    figure.colorbar(shown, ax=[one, best], location="bottom", shrink=0.45, label="cost to go, mm", pad=0.02)
    rows, columns = np.nonzero(~np.isnan(lowest) & inside)
    keep = (rows % 2 == 0) & (columns % 2 == 0)
    rows, columns = rows[keep], columns[keep]
    heading = np.radians(nose[least[rows, columns]])
    best.quiver(
        x0 + (columns + 0.5) * grid.cell,
        y0 + (rows + 0.5) * grid.cell,
        np.sin(heading),
        np.cos(heading),
        color="white",
        pivot="mid",
        scale=22,
        width=0.006,
        headwidth=4,
        zorder=4,
    )
    best.set_title("The best of the twelve; arrows: the nose")
    for axes in (visited, one, best):
        style.points(axes, moment.floor_points[::2], style.WALL, 2.4, zorder=6)
        style.body(axes, robot.size, moment.pose, style.RED, "none", zorder=7)
    style.scale(visited, x0 + 40, y0 + 40)
    style.save(figure, path)


def connected(grid, pose):
    """(12, 26, 26) bool: the open poses that hang together with those round the body; behind the walls there are others."""
    seen = np.zeros_like(grid.closed)
    i, j = (int((at - corner) / grid.cell) for at, corner in zip(pose, grid.corner, strict=False))
    t = round(pose[2] / 15) % TURNS
    seen[t, max(j - 1, 0) : j + 2, max(i - 1, 0) : i + 2] = True
    seen &= ~grid.closed
    while True:
        wider = seen | np.roll(seen, 1, axis=0) | np.roll(seen, -1, axis=0)
        for axis in (1, 2):
            padded = np.pad(wider, [(0, 0)] + [(1, 1) if a == axis else (0, 0) for a in (1, 2)])
            wider = wider | np.take(padded, range(N), axis) | np.take(padded, range(2, N + 2), axis)
        wider &= ~grid.closed
        if (wider == seen).all():
            return seen
        seen = wider


def in_mm(grid):
    """(12, 26, 26) cost to go of each pose in mm, as the firmware itself reads it; NaN where there is none."""
    cell = round(8 * grid.cell)
    t, j, i = np.indices(grid.closed.shape).reshape(3, -1)
    poses = np.column_stack([i * cell + cell // 2 + 65536, j * cell + cell // 2 + 65536, t * 150]).ravel()
    words = array("i", poses.tolist())
    sample(cell, words, len(i), grid.bytes)
    mm = np.array(words[::3], float).reshape(grid.closed.shape)
    return np.where(mm == _NOWHERE, np.nan, mm)
