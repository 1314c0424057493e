"""The serial touch screen at its bytes: takes what the firmware sends, answers as its dialect does, and shows what a person would see.

A command takes the time of its bytes on the line and some for drawing. What it does not know it keeps in `refused`, and what does not fit its
line buffer is lost, as on the real ones. Sources: the vendors' command lists, as named in firmware/lib/link/screen_build.py; the times are assumed.
"""

from collections import deque

from ..line import BITS, Line
from .glass import Glass

KINDS = ("usart-gpu", "uart-lcd", "nextion")
BUFFER = 1024  # bytes of a line, or waiting to be done
COMMAND_US, PIXEL_US = 300.0, 0.15  # a command, and each pixel that it paints
KEPT = 20  # of what was not understood


class Screen:
    """One screen. glass: what it shows. line: bytes on their way to the robot.

    For an Observer to change: silent, it sends nothing; factor, on the time that drawing takes; rubbish, bytes that it sends in place of each answer;
    present, False: nobody there. refused: the last commands that it did not know. lost: bytes that found its buffer full. done: commands carried out.
    """

    def __init__(self, kind, baud):
        from . import dialects

        self.kind, self.baud = kind, baud
        self.glass = Glass()
        self.line = Line(baud)
        self._dialect = dialects.DIALECTS[kind](self.glass)
        self._byte_us = BITS * 1e6 / baud
        self._arrived = self._free = 0.0  # the last byte so far; when it has done all it was told
        self._waiting: deque = deque()  # (us at which it is done, bytes)
        self._text = b""
        self.silent, self.factor, self.rubbish, self.present = False, 1.0, b"", True
        self.refused: deque = deque(maxlen=KEPT)
        self.lost = self.done = 0

    def receive(self, time, data):
        """Bytes that the robot began to send at the time, us."""
        self._arrived = max(self._arrived, time) + len(data) * self._byte_us
        if not self.present:
            return
        while self._waiting and self._waiting[0][0] <= self._arrived:
            self._waiting.popleft()
        if sum(size for _, size in self._waiting) + len(data) > BUFFER:
            self.lost += len(data)
            return
        self._text += data
        for line in self._dialect.split(self):
            painted = self._carry_out(line)
            self._free = max(self._free, self._arrived) + self.factor * (COMMAND_US + painted * PIXEL_US)
            if self._dialect.answer and not self.silent:
                self.send(self._free, self.rubbish or self._dialect.answer)
        self._waiting.append((max(self._free, self._arrived), len(data)))

    def send(self, time, data):
        """Bytes to the robot, from the time on. Each is on the line by itself: what has arrived of them is then the same whenever the firmware's time stops, and so in a replay."""
        for k in range(len(data)):
            self.line.send(time, data[k : k + 1])

    def touch(self, time, x, y):
        """A finger at a place of the glass, pixels from the upper left; nothing happens where the dialect has no touch."""
        said = self._dialect.touched(int(x), int(y))
        if said and self.present and not self.silent:
            self.send(time, said)

    def plug(self, present):
        """Take it off the robot, or put it on: it starts dark, and knows nothing."""
        from . import dialects

        self.present = present
        self._text = b""
        self._waiting.clear()
        self.glass.clear((0, 0, 0))
        self._dialect = dialects.DIALECTS[self.kind](self.glass)

    def take_text(self, count):
        """The first bytes of what has come, for the dialect, which has found that they are a whole line."""
        text, self._text = self._text[:count], self._text[count:]
        return text

    @property
    def text(self):
        """What has come and is no whole line yet."""
        return self._text

    def _carry_out(self, line):
        painted = 0
        for command in self._dialect.commands(line):
            found = self._dialect.do(command)
            if found is None:
                self.refused.append(command)
            else:
                self.done += 1
                painted += found
        return painted
