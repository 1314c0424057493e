"""Serial touch screens: what the robot does, in five lines, and two buttons. screen_dialects.py has what each family wants to be told.

All lines share one prepared command, in which what goes before the text and the text change, so that nothing is put together while the robot
drives. One command at most goes out a call, and only when the line has had time to send the one before: a write never waits.
"""

from time import ticks_add, ticks_diff

from micropython import const

from core.crc16 import crc16
from link.telemetry import copy

_WIDTH = const(36)  # characters in a line
_LINES = const(5)
_PERIOD_US = const(60_000)
_CLEARING_US = const(300_000)  # the screen clears itself before it listens again
_PRESSED = const(4096)  # of touch_brackets.py and touch_nextion.py
_STOP = const(4097)
_AUTO = const(4098)
_STATES = (b"STOP", b"AUTO", b"HAND")


class Screen:
    """Shows the robot on a screen and hears its buttons.

    uart: UART with a txbuf of at least 128 bytes; kind: screen.kind of robot.json; baud: speed of the line.
    """

    def __init__(self, uart, kind, baud):
        from link import screen_dialects

        self._uart = uart
        self._start, self._befores, after = screen_dialects.commands(kind, _LINES)
        self._first = first = len(self._befores) // _LINES  # where the text begins, and where it ends
        self._end = first + _WIDTH
        self._texts, self._ends, self._first_fault = screen_dialects.texts(_WIDTH)
        self._hear = screen_dialects.hearing(kind)
        self._command = bytearray(first + _WIDTH) + after
        self._shown = [-1] * _LINES  # check of each text on the screen
        self._at = 0  # where the next character of the text goes
        self._byte_us = 10_000_000 // baud
        self._ready_us = None  # when the line has sent what it has
        self._input = bytearray(16)
        self._line = self._touch = 0

    def update(self, now_us, robot, link):
        """Show one line if it is time, hear the buttons: stop and auto go to the link. robot: as for the link."""
        self._listen(link)
        if self._ready_us is not None and ticks_diff(now_us, self._ready_us) < 0:
            return
        if self._start:
            self._write(self._start.pop(0), now_us, _CLEARING_US)
            return
        line = self._line
        self._line = (line + 1) % _LINES
        self._at = self._first
        self._compose(line, robot, link)
        while self._at < self._end:
            self._put_byte(0x20)
        check = crc16(self._command, self._first, self._end)
        if check != self._shown[line]:
            self._shown[line] = check
            copy(self._befores, line * self._first, self._first, self._command, 0)
            self._write(self._command, now_us, _PERIOD_US)

    def _write(self, command, now_us, least_us):
        self._uart.write(command)
        self._ready_us = ticks_add(now_us, max(least_us, 2 * len(command) * self._byte_us))

    def _compose(self, line, robot, link):
        avoid = robot.avoid
        if line == 0:
            self._put(_STATES[link.state])
            self._fill(b"  mode #  free # mm", avoid.mode, avoid.free, 0)
        elif line == 1:
            self._fill(b"AF ~  AR ~  V #", avoid.af, avoid.ar, avoid.v)
        elif line == 2:
            self._put_text(avoid.why)
        elif line == 3:
            self._fill(b"# points, lidar # rpm", max(avoid.points_count, 0), robot.lidar.speed20 * 3, 0)
        elif robot.safety.fault:
            self._put(b"! ")
            self._put_text(self._first_fault + robot.safety.fault)
        else:
            self._fill(b"battery ~ V", robot.health.battery_mv // 100, 0, 0)

    def _fill(self, form, value, second, third):
        """Append a form with the next of the values for each #, and a tenth of it, with one decimal, for each ~."""
        for byte in form:
            if byte != 0x23 and byte != 0x7E:
                self._put_byte(byte)
                continue
            if value < 0:
                self._put_byte(0x2D)
                value = -value
            least = 1 if byte == 0x23 else 10  # of two digits, if one is behind the point
            power = least
            while value // power >= 10:
                power *= 10
            while power:
                if power * 10 == least:
                    self._put_byte(0x2E)
                self._put_byte(0x30 + value // power % 10)
                power //= 10
            value = second
            second = third

    def _put(self, what, start=0, end=None):
        """Append bytes, as far as the line reaches."""
        count = min((len(what) if end is None else end) - start, self._end - self._at)
        copy(what, start, count, self._command, self._at)
        self._at += count

    def _put_byte(self, byte):
        if self._at < self._end:
            self._command[self._at] = byte
            self._at += 1

    def _put_text(self, number):
        """Append a text of reason_texts.py."""
        self._put(self._texts, self._ends[number - 1] if number else 0, self._ends[number])

    def _listen(self, link):
        count = self._uart.readinto(self._input)
        if not count or self._hear is None:
            return
        i = 0
        while i < count:
            touch = self._hear(self._touch, self._input[i])
            if touch == _STOP:
                link.stop()
            elif touch == _AUTO:
                link.drive_itself()
            self._touch = touch if touch < _PRESSED else 0
            i += 1
