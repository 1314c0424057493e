"""The signed distance from the nearest wall, at the nodes of a coarse grid: what the board matches its points against."""

import numpy as np

LIMIT = 254.0  # mm: what a byte holds
UNIT = 2.0


def distances(walls: np.ndarray, pixel: float, spacing: float) -> np.ndarray:
    """(rows, columns) of mm, positive outside the walls, limited to +-LIMIT; nodes every `spacing` mm from the lower left corner.

    walls: (m, n) bool, the lowest row first. Exact for pixels as squares.
    """
    height, width = walls.shape[0] * pixel, walls.shape[1] * pixel
    ys = np.arange(0, height + spacing, spacing)
    xs = np.arange(0, width + spacing, spacing)
    free = ~walls
    return np.clip(_far(walls, pixel, xs, ys) - _far(free, pixel, xs, ys), -LIMIT, LIMIT)


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
