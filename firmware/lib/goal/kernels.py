"""The goal layer's loops in machine code: distances over the grid, and how points fit the map's walls.

The map's frame: x right, y up from its lower left corner, mm, 0..32767. A cell is a 16-bit word:

    bit 15      closed
    bits 12-14  how much was found in it that the map does not have, 0..6; closed from 3 on. 7: nothing found changes it, walls (0xFFFF) and doors
    bits 0-11   its distance from the goal, 5 for a cell's side, 7 for its diagonal; 4095 not reached

The field holds the signed distance from the nearest wall, negative inside it, at the nodes of a grid of its own: bytes of 2 mm, 128 is 0.

Arguments that a function uses most come first, some of them only for that: three lie in registers.
"""

import micropython
from micropython import const

_FAR = const(4095)
_CLOSED = const(0x8000)

# Places in the layer's numbers, see layer.py
_COLS = const(0)
_SIZE = const(1)
_FIELD_COLS = const(3)
_RIGHT = const(4)  # of the field, 1/8 mm, just within it
_TOP = const(5)
_SPACING = const(6)  # of its nodes, 1/8 mm
_COUNT = const(7)  # of points
_SUMS = const(8)
_USED = const(17)
_FITS = const(18)
_FAULTS = const(19)
_V = const(20)


@micropython.viper
def spread(at: int, cells: ptr16, d: int, back: int, numbers: ptr32) -> int:
    """One sweep over all cells, backward if `back`: each takes the least distance that its neighbours offer. Returns 0 when nothing has changed any more. at, d: 0.

    Sweeps to and fro end with the exact distances, whatever the order: a cell's distance only ever falls. The neighbours come in the order above, right, below, left, each with
    the diagonal one between it and the one before: no diagonal leads past a closed corner.
    """
    size = numbers[_SIZE]
    changed = 0
    k = 0
    while k < size:
        at = k
        if back:
            at = size - 1 - k
        k += 1
        word = int(cells[at])
        if word < _CLOSED:  # the rim of the map is closed (build.py sees to that): there are eight neighbours
            d = word & _FAR
            step = int(numbers[_COLS])
            before = -1
            turn = 4
            while turn:
                if cells[at + step] < _CLOSED:
                    c = cells[at + step] & _FAR
                    if c + 5 < d:
                        d = c + 5
                    if cells[at + before] < _CLOSED:
                        c = int(cells[at + before + step])
                        if c < _CLOSED and (c & _FAR) + 7 < d:
                            d = (c & _FAR) + 7
                c = step
                step = 0 - before
                before = c
                turn -= 1
            d |= word & 0x7000
            if d != word:
                cells[at] = d
                changed = 1
    return changed


@micropython.viper
def fit(numbers: ptr32, i: int, d: int, field: ptr8, px: ptr16, py: ptr16, k: int, stride: int, x: int, y: int, s: int, c: int, tx: int, ty: int):
    """How well the points k, k + stride, ... fit the map's walls, turned about (x, y) and brought to (tx, ty), 1/8 mm. i, d: 0.

    s, c: sine and cosine of the turn, clockwise, * 2**14. With d the distance of a point from the nearest wall (mm), (gx, gy) its slope, t that over the
    turn (64 = a mm a mm, a mm in 1/1024 rad) and a weight w = 32 / (1 + (d/40)**2), rounded down, the sums are
        w gx gx, w gx gy, w gx t, w gx d, w gy gy, w gy t, w gy d, w t t, w t d; then points on the field, those within 100 mm of a wall, and the distances, each 250 at most
    """
    i = _SUMS
    while i < _V:
        numbers[i] = 0
        i += 1
    spacing = numbers[_SPACING]
    while k < numbers[_COUNT]:
        i = (px[k] << 3) - x
        d = (py[k] << 3) - y
        k += stride
        rx = (i * c + d * s) >> 14
        ry = (d * c - i * s) >> 14
        u = rx + tx
        v = ry + ty
        if (u | v | (numbers[_RIGHT] - u) | (numbers[_TOP] - v)) < 0:
            continue
        i = u // spacing
        d = v // spacing
        u = ((u - i * spacing) << 8) // spacing
        v = ((v - d * spacing) << 8) // spacing
        i += d * numbers[_FIELD_COLS]
        # 2 mm a unit, 256ths of it: below, and what is more above
        g = int(field[i + 1]) - field[i]
        d = (int(field[i]) << 8) + g * u
        i += numbers[_FIELD_COLS]
        e = int(field[i + 1]) - field[i]
        u = (int(field[i]) << 8) + e * u - d
        # a slope of 64 is a mm a mm
        i = ((g << 8) + (e - g) * v) * 4 // spacing
        d = (((d << 8) + u * v + 16384) >> 15) - 256
        u = u * 4 // spacing
        numbers[_V] = uint(i)
        numbers[_V + 1] = uint(u)
        numbers[_V + 2] = uint((i * ry - u * rx) >> 13)
        numbers[_V + 3] = uint(d)
        if d < 0:
            d = 0 - d
        numbers[_USED] = numbers[_USED] + 1
        if d < 100:
            numbers[_FITS] = numbers[_FITS] + 1
        if d > 250:
            d = 250
        numbers[_FAULTS] = numbers[_FAULTS] + d
        u = 51200 // (1600 + d * d)
        i = _SUMS
        d = _V
        while d < _V + 3:
            v = d
            while v < _V + 4:
                numbers[i] = uint(numbers[i] + u * numbers[d] * numbers[v])
                i += 1
                v += 1
            d += 1
