"""screen.py: short lines, only when something changed, and buttons in whatever pieces they come."""

import micropython

from link.screen import Screen


class Uart:
    def __init__(self):
        self.lines = []
        self.input = b""
        self.counting = False
        self.count = 0

    def write(self, data):
        if self.counting:
            self.count += 1
        else:
            self.lines.append(bytes(data))

    def readinto(self, buffer):
        if not self.input:
            return None
        count = min(len(buffer), len(self.input))
        for i in range(count):
            buffer[i] = self.input[i]
        self.input = self.input[count:]
        return count


class Part:
    mode, af, ar, v, free, why, points_count, speed20, fault, battery_mv = 1, -305, 7, 108, 700, 2, 74, 132, 0, 7412


class Robot:
    avoid = health = safety = lidar = Part()


class Link:
    state = 1
    pressed = None

    def stop(self):
        self.pressed = "stop"

    def drive_itself(self):
        self.pressed = "auto"


def show(kind, link=None, start=0, stop=3_000_000, uart=None, screen=None):
    uart = uart or Uart()
    screen = screen or Screen(uart, kind, 115200)
    for now in range(start, stop, 5000):
        screen.update(now, Robot, link or Link())
    return uart, screen


def texts(uart):
    return b"\n".join(uart.lines)


def test_five_lines_are_shown_once():
    uart, _ = show("usart-gpu")
    shown = texts(uart)
    for part in (b"CLS(0);", b"'AUTO  mode 1  free 700 mm", b"'AF -30.5  AR 0.7  V 108", b"'steering through the gap"):
        assert part in shown, part
    assert b"'74 points, lidar 396 rpm" in shown and b"'battery 7.4 V" in shown
    assert len(uart.lines) == 3 + 5
    assert all(line.endswith(b"\r\n") and len(line) < 120 for line in uart.lines)


def test_each_dialect_has_its_own_words():
    lcd = texts(show("uart-lcd")[0])
    assert b"CLR(0);" in lcd and b"DC16(" in lcd and b"DS16" not in lcd
    nextion = show("nextion")[0].lines
    assert all(line.endswith(b"\xff\xff\xff") for line in nextion) and any(line.startswith(b't2.txt="steering') for line in nextion)


def test_a_line_fits_its_field_and_a_change_is_shown():
    uart, screen = show("usart-gpu")
    before = len(uart.lines)
    Robot.avoid.why = 6  # longer than the field
    try:
        show("usart-gpu", None, 3_000_000, 4_000_000, uart, screen)
    finally:
        Robot.avoid.why = 2
    (line,) = uart.lines[before:]
    assert b"'way ahead closes, comparing two move'" in line


def test_a_fault_takes_the_last_line():
    Robot.safety.fault = 4
    try:
        assert b"'! battery is empty: charge it" in texts(show("usart-gpu")[0])
    finally:
        Robot.safety.fault = 0


def test_touch_in_brackets():
    for text, expected in ((b"OK\r\n[BN:1]\r\n", "stop"), (b"[BN:02]", "auto"), (b"[BN:12]", None), (b"[[BN:1]", "stop"), (b"[XN:1]BN:1]", None)):
        for size in (1, 3, 16):
            link, uart = Link(), Uart()
            screen = Screen(uart, "usart-gpu", 115200)
            for at in range(0, len(text), size):
                uart.input = text[at : at + size]
                screen.update(at, Robot, link)
            assert link.pressed == expected, (text, size)


def test_touch_of_a_nextion():
    link, uart = Link(), Uart()
    screen = Screen(uart, "nextion", 9600)
    uart.input = b"\x65\x00\x02\x00\xff\xff\xff"
    screen.update(0, Robot, link)
    assert link.pressed is None
    uart.input = b"\x65\x00\x02\x01\xff\xff\xff"
    screen.update(0, Robot, link)
    assert link.pressed == "auto"


def test_showing_allocates_nothing():
    uart, screen = show("usart-gpu")
    link = Link()
    part = Robot.avoid
    part.free = 0
    uart.counting = True
    micropython.heap_lock()
    try:
        now = 3_000_000
        while now < 4_000_000:
            part.free += 1
            screen.update(now, Robot, link)
            now += 5000
    finally:
        micropython.heap_unlock()
        part.free = 700
    assert uart.count >= 2
