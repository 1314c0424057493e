"""The drawings of docs/planner.md: what the planner knows and does at moments of a real run. `python -m host.drawings` makes them again.

The same sources give the same files. A run is driven once and kept in build/bench; drawing takes seconds.
"""

from pathlib import Path

from host.twin import image

PAGE = image.ROOT / "docs" / "planner.md"
FOLDER = image.ROOT / "docs" / "planner"
NAMES = ("steering", "modes", "windows", "points", "masks", "costs", "candidates", "swept", "two-moves", "best-first")


def draw(folder=FOLDER):
    """Make every drawing in a folder; their paths, in the order of NAMES. moments.DrawingError, image.ToolMissing."""
    from . import bounds, conventions, grid, moments, robot, round_body  # matplotlib takes its time

    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    paths = {name: folder / f"{name}.svg" for name in NAMES}
    one = robot.robot()
    found = moments.runs()
    runs = [[one for one in run if isinstance(one, moments.Moment)] for run in found]
    singles = [one for run in found for one in run if isinstance(one, moments.BestFirst)]
    first, bend = one.in_a_bend(runs)
    close = max((moment for run in runs for moment in run), key=lambda moment: moment.near)
    for name in ("steering", "modes", "windows"):
        getattr(conventions, name)(one, paths[name])
    grid.masks(one, paths["masks"])
    grid.costs(one, bend, paths["costs"])
    round_body.points(one, close, paths["points"])
    round_body.candidates(one, first, paths["candidates"])  # before the bend: more of them are free for a while
    round_body.swept(one, bend, paths["swept"])
    round_body.two_moves(one, bend, paths["two-moves"])
    bounds.best_first(singles, paths["best-first"])
    return list(paths.values())
