"""The moving picture of the README: a run of the twin as an animated GIF, with the points that the robot remembers. `make animation` makes it again.

The body and its wheels are where they really are; the points, their windows and the decision are what the firmware says on its line.
"""

import argparse
import sys
from dataclasses import dataclass, field
from math import degrees
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image, ImageColor, ImageDraw, ImageFont

from host.link import messages
from host.twin import Observer, image, run
from host.twin.console import reasons
from host.twin.picture import OUTSIDE, outline
from host.version import add_version
from link import frames

from . import style

TARGET = image.ROOT / "docs" / "passage.gif"
COURSE = {"course": "Z", "width": 450, "seed": 1}
FRAME_US = 200_000  # of the run, from one picture to the next
SHOWN_MS = 80  # so the picture runs at 2.5 times the speed
LAST_MS = 2500
SCALE = 0.26  # pixels of a mm
FINE = 3  # drawn so many times as large, then made smaller: smooth edges
STEPS = 7  # of a smooth edge
STRONG = (style.RED, style.BLUE, style.YELLOW, style.GREEN)
MARGIN, BEFORE, BEHIND = 26, 480, 560  # mm round the walls; of the entrance and of the exit


@dataclass
class Moment:
    """One picture: time s; pose x, y (mm), heading (deg); wheels: angle of each, deg; points (n, 2) mm on the floor and their windows; decision: message, or None."""

    time: float
    pose: tuple
    wheels: np.ndarray
    points: np.ndarray
    windows: list
    decision: dict | None


@dataclass
class Watcher(Observer):
    """Notes a Moment every FRAME_US."""

    moments: list = field(default_factory=list)
    vehicle: object = None
    _due: int = 0
    _points: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    _windows: list = field(default_factory=list)
    _decision: dict | None = None
    _pose: tuple = (0.0, 0.0, 0.0)
    _frames: frames.FrameReader = field(default_factory=frames.FrameReader)

    def serial(self, data):
        for kind, _, payload in self._frames.read(data):
            message = messages.decode(kind, payload) or {"type": ""}
            if message["type"] == "points":
                self._points = style.turned(np.column_stack([message["x"], message["y"]]).reshape(-1, 2), self._pose)
                self._windows = message["window"]
            elif message["type"] == "decision":
                self._decision = message

    def step(self, simulation):
        body = simulation.body
        self._pose = (body.x, body.y, degrees(body.heading))
        if simulation.now < self._due and simulation.result is None:
            return
        self._due += FRAME_US
        wheels = np.degrees(body.angles)
        self.moments.append(Moment(simulation.now / 1e6, self._pose, wheels, self._points, self._windows, self._decision))


class Painter:
    """Paints moments on one course: `paint(k)` gives the picture of moments[k], 8 bit RGB.

    course: twin Course. vehicle: twin Vehicle. moments: list of Moment. The course lies on its side: y grows to the right, x downward.
    """

    def __init__(self, course, vehicle, moments):
        self._course, self._vehicle, self._moments = course, vehicle, moments
        walls = course.segments.reshape(-1, 2)
        self._low = np.array([walls[:, 0].min() - MARGIN, moments[0].pose[1] - BEFORE])
        high = np.array([walls[:, 0].max() + MARGIN, moments[-1].pose[1] + BEHIND])
        self.size: tuple[int, int] = int(np.ceil((high - self._low)[1] * SCALE)), int(np.ceil((high - self._low)[0] * SCALE))
        self._half = vehicle.width / 2, vehicle.length / 2
        self._ground = self._paint_ground()
        path = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
        self._font = ImageFont.truetype(str(path / "DejaVuSans.ttf"), round(15 * FINE))
        self._bold = ImageFont.truetype(str(path / "DejaVuSans-Bold.ttf"), round(17 * FINE))

    def paint(self, k):
        """The picture of moments[k]."""
        picture = self._ground.copy()
        draw = ImageDraw.Draw(picture)
        moment = self._moments[k]
        for offset, colour in ((self._half[1], style.RED), (-self._half[1], style.BLUE)):
            track = [style.turned([(0, offset)], one.pose)[0] for one in self._moments[: k + 1]]
            draw.line(self.on(track), fill=colour, width=round(2 * FINE), joint="curve")
        corners = self.on(outline(moment.pose, *self._half))
        draw.polygon(corners, fill="#ffffff")
        for at, angle in zip(self._wheels(), moment.wheels, strict=True):
            wheel = style.turned(style.turned(np.array([(-14, -34), (14, -34), (14, 34), (-14, 34)]), (*at, angle)), moment.pose)
            draw.polygon(self.on(wheel), fill=style.WALL)
        draw.line([*corners, corners[0]], fill=style.WALL, width=round(1.8 * FINE), joint="curve")
        nose = style.turned(np.array([(-0.4, 0.8), (0, 0.93), (0.4, 0.8)]) * self._half, moment.pose)
        draw.line(self.on(nose), fill=style.WALL, width=round(1.8 * FINE), joint="curve")
        for point, window in sorted(zip(self.on(moment.points), moment.windows, strict=True), key=lambda pair: pair[1] or 9, reverse=True):
            size = FINE * (2.0 if window in (0, 4) else 2.8)
            x, y = point
            draw.ellipse((x - size, y - size, x + size, y + size), fill=style.WINDOWS[window])
        self._words(draw, moment)
        return picture.resize(self.size, Image.Resampling.LANCZOS)

    def on(self, places):
        """Pixels of the fine picture for places on the floor, (n, 2) mm."""
        return [tuple(place) for place in ((np.asarray(places, float).reshape(-1, 2) - self._low)[:, ::-1] * SCALE * FINE).tolist()]

    def _wheels(self):
        half = self._vehicle.track / 2
        return [(x, y) for y in self._vehicle.axles for x in (-half, half)]

    def _paint_ground(self):
        picture = Image.new("RGB", (FINE * self.size[0], FINE * self.size[1]), OUTSIDE)
        draw = ImageDraw.Draw(picture)
        draw.polygon(self.on(self._course.floor), fill=style.FLOOR)
        for wall in self._course.segments:
            draw.line(self.on(wall.reshape(2, 2)), fill=style.WALL, width=round(3 * FINE))
        return picture

    def _words(self, draw, moment):
        """What it is at the top right, what was decided at the bottom left, where a Z on its side leaves room."""
        width, height = (FINE * v for v in self.size)
        right, top = width - 16 * FINE, 14 * FINE
        draw.text((right, top), f"{self._course.width:.0f} mm wide", font=self._bold, fill=style.WALL, anchor="ra")
        robot = f"robot {self._vehicle.length:.0f} x {self._vehicle.width:.0f} mm"
        draw.text((right, top + 25 * FINE), robot, font=self._font, fill=style.GREY, anchor="ra")
        speed = FRAME_US / 1000 / SHOWN_MS
        draw.text((right, top + 46 * FINE), f"{moment.time:4.1f} s, shown {speed:g} times as fast", font=self._font, fill=style.GREY, anchor="ra")
        left, y = 16 * FINE, height - 64 * FINE
        told = moment.decision
        if told is None:
            return
        words = (("AF", f"{told['af']:+.0f}°", style.RED), ("AR", f"{told['ar']:+.0f}°", style.BLUE), ("V", f"{told['v']}", style.WALL))
        for k, (name, value, colour) in enumerate(words):
            draw.text((left + k * 104 * FINE, y), name, font=self._bold, fill=colour)
            draw.text((left + (k * 104 + (20 if name == "V" else 34)) * FINE, y), value, font=self._bold, fill=style.WALL)
        why = reasons()
        text = why[told["why"]] if told["why"] < len(why) else ""
        draw.text((left, y + 28 * FINE), text.split(",")[0], font=self._font, fill=style.GREY)


