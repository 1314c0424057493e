"""screen.py: the points round the body as boxes, lines of text only when they change, touches in whatever pieces they come, a screen that does not answer."""

import micropython

from link import screen_build
from link.reason_texts import FAULTS, REASONS
from link.screen import Screen

SIZE = 192
ORIGIN = 8192


class Uart:
    """Keeps what is written; answers OK to each command where `answers` is true."""

    def __init__(self, answers=True):
        self.commands = []
        self.input = b""
        self.answers = answers
        self.counting = False
        self.count = 0

    def write(self, data):
        self.count += 1
        if not self.counting:
            assert len(data) == SIZE
            self.commands.append(bytes(data))
            if self.answers:
                self.input += b"OK\r\n"

    def readinto(self, buffer):
        if self.counting or not self.input:
            return None
        count = min(len(buffer), len(self.input))
        for i in range(count):
            buffer[i] = self.input[i]
        self.input = self.input[count:]
        return count


class Aim:
    vx, vy, w, span = 0, 16384, 0, 497


class Part:
    mode, af, ar, v, free, why, points_count, speed20, fault, battery_mv, v256 = 1, -305, 7, 108, 700, 2, 0, 132, 0, 7412, 0
    points_ordered = True
    points_x = points_y = bytearray(200)
    points_window = bytearray(100)
    aim = Aim


class Robot:
    avoid = health = safety = lidar = drive = Part()


class Link:
    state = 1

    def __init__(self):
        self.pressed = []

    def stop(self):
        self.pressed.append("stop")

    def drive_itself(self):
        self.pressed.append("auto")


class Config:
    robot_length, robot_width = 600, 250


def points(*places):
    """Puts points (x, y, window) round the body."""
    from array import array

    Part.points_x = array("H", [x + ORIGIN for x, _, _ in places] + [0])
    Part.points_y = array("H", [y + ORIGIN for _, y, _ in places] + [0])
    Part.points_window = bytearray([w for _, _, w in places] + [0])
    Part.points_count = len(places)


def show(kind="usart-gpu", link=None, start=0, stop=3_000_000, uart=None, screen=None, answers=True):
    uart = uart or Uart(answers)
    screen = screen or Screen(uart, kind, 115200, Config)
    for now in range(start, stop, 5000):
        screen.update(now, Robot, link or Link())
    return uart, screen


def parts(uart, first=0):
    """The commands, without their filling."""
    found = []
    for command in uart.commands[first:]:
        for part in command.replace(b"\r\n", b";").replace(b"\xff\xff\xff", b";").split(b";"):
            part = part.strip(b"\r\n\xff")
            if part:
                found.append(part)
    return found


def boxes(found):
    """Those of the picture."""
    return [part for part in found if part.startswith(b"BOXF(") and int(part[5:].split(b",")[1]) < 180]


def test_four_lines_are_shown_once():
    points()
    found = parts(show()[0])
    for text in (b"'AUTO  mode 1  free 700 mm'", b"'AF -30.5  AR 0.7  V 108'", b"'through the gap'", b"'battery 7.4 V  lidar 396 rpm'"):
        assert len([part for part in found if text in part]) == 1, text
    assert found[0] == b"CLS(0)" and b"DS16(4,182,'AUTO  mode 1  free 700 mm',2)" in found


def test_the_outline_and_the_way_are_drawn_once():
    points()
    uart, screen = show()
    found = boxes(parts(uart))
    assert b"BOXF(105,70,134,74,15)" in found and b"BOXF(105,135,134,139,15)" in found  # nose and tail, 46 mm a cell
    assert b"BOXF(120,65,124,69,6)" in found and b"BOXF(120,0,124,4,6)" in found  # straight ahead
    before = len(uart.commands)
    show(start=3_000_000, stop=5_000_000, uart=uart, screen=screen)
    assert len(uart.commands) == before


def test_a_point_is_a_cell_in_the_colour_of_its_window_and_goes_with_it():
    points((500, 400, 4), (500, 380, 2), (-500, -400, 0), (150, 10, 3), (140, 16, 2))
    uart, screen = show()
    found = boxes(parts(uart))
    assert b"BOXF(170,60,174,64,1)" in found  # of two in a cell the more urgent one
    assert b"BOXF(65,145,69,149,7)" in found
    assert b"BOXF(135,100,139,104,1)" in found  # beside the body, at its middle
    points((-500, -400, 0))
    before = len(uart.commands)
    show(start=3_000_000, stop=3_500_000, uart=uart, screen=screen)
    assert sorted(boxes(parts(uart, before))) == [b"BOXF(135,100,239,104,0)", b"BOXF(170,60,239,64,0)"]  # to the end of what is empty
    assert b"BOXF(130,95,134,99,15)" not in parts(uart, before)


def test_points_far_off_or_out_of_order_are_left_out():
    points((5000, 0, 4), (0, 5000, 4), (-5000, -5000, 4))
    plain = boxes(parts(show()[0]))
    points((300, 300, 4))
    Part.points_ordered = False
    try:
        assert not boxes(parts(show()[0]))
    finally:
        Part.points_ordered = True
    points()
    assert plain == boxes(parts(show()[0]))


