"""The conventions that every page uses: AF, AR and V, the steering modes, the windows and the zones."""

import numpy as np
from matplotlib.patches import Arc, FancyArrowPatch, Polygon, Rectangle

from core.axles import lay_out
from steering import Steering, mode_of

from . import style

SPACINGS, TRACK = (115, 150, 117, 115), 230
FIRST = sum(SPACINGS) / 2
AXLES = [FIRST - sum(SPACINGS[:i]) for i in range(len(SPACINGS) + 1)]
WHEEL = np.array([(-13, -33), (13, -33), (13, 33), (-13, 33)])


def _wheels(axes, steering, pose=(0, 0, 0), colour=style.WALL, arrows=False):
    """The wheels, turned as the firmware turns them."""
    for k, angle in enumerate(steering.angles):
        x, y = (-1, 1)[k & 1] * TRACK / 2, AXLES[k // 2]
        corners = style.turned(style.turned(WHEEL, (x, y, angle / 10)), pose)
        axes.add_patch(Polygon(corners, facecolor=colour, edgecolor="white", linewidth=0.5, zorder=6))
        if arrows:
            along = style.turned([(0, 0), (0, 125 * steering.shares[k] / 16384)], (x, y, angle / 10))
            start, end = style.turned(along, pose)
            _arrow(axes, start, end, style.GREY, 0.9)


def _arrow(axes, start, end, colour, width=1.5, head=7):
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=head, color=colour, linewidth=width, shrinkA=0, shrinkB=0, zorder=7))


def steering(robot, path):
    """AF and AR turn two virtual wheels; lines across all wheels meet in one turning centre."""
    af, ar = 30, -20
    solved = Steering(lay_out(SPACINGS, TRACK))
    solved.solve(af * 10, ar * 10)
    figure, (axes,) = style.page(6.6, 3.9)
    style.body(axes, robot.size)
    radius = sum(SPACINGS) / (np.tan(np.radians(af)) - np.tan(np.radians(ar)))
    centre = np.array([radius, FIRST - radius * np.tan(np.radians(af))])
    for k in range(len(solved.angles)):
        at = ((-1, 1)[k & 1] * TRACK / 2, AXLES[k // 2])
        axes.plot(*np.array([at, centre]).T, color=style.PALE, linewidth=0.6, zorder=2)
    _wheels(axes, solved)
    for y, angle, colour, name in ((AXLES[0], af, style.RED, "AF"), (AXLES[-1], ar, style.BLUE, "AR")):
        axes.add_patch(Polygon(style.turned(WHEEL * 1.05, (0, y, angle)), facecolor=colour, edgecolor="white", linewidth=0.6, zorder=7))
        axes.plot([0, 0], [y - 20, y + 165], color=colour, linewidth=0.8, linestyle=":", zorder=6)
        _arrow(axes, (0, y), style.turned([(0, 165)], (0, y, angle))[0], colour)
        axes.plot(*np.array([(0, y), centre]).T, color=colour, linewidth=1.1, zorder=5)
        low, high = sorted((90 - angle, 90))
        axes.add_patch(Arc((0, y), 210, 210, theta1=low, theta2=high, color=colour, linewidth=1.2, zorder=7))
        axes.annotate(
            f"{name} = {angle:+d}°",
            style.turned([(0, 106)], (0, y, angle / 2))[0],
            (-200, y + (105 if y > 0 else 62)),
            color=colour,
            ha="right",
            va="center",
            fontsize=9.5,
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.8},
            zorder=9,
        )
    axes.plot(*centre, "o", color=style.WALL, markersize=5, zorder=8)
    axes.text(centre[0] + 12, centre[1] + 6, "turning centre", va="bottom", fontsize=9)
    _arrow(axes, (0, 0), (0, 90), style.GREY)
    _arrow(axes, (0, 0), (90, 0), style.GREY)
    axes.text(8, 92, "y", color=style.GREY, va="center")
    axes.text(93, 12, "x", color=style.GREY)
    axes.text(
        -200,
        30,
        "five axles, ten wheels:\neach stands across its line\nto the centre, and rolls at a\nspeed that goes with the\ndistance to it",
        ha="right",
        va="center",
        color=style.GREY,
    )
    axes.text(190, -250, "V is the speed of the fastest wheel,\n0 … 180: 90 stands, 180 is full ahead,\n0 is full backward", va="top", color=style.GREY)
    axes.set(xlim=(-600, 800), ylim=(-350, 440))
    style.save(figure, path)


MODES = (
    ("1  adverse phase", 30, -30),
    ("2  first axle straight", 0, -30),
    ("3  last axle straight", 30, 0),
    ("4  spin on the spot", 90, -90),
    ("5  crab: AF = AR", 60, 60),
    ("6  same phase", 40, 15),
)


def modes(robot, path):
    """One body for each steering mode, its wheels as the firmware turns them, and where it goes."""
    figure, grid = style.page(9.6, 3.2, 6)
    for axes, (title, af, ar) in zip(grid, MODES, strict=True):
        solved = Steering(lay_out(SPACINGS, TRACK))
        solved.solve(af * 10, ar * 10)
        assert mode_of(af * 10, ar * 10) == int(title[0])
        style.body(axes, robot.size, line=1.2)
        _wheels(axes, solved, arrows=True)
        twist = np.array([solved.vx, solved.vy]) / 16384 * 260
        if np.hypot(*twist) > 20:
            _arrow(axes, (0, 0), twist, style.RED, 2, 10)
        else:
            axes.add_patch(
                FancyArrowPatch(
                    (-70, -30), (70, -30), connectionstyle="arc3,rad=-1.3", arrowstyle="-|>", mutation_scale=10, color=style.RED, linewidth=2, zorder=7
                )
            )
        axes.set_title(title, fontsize=8.2, loc="center")
        axes.text(0, -400, f"AF {style.degrees(af)}   AR {style.degrees(ar)}", ha="center", fontsize=8.2, color=style.GREY)
        axes.set(xlim=(-255, 255), ylim=(-440, 440))
    style.save(figure, path)


ZONES = {
    0: (0, 1),
    1: (1, 1),
    2: (1, 0.5),
    3: (1, -0.5),
    4: (1, -1),
    5: (0, -1),
    6: (-1, -1),
    7: (-1, -0.5),
    8: (-1, 0.5),
    9: (-1, 1),
}


def windows(robot, path):
    """The windows round the body, not to scale, and the ten zones."""
    figure, (left, right) = style.page(9.2, 4.6, 2, width_ratios=(1700, 900))
    half_width, half_length = robot.size
    frames(left, robot, fill=True, stretch=2)
    style.body(left, robot.size, colour=style.GREEN, fill="#e3f1e7")
    notes = (
        (style.GREEN, (0, 0), "green: inside the outline.\nA collision"),
        (style.RED, (half_width + 20, 120), "red: nearer than 20 mm"),
        (style.BLUE, (half_width + 70, -40), "blue: nearer than 45 mm"),
        (style.YELLOW, (half_width + 230, -220), "yellow: the planning window,\n300 mm to each side, 900 mm\nbefore and behind"),
    )
    for (colour, at, text), height in zip(notes, (420, 160, -60, -330), strict=True):
        left.annotate(
            text,
            at,
            (520, height),
            va="center",
            color=colour,
            fontsize=8.5,
            zorder=8,
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.8, "relpos": (0, 0.5)},
        )
    left.set(xlim=(-460, 1240), ylim=(-780, 780), title="Windows: how urgent a point is (not to scale)")
    style.body(right, robot.size)
    lines(right, robot, 270)
    for zone, (x, y) in ZONES.items():
        right.text(
            x * (half_width + 130),
            y * (half_length + 130) if abs(y) == 1 else y * half_length,
            str(zone),
            ha="center",
            va="center",
            fontsize=14,
            color=style.BLUE,
        )
    right.set(xlim=(-450, 450), ylim=(-780, 780), title="Zones: on which side it stands")
    style.save(figure, path)


