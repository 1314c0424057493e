"""What all drawings have in common: colours, the body, the frame of the page, and how a file is written."""

import io
import re
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib import pyplot
from matplotlib.patches import Polygon

from host.twin.picture import outline

FLOOR, WALL, BODY = "#fbfaf7", "#2b2d33", "#8d99ae"
RED, BLUE, YELLOW, GREEN = "#d1495b", "#1f6f8b", "#e09f3e", "#4f9d69"
GREY, PALE = "#666666", "#c9c5ba"
WINDOWS = {0: PALE, 1: GREEN, 2: RED, 3: BLUE, 4: YELLOW}

RULES: dict[Any, Any] = {"svg.hashsalt": "gapseeker", "svg.fonttype": "path", "font.size": 8.5, "axes.titlesize": 9.5, "axes.titlelocation": "left"}


_PLACES = re.compile(r'\b(?:x|y|d|points)="[^"]*"')
_LONG = re.compile(r"-?\d+\.\d{3,}")


def page(width, height, columns=1, rows=1, **more):
    """(figure, [axes]): inches; each axes in mm with equal scales and no frame."""
    pyplot.rcParams.update(RULES)
    figure, grid = pyplot.subplots(rows, columns, figsize=(width, height), layout="constrained", squeeze=False, **more)
    for axes in grid.flat:
        axes.set(aspect="equal", facecolor=FLOOR, xticks=(), yticks=())
        for side in axes.spines.values():
            side.set_color("#e6e4dd")
    return figure, list(grid.flat)


def body(axes, size, pose=(0.0, 0.0, 0.0), colour=WALL, fill="#ffffff", alpha=1.0, line=1.4, zorder=4, style="-"):
    """The outline with a mark at the nose. size: half the width and half the length, mm. pose: x, y, heading (deg)."""
    corners = outline(pose, *size)
    axes.add_patch(Polygon(corners, facecolor=fill, edgecolor=colour, linewidth=line, alpha=alpha, zorder=zorder, linestyle=style))
    nose = turned(np.array([(-0.45, 0.8), (0, 0.95), (0.45, 0.8)]) * size, pose)
    axes.plot(*nose.T, color=colour, linewidth=line, alpha=alpha, zorder=zorder + 0.1)


def turned(points, pose):
    """Points (n, 2) of the body frame on the floor. pose: x, y, heading (deg, clockwise)."""
    x, y, heading = pose
    s, c = np.sin(np.radians(heading)), np.cos(np.radians(heading))
    return np.array([x, y]) + np.asarray(points) @ np.array([(c, -s), (s, c)])


def seen_from(points, pose):
    """Points (n, 2) of the floor in the body frame."""
    x, y, heading = pose
    s, c = np.sin(np.radians(heading)), np.cos(np.radians(heading))
    return (np.asarray(points) - (x, y)) @ np.array([(c, s), (-s, c)])


def points(axes, where, colour=WALL, size=2.2, zorder=3, **more):
    """Points as dots."""
    axes.plot(*np.asarray(where, float).reshape(-1, 2).T, ".", color=colour, markersize=2 * size, markeredgewidth=0, zorder=zorder, **more)


def degrees(angle):
    """An angle as it is written."""
    return f"{angle:+.0f}°" if round(angle) else "0°"


def scale(axes, x, y, mm=200):
    """A bar of so many mm, its left end at x, y."""
    axes.plot([x, x + mm], [y, y], color=GREY, linewidth=1.6, solid_capstyle="butt", zorder=9)
    axes.text(x + mm / 2, y + 12, f"{mm} mm", ha="center", va="bottom", fontsize=7.5, color=GREY, zorder=9)


def save(figure, path):
    """Write an SVG that is the same each time, places to a hundredth of a point."""
    file = io.StringIO()
    figure.savefig(file, format="svg", dpi=100, metadata={"Date": None, "Creator": None})
    pyplot.close(figure)
    text = _PLACES.sub(lambda places: _LONG.sub(lambda number: f"{float(number[0]):.2f}", places[0]), file.getvalue())
    Path(path).write_text("\n".join(line.rstrip() for line in text.splitlines()) + "\n")