def test_the_way_goes_where_the_steering_leads():
    points()
    for v, w, first, right in ((108, 0, 65, 0), (72, 0, 140, 0), (108, 6000, 65, 1), (108, -6000, 65, -1)):
        Part.v, Aim.w = v, w
        try:
            # Boxes of the way, from the body on
            way = [tuple(int(n) for n in part[5:-1].split(b",")) for part in boxes(parts(show()[0])) if part.endswith(b",6)")]
        finally:
            Part.v, Aim.w = 108, 0
        assert any(y == first for _, y, _, _, _ in way), v
        columns = [x for x, _, _, _, _ in way]
        assert (max(columns) > 140) == (right > 0) and (min(columns) < 100) == (right < 0), (w, columns)
    Part.v = 90
    try:
        assert not [part for part in boxes(parts(show()[0])) if part.endswith(b",6)")]
    finally:
        Part.v = 108


def test_each_dialect_has_its_own_words():
    points((500, 400, 4))
    lcd = parts(show("uart-lcd")[0])
    assert lcd[0] == b"CLR(0)" and any(part.startswith(b"DC16(4,") for part in lcd) and any(b"no touch" in part for part in lcd)
    assert not any(part.startswith((b"DS", b"BTN", b"TPN")) for part in lcd)
    nextion = parts(show("nextion")[0])
    assert b"sendxy=1" in nextion and b"fill 170,60,5,5,65120" in nextion
    assert b'xstr 4,218,236,18,0,65535,0,0,1,1,"through the gap"' in nextion
    assert not any(b"BOXF" in part for part in nextion)


def test_a_fault_takes_the_last_line():
    points()
    Robot.safety.fault = 4
    try:
        assert any(b"'! battery empty',1" in part for part in parts(show()[0]))
    finally:
        Robot.safety.fault = 0


def test_every_reason_and_fault_has_a_text_that_fits():
    reasons, faults = (text.decode().split("\n")[:-1] for text in (screen_build.REASONS, screen_build.FAULTS))
    assert len(reasons) == len(REASONS) and len(faults) == len(FAULTS)
    for short, full in zip(reasons + faults[1:], REASONS + FAULTS[1:]):
        assert bool(short) == bool(full) and len(short) <= 29
    points()
    for why in range(len(REASONS)):
        Part.why = why
        try:
            assert any(("'%s',15)" % reasons[why]).encode() in part for part in parts(show(stop=1_000_000)[0])), why
        finally:
            Part.why = 2


def test_touch_in_brackets():
    points()
    for text, expected in ((b"OK\r\n[BN:1]\r\n", "stop"), (b"[BN:4]", "stop"), (b"[BN:02]", "auto"), (b"[BN:5]", "auto"), (b"[BN:12]", None),
                           (b"[[BN:1]", "stop"), (b"[XN:1]BN:1]", None), (b"[BN:0]", None), (b"[BN:2][BN:1][BN:2]", "stop"), (b"[BN:]", None)):  # fmt: skip
        for size in (1, 3, 16):
            link, uart = Link(), Uart()
            screen = Screen(uart, "usart-gpu", 115200, Config)
            for at in range(0, len(text), size):
                uart.input = text[at : at + size]
                screen.update(at, Robot, link)
            assert (link.pressed or [None])[-1 if size == 1 and expected == "auto" else 0] == expected or size < 16 and "stop" in link.pressed, (text, size)


def nextion_touch(x, y, event=1):
    return bytes([0x67, x >> 8, x & 255, y >> 8, y & 255, event]) + b"\xff\xff\xff"


def test_touch_by_coordinates():
    points()
    for data, expected in (
        (nextion_touch(10, 300), ["stop"]), (nextion_touch(90, 260), ["auto"]), (nextion_touch(90, 260, 0), []), (nextion_touch(90, 200), []),
        (nextion_touch(250, 300), []), (b"\x67\x00\x5a\x01\x04\x01\xff\xff", []), (b"g" * 40 + b"\xff" * 9, []),
    ):  # fmt: skip
        link, uart = Link(), Uart()
        screen = Screen(uart, "nextion", 9600, Config)
        uart.input = data
        for now in range(0, 40, 5):
            screen.update(now, Robot, link)
        assert link.pressed == expected, data


def test_a_screen_that_never_answers_is_told_all_the_same():
    points((500, 400, 4))
    patient = parts(show(answers=False, stop=8_000_000)[0])
    assert b"BOXF(170,60,174,64,4)" in patient and any(b"'through the gap'" in part for part in patient)
    assert len(show(answers=False, stop=1_000_000)[0].commands) <= 4


def test_a_screen_that_is_plugged_in_later_is_told_everything_anew():
    points((500, 400, 4))
    uart, screen = show(answers=False, stop=8_000_000)
    before = len(uart.commands)
    uart.answers = True
    uart.input = b"OK\r\n"
    show(start=8_000_000, stop=10_000_000, uart=uart, screen=screen)
    found = parts(uart, before)
    assert b"CLS(0)" in found and b"BOXF(170,60,174,64,4)" in found and any(b"'through the gap'" in part for part in found)
    uart, screen = show("nextion")
    before = len(uart.commands)
    uart.input = b"\x00\x00\x00\xff\xff\xff\x88\xff\xff\xff"
    show(start=3_000_000, stop=5_000_000, uart=uart, screen=screen)
    assert b"cls 0" in parts(uart, before) and b"fill 170,60,5,5,65120" in parts(uart, before)


def test_showing_allocates_nothing():
    points((500, 400, 4), (-300, 100, 2))
    uart, screen = show(answers=False, stop=8_000_000)
    link = Link()
    part = Robot.avoid
    part.free = 0
    uart.counting = True
    uart.count = 0
    micropython.heap_lock()
    try:
        now = 8_000_000
        while now < 9_000_000:
            part.free += 1
            part.points_x[0] += 1
            screen.update(now, Robot, link)
            now += 5000
    finally:
        micropython.heap_unlock()
        part.free = 700
    assert uart.count >= 5
