"""The signed distance from the nearest wall, at the nodes of a coarse grid: what the board matches its points against."""

import numpy as np

LIMIT = 254.0  # mm: what a byte holds
UNIT = 2.0


NEAR, INSIDE = 60.0, 25.0  # mm outside and inside the walls, where the field has to be right: a point that fits lies there


def distances(walls: np.ndarray, pixel: float, spacing: float) -> np.ndarray:
    """(rows, columns) of mm, positive outside the walls, limited to +-LIMIT; nodes every `spacing` mm from the lower left corner.

    walls: (m, n) bool, the lowest row first.
    """
    return exact(walls, pixel, np.arange(0, walls.shape[1] * pixel + spacing, spacing), np.arange(0, walls.shape[0] * pixel + spacing, spacing))


def best(walls: np.ndarray, pixel: float, spacings) -> tuple[int, np.ndarray]:
    """(spacing, nodes) of the spacing with which what lies between the nodes, interpolated, is nearest to the distance along the walls.

    A wall shows in the field by what its nodes on either side hold; where it is thinner than two spacings they may miss its middle, and the wall seems to be elsewhere.
    """
    x, y, d = _samples(walls, pixel)
    found = []
    for spacing in spacings:
        nodes = distances(walls, pixel, spacing)
        error = np.abs(interpolated(nodes, spacing, x, y) - d).mean() if len(d) else 0.0
        found.append((error, spacing, nodes))
    _, spacing, nodes = min(found, key=lambda one: one[:2])
    return spacing, nodes


def interpolated(nodes: np.ndarray, spacing: float, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """As the board takes it from the nodes, mm."""
    i, j = (x / spacing).astype(int), (y / spacing).astype(int)
    fx, fy = x / spacing - i, y / spacing - j
    low = nodes[j, i] * (1 - fx) + nodes[j, i + 1] * fx
    return low * (1 - fy) + (nodes[j + 1, i] * (1 - fx) + nodes[j + 1, i + 1] * fx) * fy


def _samples(walls: np.ndarray, pixel: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x, y and signed distance of places along the walls, from the middles of pixels."""
    step = max(round(25 / pixel), 1)
    rows, cols = np.arange(0, walls.shape[0], step), np.arange(0, walls.shape[1], step)
    ys, xs = (rows + 0.5) * pixel, (cols + 0.5) * pixel
    d = exact(walls, pixel, xs, ys)
    near = (d < NEAR) & (d > -INSIDE)
    j, i = np.nonzero(near)
    return xs[i], ys[j], d[j, i]


def exact(walls: np.ndarray, pixel: float, xs: np.ndarray, ys: np.ndarray) -> np.ndarray:
    """The signed distance at the crossings of xs and ys, mm, exact for pixels as squares, limited to +-LIMIT."""
    return _far(walls, pixel, xs, ys) - _far(~walls, pixel, xs, ys)


def _far(shape: np.ndarray, pixel: float, xs: np.ndarray, ys: np.ndarray) -> np.ndarray:
    """Distance of each node from the nearest pixel that is True; LIMIT if none is near."""
    out = np.full((len(ys), len(xs)), LIMIT)
    reach = int(np.ceil(LIMIT / pixel)) + 1
    for j, y in enumerate(ys):
        row = int(y // pixel)
        low, high = max(row - reach, 0), min(row + reach + 1, shape.shape[0])
        if low >= high:
            continue
        bottom = np.arange(low, high) * pixel
        dy = np.maximum(np.maximum(bottom - y, y - bottom - pixel), 0)
        for i, x in enumerate(xs):
            col = int(x // pixel)
            left, right = max(col - reach, 0), min(col + reach + 1, shape.shape[1])
            if left >= right:
                continue
            part = shape[low:high, left:right]
            if not part.any():
                continue
            begin = np.arange(left, right) * pixel
            dx = np.maximum(np.maximum(begin - x, x - begin - pixel), 0)
            found = np.hypot(dy[:, None], dx[None])[part].min()
            out[j, i] = min(out[j, i], found)
    return out


def encode(field: np.ndarray) -> bytes:
    """A byte a node, 2 mm a unit, 128 = 0."""
    return np.clip(np.rint(field / UNIT) + 128, 1, 255).astype(np.uint8).tobytes()