def frames(axes, robot, fill=False, stretch=1):
    """The edges of the windows of robot.json round the body."""
    half_width, half_length = robot.size
    config = robot.config
    edges: tuple[tuple[str, float, float, str], ...] = (
        (style.YELLOW, config.windows_side, config.windows_look_ahead if stretch == 1 else 430, "#fdf3e3"),
        (style.BLUE, config.windows_blue * stretch, config.windows_blue * stretch, "#dfecf0"),
        (style.RED, config.windows_red * stretch, config.windows_red * stretch, "#f8e1e4"),
    )
    for colour, side, ahead, shade in edges:
        wide, long = half_width + side, half_length + ahead
        axes.add_patch(Rectangle((-wide, -long), 2 * wide, 2 * long, facecolor=shade if fill else "none", edgecolor=colour, linewidth=1, zorder=2))


def lines(axes, robot, reach, reach_y=None):
    """What parts the zones: the sides and ends of the body made longer, and its waist."""
    half_width, half_length = robot.size
    reach_y = reach_y or reach
    for a in (-1, 1):
        for b in (-1, 1):
            x, y = a * half_width, b * half_length
            axes.plot([x, x + a * reach], [y, y], color=style.GREY, linewidth=0.8, linestyle=(0, (4, 3)), zorder=3)
            axes.plot([x, x], [y, y + b * reach_y], color=style.GREY, linewidth=0.8, linestyle=(0, (4, 3)), zorder=3)
        axes.plot([a * half_width, a * (half_width + reach)], [0, 0], color=style.GREY, linewidth=0.8, linestyle=(0, (4, 3)), zorder=3)
