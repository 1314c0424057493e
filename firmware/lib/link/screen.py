"""Serial touch screens: what the robot does, in five lines, and two buttons.

Three families with commands of their own:

    usart-gpu   "Usart GPU" (stm32.sinaapp.com): CLS, DSnn, DRn, TPN, BTN; answers OK; touch as [BN:n]
    uart-lcd    "HFD / HF0xx UART LCD": CLR, DCnn, DIR; answers OK; no touch
    nextion     Nextion and TJC: a page with texts t0 to t4 and buttons of component numbers 1 (stop) and 2 (auto)

Every line of text has its own prepared command, in which only the text changes, so that nothing is put together while the robot drives. One
command at most goes out a call, and only when the line has had time to send the one before: a write never waits.

Source: the vendors' command lists; they disagree from unit to unit, so the dialect must be tried.
"""

from time import ticks_diff

from micropython import const

_WIDTH = const(36)  # characters in a line
_LINES = const(5)
_PERIOD_US = const(60_000)
_STATES = (b"STOP", b"AUTO", b"HAND")

# kind: (commands at the start, before a text with %d for the line's y or number, after it)
_DIALECTS = {
    "usart-gpu": (
        (b"CLS(0);DR1;TPN(2);\r\n", b"BTN(1,0,180,150,239,1);BOXF(0,180,150,239,1);DS24(45,198,'STOP',15);\r\n",
         b"BTN(2,170,180,319,239,1);BOXF(170,180,319,239,2);DS24(215,198,'AUTO',15);\r\n"),
        "BOXF(0,%d,319,%d,0);DS16(4,%d,'", b"',15);\r\n",
    ),
    "uart-lcd": (
        (b"CLR(0);DIR(1);\r\n",),
        "BOXF(0,%d,319,%d,0);DC16(4,%d,'", b"',15);\r\n",
    ),
    "nextion": (
        (b"bkcmd=0\xff\xff\xff",),
        't%d.txt="', b'"\xff\xff\xff',
    ),
}  # fmt: skip


class _Text:
    """One line on the screen: a whole command with a field of _WIDTH characters in it."""

    def __init__(self, before, after):
        self.command = bytearray(before + b" " * _WIDTH + after)
        self._first = len(before)
        self._at = self._first
        self._sum = 0
        self._shown = -1

    def begin(self):
        self._at = self._first
        self._sum = 0

    def put(self, text):
        """Append bytes."""
        for byte in text:
            self._byte(byte)

    def number(self, value):
        """Append an integer."""
        if value < 0:
            self._byte(0x2D)
            value = -value
        power = 1
        while value // power >= 10:
            power *= 10
        while power:
            self._byte(0x30 + value // power % 10)
            power //= 10

    def tenths(self, value):
        """Append value / 10 with one decimal."""
        if value < 0:
            self._byte(0x2D)
            value = -value
        self.number(value // 10)
        self._byte(0x2E)
        self._byte(0x30 + value % 10)

    def end(self):
        """Fill up with spaces; True when the line is not what was shown last."""
        while self._at < self._first + _WIDTH:
            self._byte(0x20)
        changed = self._sum != self._shown
        self._shown = self._sum
        return changed

    def _byte(self, byte):
        if self._at < self._first + _WIDTH:
            self.command[self._at] = byte
            self._at += 1
            self._sum = (self._sum * 31 + byte) & 0xFFFFFF


class Screen:
    """Shows the robot on a screen and hears its buttons.

    uart: UART with a txbuf of at least 128 bytes; kind: screen.kind of robot.json; baud: speed of the line.
    """

    def __init__(self, uart, kind, baud):
        from link.reason_texts import FAULTS, REASONS

        self._uart = uart
        start, before, after = _DIALECTS[kind]
        self._start = start
        self._nextion = kind == "nextion"
        self._lines = []
        for line in range(_LINES):
            y = 4 + 34 * line
            place = line if self._nextion else (y, y + 17, y)
            self._lines.append(_Text((before % place).encode(), after))
        self._reasons = [reason.encode() for reason in REASONS]
        self._faults = [fault.encode() for fault in FAULTS]
        self._byte_us = 10_000_000 // baud
        self._free_us = None
        self._wait_us = 0
        self._next = -len(start)
        self._input = bytearray(16)
        self._touch = 0
        self._number = 0

    def update(self, now_us, robot, link):
        """Show one line if it is time, hear the buttons: stop and auto go to the link. robot: as for the link."""
        self._listen(link)
        if self._free_us is not None and ticks_diff(now_us, self._free_us) < self._wait_us:
            return
        if self._next < 0:
            command = self._start[self._next]
            self._next += 1
            # The screen clears itself before it listens again.
            self._write(command, now_us, 300_000)
            return
        line = self._lines[self._next]
        line.begin()
        self._compose(line, self._next, robot, link)
        self._next = (self._next + 1) % _LINES
        if line.end():
            self._write(line.command, now_us, _PERIOD_US)

    def _write(self, command, now_us, least_us):
        self._uart.write(command)
        self._free_us = now_us
        self._wait_us = max(least_us, 2 * len(command) * self._byte_us)

    def _compose(self, line, number, robot, link):
        avoid, health = robot.avoid, robot.health
        if number == 0:
            line.put(_STATES[link.state])
            line.put(b"  mode ")
            line.number(avoid.mode)
            line.put(b"  free ")
            line.number(avoid.free)
            line.put(b" mm")
        elif number == 1:
            line.put(b"AF ")
            line.tenths(avoid.af)
            line.put(b"  AR ")
            line.tenths(avoid.ar)
            line.put(b"  V ")
            line.number(avoid.v)
        elif number == 2:
            line.put(self._reasons[avoid.why])
        elif number == 3:
            line.number(avoid.points_count)
            line.put(b" points, lidar ")
            line.number(robot.lidar.speed20 * 3)
            line.put(b" rpm")
        elif health.fault:
            line.put(b"! ")
            line.put(self._faults[health.fault])
        else:
            line.put(b"battery ")
            line.tenths(health.battery_mv // 100)
            line.put(b" V")

    def _listen(self, link):
        count = self._uart.readinto(self._input)
        if not count:
            return
        i = 0
        while i < count:
            if self._nextion:
                self._hear_nextion(self._input[i], link)
            else:
                self._hear_brackets(self._input[i], link)
            i += 1

    def _hear_brackets(self, byte, link):
        """Follow [BN:n]; _touch counts the characters matched. Whether an end of line follows is not documented, so the brackets count."""
        if byte == 0x5B:
            self._touch = 1
            self._number = 0
        elif 0 < self._touch < 4 and byte == b"[BN:"[self._touch]:
            self._touch += 1
        elif self._touch >= 4 and 0x30 <= byte <= 0x39 and self._number < 10:
            self._number = self._number * 10 + byte - 0x30
        else:
            if self._touch >= 4 and byte == 0x5D:
                self._press(self._number, link)
            self._touch = 0

    def _hear_nextion(self, byte, link):
        """Follow 65 page component event; the event 1 is a press."""
        if self._touch == 0:
            self._touch = 1 if byte == 0x65 else 0
        elif self._touch == 1:
            self._touch = 2
        elif self._touch == 2:
            self._number = byte
            self._touch = 3
        else:
            if byte == 1:
                self._press(self._number, link)
            self._touch = 0

    def _press(self, button, link):
        if button == 1:
            link.stop()
        elif button == 2:
            link.drive_itself()
