"""The picture of a map: walls, cells, doors, places."""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib import pyplot
from matplotlib.colors import ListedColormap

from host.floorplan.errors import MapError
from host.floorplan.model import HouseMap

COLOURS = "#c9c5ba", "#fbfaf7", "#e9c9a0"  # wall, free, door
INK, PLACE, DOOR = "#2b2d33", "#2a9d4a", "#9c6b30"


def draw(house: HouseMap, path: Path) -> None:
    """Draw the map into a PNG, SVG or PDF. MapError if it cannot be written."""
    width, height = house.size
    figure, axes = pyplot.subplots(figsize=(8, 8 * height / width + 0.6), layout="constrained")
    extent = (0, width, 0, height)
    axes.imshow(house.cells, origin="lower", extent=extent, cmap=ListedColormap(COLOURS), vmin=0, vmax=2, interpolation="nearest")
    walls = np.ma.masked_where(~house.walls, house.walls)
    across, up = house.walls.shape[1] * house.pixel, house.walls.shape[0] * house.pixel
    axes.imshow(walls, origin="lower", extent=(0, across, 0, up), cmap=ListedColormap([INK]), interpolation="nearest")
    for door in house.doors:
        ends = [door.point(0, side * door.width / 2) for side in (-1, 1)]
        axes.plot(*zip(*ends), color=DOOR, linewidth=3)
    for name, place in {**({"start": house.start[:2]} if house.start else {}), **house.places}.items():
        axes.plot(*place, "o", color=PLACE, markeredgecolor="white", markersize=8)
        axes.annotate(name, place, (7, 5), textcoords="offset points", fontsize=9, color=INK)
    axes.set(xlim=(0, width), ylim=(0, height), xlabel="x, mm", ylabel="y, mm", aspect="equal")
    axes.set_title(Path(house.source).name, loc="left", fontsize=10)
    try:
        figure.savefig(path, dpi=110)
    except (OSError, ValueError) as error:
        raise MapError(f"the picture {path} cannot be written: {error}") from None
    finally:
        pyplot.close(figure)
