"""What the screen computes at each turn of the loop, as machine code: it lies outside the heap, and a turn of the loop hardly notices it.

The picture round the body is a grid of cells, each of one colour: the window of the most urgent point in it, else the body's outline or the way
that is driven, else nothing. Only what differs from the cells that the screen shows is sent, a run of equal cells at a time.

cells: bytearray. What the screen shows, two cells a byte; then what a row ought to show; the outline's first and last column and row; the number
of cells of the way, their columns and rows; what has been heard.
work: array('i') of numbers that are never negative, see the constants below and those of screen.py.
texts, ends: all forms and texts, one after the other with a newline behind each, which is not sent; and where each ends.
"""

import micropython
from micropython import const

_COLUMNS = const(48)
_ROWS = const(36)
_CELL = const(5)  # pixels
_AHEAD = const(21)  # rows ahead of the body's middle
_POINT = const(5)  # colours beside those of the windows: a point in none of them, the outline, the way
_OUTLINE = const(6)
_WAY = const(7)
_STEPS = const(14)  # most cells of the way
_ZERO = const(8192)  # added to the coordinates of points
_BIAS = const(0x8000)  # added to numbers that may be negative
_TOP = const(256)  # of the buttons: two rows of three, 80 pixels wide and 32 high
_WIDE = const(80)
_HIGH = const(32)
_OK = const(64)
_RESTARTED = const(128)

# Places in cells
_WANTED = const(864)
_SHAPE = const(912)
_COUNT = const(916)
_HEARD = const(945)

# Places in work: seven numbers of a box, or of a text; eight that may be negative; the text that is put into another
_NUMBERS = const(7)
_INSIDE = const(15)
_PALETTE = const(16)  # eight colours
_Y = const(24)  # row of the picture that is next
_FRESH = const(25)  # 1: what it ought to show has yet to be found
_SCALE = const(26)  # mm of a cell
_HALF = const(27)  # of the body's length, mm
_COORDINATES = const(28)  # 1: touches come as coordinates
_FILLING = const(29)  # two bytes, for even and odd places


@micropython.viper
def emit(command: ptr8, at: int, texts: ptr8, ends: ptr16, number: int, work: ptr32) -> int:
    """Put a text into the command at `at`; returns the place behind it. With number -1 fill the command up to `at`, from work[0] on: empty lines or instructions do nothing.

    A byte 1 .. 7 in it stands for work[byte - 1]; 8 for another text; 16 .. 23 for one of the numbers that may be negative, 24 .. 31 for a tenth of one.
    """
    if number < 0:
        number = work[0]
        while number < at:
            command[number] = work[_FILLING + (number & 1)]
            number += 1
        return at
    end = ends[number]
    start = ends[number - 1] if number else 0
    after = 0
    last = 0
    while start < end:
        byte = texts[start]
        start += 1
        value = -1
        least = 1
        if byte == 8:
            after = start
            last = end
            number = work[_INSIDE]
            start = ends[number - 1]
            end = ends[number]
        elif byte < 8:
            value = work[byte - 1]
        elif byte >= 16 and byte < 32:
            value = work[_NUMBERS + (byte & 7)] - _BIAS
            if byte >= 24:
                least = 10
            if value < 0:
                command[at] = 0x2D
                at += 1
                value = 0 - value
        elif byte != 10:
            command[at] = byte
            at += 1
        if value >= 0:
            power = least
            while value // power >= 10:
                power *= 10
            while power:
                if power * 10 == least:
                    command[at] = 0x2E
                    at += 1
                command[at] = 0x30 + value // power % 10
                at += 1
                power //= 10
        if start == end and after:
            start = after
            end = last
            after = 0
    return at


@micropython.viper
def box(cells: ptr8, c: int, at: int, work: ptr32, px: ptr16, py: ptr16, windows: ptr8, count: int) -> int:
    """The next cells of a row that are to change: their box and colour (x1, y1, x2, y2, width, height, colour) into work, and into what is shown; 0 when the row is done.

    c, at: 0; arguments lie in registers. px, py: array('H') of mm + 8192 in the body frame; windows: the window of each point.
    """
    y = work[_Y]
    if work[_FRESH]:
        work[_FRESH] = 0
        while c < _COLUMNS:
            colour = 0
            if y >= cells[_SHAPE + 2] and y <= cells[_SHAPE + 3] and c >= cells[_SHAPE] and c <= cells[_SHAPE + 1]:
                if y == cells[_SHAPE + 2] or y == cells[_SHAPE + 3] or c == cells[_SHAPE] or c == cells[_SHAPE + 1]:
                    colour = _OUTLINE
            cells[_WANTED + c] = colour
            c += 1
        c = cells[_COUNT]
        while c:
            if cells[_COUNT + 2 * c] == y:
                cells[_WANTED + cells[_COUNT - 1 + 2 * c]] = _WAY
            c -= 1
        scale = work[_SCALE]
        high = _ZERO + (_AHEAD - y) * scale
        low = high - scale
        left = _COLUMNS // 2 * scale - _ZERO
        while count:
            count -= 1
            at = py[count]
            if at > low and at <= high:
                at = px[count] + left
                if at >= 0:
                    at = at // scale
                    if at < _COLUMNS:
                        colour = windows[count]
                        if colour == 0:
                            colour = _POINT
                        at += _WANTED
                        if cells[at] == 0 or colour < cells[at]:
                            cells[at] = colour
    while c < _COLUMNS:
        at = y * _COLUMNS + c >> 1
        shown = cells[at] >> 4 if c & 1 else cells[at] & 15
        if cells[_WANTED + c] != shown:
            colour = cells[_WANTED + c]
            work[0] = c * _CELL
            while c < _COLUMNS and cells[_WANTED + c] == colour:
                at = y * _COLUMNS + c >> 1
                cells[at] = cells[at] & 15 | colour << 4 if c & 1 else cells[at] & 0xF0 | colour
                c += 1
            work[1] = y * _CELL
            work[2] = c * _CELL - 1
            work[3] = y * _CELL + _CELL - 1
            work[4] = c * _CELL - work[0]
            work[5] = _CELL
            work[6] = work[_PALETTE + colour]
            return 1
        c += 1
    work[_Y] = y + 1
    work[_FRESH] = 1
    return 0


