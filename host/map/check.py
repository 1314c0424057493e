"""What is wrong with a map, before the robot finds out."""

import heapq

import numpy as np

from host.floorplan.model import DOOR, FREE, WALL, HouseMap

ROBOT = 250.0  # mm wide
LEAST = ROBOT + 60.0  # of a door


def faults(house: HouseMap) -> list[str]:
    """What is wrong, in words; empty if nothing is."""
    out = []
    for number, door in enumerate(house.doors, 1):
        if door.width < LEAST:
            out.append(f"door {number} at {door.x:g}, {door.y:g} is {door.width:g} mm wide: the robot needs {LEAST:g}")
    places = {**({"start": house.start[:2]} if house.start else {}), **house.places}
    inside = {}
    for name, (x, y) in places.items():
        try:
            row, col = house.at(x, y)
        except ValueError as error:
            out.append(str(error))
            continue
        if house.cells[row, col] == WALL:
            out.append(f"{name} at {x:g}, {y:g} lies in a wall, or too near to one")
        else:
            inside[name] = row, col
    if inside:
        first = "start" if "start" in inside else next(iter(inside))
        far = distances(house, inside[first])
        out += [f"{name} cannot be reached from {first}" for name, cell in inside.items() if far[cell] < 0]
    out += _rooms(house, inside)
    return out


def distances(house: HouseMap, start) -> np.ndarray:
    """Length of the way from a cell to each, 5 a side and 7 a diagonal, -1 where there is none."""
    cells = house.cells
    far = np.full(cells.shape, -1)
    far[start] = 0
    edge = [(0, start)]
    while edge:
        d, (row, col) = heapq.heappop(edge)
        if d > far[row, col]:
            continue
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                r, c = row + dr, col + dc
                if not (dr or dc) or not (0 <= r < cells.shape[0] and 0 <= c < cells.shape[1]) or cells[r, c] == WALL:
                    continue
                if dr and dc and (cells[r, col] == WALL or cells[row, c] == WALL):
                    continue
                there = d + (7 if dr and dc else 5)
                if far[r, c] < 0 or there < far[r, c]:
                    far[r, c] = there
                    heapq.heappush(edge, (there, (r, c)))
    return far


def _rooms(house: HouseMap, inside: dict) -> list[str]:
    """Rooms that nothing leads to."""
    if not inside:
        return []
    far = distances(house, next(iter(inside.values())))
    cut = (far < 0) & (house.cells != WALL)
    area = cut.sum() * house.cell**2 / 1e6
    return [f"{area:.1f} m2 of free floor cannot be reached: a door may be missing"] if area > 0.5 else []


def summary(house: HouseMap) -> str:
    rows, cols = house.cells.shape
    width, height = house.size
    return (
        f"{house.source}: {width / 1000:.2f} x {height / 1000:.2f} m, {rows} x {cols} cells of {house.cell} mm, {int((house.cells == FREE).sum())} free, "
        f"{len(house.doors)} doors in {int((house.cells == DOOR).sum())} cells"
    )
