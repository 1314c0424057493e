"""The three families of screens: how their commands look, and what they send.

`split(screen)` takes whole lines from what has come; `commands(line)` its commands; `do(command)` carries one out and returns the pixels painted, None for one that is not
known; `answer` is sent after a line; `touched(x, y)` is what a touch sends.
"""

import re
from typing import Any

# Palette of "Usart GPU", by number; the others of its 64 colours are not used
PALETTE = (
    (0, 0, 0), (232, 48, 56), (32, 176, 80), (72, 128, 255), (255, 214, 10), (32, 208, 224), (232, 64, 216), (136, 136, 136), (200, 200, 200), (150, 90, 40),
    (16, 112, 52), (16, 32, 110), (150, 130, 0), (255, 140, 0), (255, 128, 128), (255, 255, 255),
)  # fmt: skip
_PARTS = re.compile(rb"(?:[^;']|'[^']*')+")
_CALL = re.compile(rb"([A-Z]+)(\d*)(?:\((.*)\))?", re.DOTALL)
_FIELDS = re.compile(rb"'[^']*'|[^,]+")
_NEXTION_END = b"\xff\xff\xff"
_STRING = re.compile(rb'(.*),"([^"]*)"', re.DOTALL)


class _Lines:
    """What the two ASCII families have in common: commands between semicolons, done when the line ends."""

    answer = b"OK\r\n"
    clear, text, turn = "", "", ""

    def __init__(self, glass):
        self._glass = glass

    def split(self, screen):
        """Whole lines, without empty ones."""
        while match := re.search(rb"[\r\n]", screen.text):
            line = screen.take_text(match.end())[:-1]
            if line.strip():
                yield line

    def commands(self, line):
        """The commands of a line."""
        return _PARTS.findall(line)

    def do(self, command):
        """See above."""
        match = _CALL.fullmatch(command)
        if match is None:
            return None
        name, size = match[1].decode(), match[2]
        fields = _FIELDS.findall(match[3] or b"")
        try:
            if name == self.clear and not size:
                return self._glass.clear(PALETTE[int(fields[0])])
            if name == "BOXF" and not size:
                *corners, colour = (int(field) for field in fields)
                return self._glass.box(*corners, PALETTE[colour])
            if name == self.text and size in (b"12", b"16", b"24", b"32"):
                x, y, text, colour = fields
                return self._glass.text(int(x), int(y), text[1:-1].decode("gb2312", "replace"), int(size), PALETTE[int(colour)])
            return self._own(name, size, fields)
        except (ValueError, TypeError, IndexError):
            return None

    def _own(self, name, size, fields):
        return None

    def touched(self, x, y):
        """See above."""
        return b""


class UsartGpu(_Lines):
    """ "Usart GPU": hot spots that are told by their number."""

    clear, text = "CLS", "DS"

    def __init__(self, glass):
        super().__init__(glass)
        self._spots: dict[int, list] = {}
        self._touch = 0

    def _own(self, name, size, fields):
        if name == "DR" and size in (b"0", b"1", b"2", b"3") and not fields:
            return 0
        if name == "TPN" and len(fields) in (1, 2):
            self._touch = int(fields[0])
            return 0
        if name == "BTN" and len(fields) in (6, 7):
            number, *box = (int(field) for field in fields[:5])
            self._spots[number] = box
            return 0
        return None

    def touched(self, x, y):
        """Mode 2 tells the number of the hot spot."""
        for number, (x1, y1, x2, y2) in self._spots.items():
            if self._touch == 2 and x1 <= x <= x2 and y1 <= y <= y2:
                return b"[BN:%d]" % number
        return b""


class UartLcd(_Lines):
    """HFD, HF0xx."""

    clear, text = "CLR", "DC"

    def _own(self, name, size, fields):
        return 0 if name == "DIR" and not size and len(fields) == 1 and int(fields[0]) in range(4) else None


class Nextion:
    """Nextion and TJC; told by bkcmd=0 not to answer."""

    answer = b""

    def __init__(self, glass):
        self._glass = glass
        self._coordinates = False

    def split(self, screen):
        """Instructions, without empty ones."""
        while (end := screen.text.find(_NEXTION_END)) >= 0:
            line = screen.take_text(end + 3)[:-3].strip(b"\xff")
            if line:
                yield line

    def commands(self, line):
        """It is one."""
        return [line]

    def do(self, command):
        """See above."""
        try:
            if command in (b"bkcmd=0", b"sendxy=1"):
                self._coordinates = self._coordinates or command == b"sendxy=1"
                return 0
            name, _, rest = command.partition(b" ")
            if name == b"cls":
                return self._glass.clear(_rgb(int(rest)))
            if name == b"fill":
                x, y, wide, high, colour = map(int, rest.split(b","))
                return self._glass.box(x, y, x + wide - 1, y + high - 1, _rgb(colour))
            if name == b"xstr" and (match := _STRING.fullmatch(rest)):
                return self._string([int(number) for number in match[1].split(b",")], match[2].decode("ascii", "replace"))
        except (ValueError, TypeError):
            pass
        return None

    def _string(self, numbers, text):
        x, y, wide, high, _, colour, ground, across, along, solid = numbers  # the fifth is the font, which the page's author chose
        painted = self._glass.box(x, y, x + wide - 1, y + high - 1, _rgb(ground)) if solid == 1 else 0
        size = 24 if high > 40 else 16
        left = x + (wide - len(text) * size // 2) // 2 if across == 1 else x
        return painted + self._glass.text(left, y + (high - size) // 2 if along == 1 else y, text, size, _rgb(colour))

    def touched(self, x, y):
        """Coordinates, pressed."""
        return bytes((0x67, x >> 8, x & 255, y >> 8, y & 255, 1)) + _NEXTION_END if self._coordinates else b""


def _rgb(colour):
    return (colour >> 11) * 255 // 31, (colour >> 5 & 63) * 255 // 63, (colour & 31) * 255 // 31


DIALECTS: dict[str, Any] = {"usart-gpu": UsartGpu, "uart-lcd": UartLcd, "nextion": Nextion}