@micropython.viper
def way(cells: ptr8, work: ptr32, vx: int, vy: int, w: int, span: int, v: int):
    """Lay the way of the end that leads into the cells, a cell a step. vx, vy, w, span: of Steering; v: 90 where there is none to show, below it backward."""
    scale = work[_SCALE]
    count = 0
    x = 0
    y = work[_HALF]
    if v < 90:
        vx = 0 - vx
        vy = 0 - vy
        w = 0 - w
        y = 0 - y
    vx += 2 * w * y // span
    y *= 16
    while v != 90 and count < _STEPS:
        a = vx if vx >= 0 else 0 - vx
        b = vy if vy >= 0 else 0 - vy
        speed = a + (b * 3 >> 3) if a > b else b + (a * 3 >> 3)
        if speed < 512:
            break
        speed >>= 4
        x += vx * scale // speed
        y += vy * scale // speed
        a = (x + _COLUMNS // 2 * scale * 16) // (scale * 16)
        b = (_AHEAD * scale * 16 - y) // (scale * 16)
        if a < 0 or a >= _COLUMNS or b < 0 or b >= _ROWS:
            break
        count += 1
        cells[_COUNT - 1 + 2 * count] = a
        cells[_COUNT + 2 * count] = b
        b = 2 * w * scale // span * 1024 // speed  # the angle of a step, in 1/16384
        a = vx + (vy * b >> 14)
        vy -= vx * b >> 14
        vx = a
    cells[_COUNT] = count


@micropython.viper
def hear(cells: ptr8, at: int, byte: int, work: ptr32, data: ptr8, count: int) -> int:
    """What a screen has sent: the number of a button, 0 for none, + 64 when it has answered OK, + 128 when it has started anew.

    Touches come as [BN:n], of which only the brackets count, as whether an end of line follows is not documented; or as 67 xx xx yy yy 01 FF FF FF.
    """
    said = 0
    k = 0
    while k < count:
        byte = data[k]
        k += 1
        touched = 0
        if work[_COORDINATES]:
            at = _HEARD
            while at < _HEARD + 8:
                cells[at] = cells[at + 1]
                at += 1
            cells[at] = byte
            if byte == 0xFF and cells[_HEARD + 7] == 0xFF and cells[_HEARD + 6] == 0xFF:
                if cells[_HEARD + 5] == 0x88:
                    said |= _RESTARTED
                at = cells[_HEARD + 1] << 8 | cells[_HEARD + 2]
                y = (cells[_HEARD + 3] << 8 | cells[_HEARD + 4]) - _TOP
                if cells[_HEARD] == 0x67 and cells[_HEARD + 5] == 1 and at < 3 * _WIDE and y >= 0 and y < 2 * _HIGH:
                    touched = 1 + at // _WIDE + 3 * (y // _HIGH)
        else:
            if byte == 0x4B and cells[_HEARD + 2] == 0x4F:
                said |= _OK
            cells[_HEARD + 2] = byte
            at = cells[_HEARD]
            cells[_HEARD] = 0
            if byte == 0x5B:
                cells[_HEARD] = 1
            elif at == 1 and byte == 0x42 or at == 2 and byte == 0x4E or at == 3 and byte == 0x3A:
                cells[_HEARD] = at + 1
                cells[_HEARD + 1] = 0
            elif at >= 4 and at < 6 and byte >= 0x30 and byte < 0x3A:
                cells[_HEARD] = at + 1
                cells[_HEARD + 1] = cells[_HEARD + 1] * 10 + byte - 0x30
            elif at > 4 and byte == 0x5D and cells[_HEARD + 1] < 7:
                touched = cells[_HEARD + 1]
        if touched and said & 63 != 1 and said & 63 != 4:  # of several the one that stops
            said = said & 0xC0 | touched
    return said