def make(path, **arguments):
    """Drive a run and write it as a GIF; arguments as for host.twin.run. Returns the Result. ValueError unless it came through without touching."""
    watcher = Watcher()
    result = run(**{**COURSE, **arguments}, watch=watcher, record=False)
    if result.result != "pass":
        raise ValueError(f"this run is nothing to show: {result.result} {result.reason}")
    write(Painter(result.layout, result.vehicle, watcher.moments), len(watcher.moments), path)
    return result


def write(painter, count, path):
    """Write `count` pictures of a Painter as a GIF that runs for ever."""
    pictures = [painter.paint(k) for k in range(count)]
    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    flat[0].save(path, save_all=True, append_images=flat[1:], duration=[SHOWN_MS] * (count - 1) + [LAST_MS], loop=0, optimize=True, disposal=1)


def _palette():
    """All colours that are painted, and what smooth edges make of each over each ground: one palette for all pictures, so that nothing flickers."""
    grounds = np.array([ImageColor.getrgb(colour) for colour in (OUTSIDE, style.FLOOR, "#ffffff")], float)
    paints = np.array([ImageColor.getrgb(colour) for colour in (style.WALL, style.GREY, style.PALE, *STRONG)], float)
    share = np.linspace(0, 1, STEPS)[:, None, None, None]
    blends = share * paints + (1 - share) * grounds[:, None]
    return np.unique(blends.reshape(-1, 3).round().astype(int), axis=0).ravel().tolist()


def main(arguments=None):
    """Exit code: 0 drawn, 1 the run gave nothing to show, 2 misused."""
    parser = argparse.ArgumentParser(prog="python -m host.drawings.animation", description=__doc__)
    add_version(parser)
    parser.add_argument("--to", type=Path, metavar="FILE", default=TARGET, help="the GIF to write (default docs/passage.gif)")
    parser.add_argument("--width", type=float, metavar="MM", default=COURSE["width"], help="of the Z passage (default 450)")
    parser.add_argument("--seed", type=int, metavar="N", default=COURSE["seed"], help="of the robot's imperfections (default 1)")
    options = parser.parse_args(arguments)
    if options.to.suffix.lower() != ".gif" or not options.to.absolute().parent.is_dir():
        parser.error(f"--to {options.to}: name a .gif in a folder that exists")
    try:
        result = make(options.to, width=options.width, seed=options.seed)
    except (ValueError, image.ToolMissing) as error:
        print(f"{parser.prog}: {error}", file=sys.stderr)
        return 1
    print(f"{options.to}  {options.to.stat().st_size // 1000} kB, {result.time_s:.0f} s of driving, least clearance {result.min_clearance_mm:.0f} mm")
    return 0


if __name__ == "__main__":
    sys.exit(main())
