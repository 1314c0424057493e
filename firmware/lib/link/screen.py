"""Serial touch screens: what stands round the robot and what it does, and six buttons. screen_build.py has what each family wants to be told.

    rows 0 .. 179     the points round the body, head up, in the colours of their windows, the outline and the way that is driven
    182 .. 253        state, mode and free way; AF, AR, V; the reason; battery and lidar, or the fault
    256 .. 319        stop, start, set; while setting: see screen_menu.py

A call sends one command of a fixed length at most, made in place, and only when the line has had time to send the one before and the screen has
answered, or has had time to: a write never waits. Whatever the screen sends, or that it sends nothing, delays nobody.
"""

from time import ticks_diff

import micropython
from micropython import const

from core.crc16 import crc16
from link.screen_kernels import box, emit, hear, way

_ROWS = const(36)  # of the picture
_CELLS = const(864)  # bytes that hold it
_SIZE = const(192)  # of a command
_LAST = const(160)  # where a box may still begin
_LINES = const(4)
_TOP = const(182)
_HIGH = const(18)
_A_TURN = const(3)  # boxes and rows looked for
_PICTURE_US = const(150_000)  # from one picture to the next
_SILENT = const(3)  # commands without an answer: then the next answer is that of a screen that has been plugged in, or has started
_BIAS = const(0x8000)
_OK = const(64)
_RESTARTED = const(128)

# Places in work, besides those of screen_kernels.py
_NUMBERS = const(7)
_INSIDE = const(15)
_PALETTE = const(16)
_Y = const(24)
_FRESH = const(25)
_COORDINATES = const(28)
_FIRST_FAULT = const(31)  # number of its text
_LINE_US = const(32)  # what a command takes on the line
_PATIENCE_US = const(33)  # likewise, until a screen that does not answer is told the next all the same, and one that never does
_SENT_US = const(35)  # when the last command was sent
_BEGAN_US = const(36)  # when the picture was
_ANSWERED = const(37)
_MUTE = const(38)  # commands without an answer
_LINE = const(39)  # of text that is next
_FILLED = const(40)  # where the command ends that holds boxes already, 0 if none does
_SHOWN = const(41)  # check of each line that the screen shows, + 1; 0 for none

# Texts, see screen_build.py
_BOX = const(0)
_TEXT = const(1)
_BUTTONS = const(2)
_STATES = const(3)
_STEERING = const(6)
_HEALTH = const(7)
_START = const(8)
_REASONS = const(10)


def _listen(self, said, now_us, robot, link):
    """Take note of what the screen said, see hear()."""
    work = self.work
    if said & _OK:
        if work[_MUTE] == _SILENT:
            said |= _RESTARTED
        work[_ANSWERED] = 1
        work[_MUTE] = 0
    if said & _RESTARTED:  # it shows nothing of what it was told
        self.queue.clear()
        self.leave(True)
        work[_Y] = _ROWS
        work[_FILLED] = 0
        for k in range(_CELLS):
            self._cells[k] = 0
    said &= 63
    if said and (said % 3 == 0 or self.page):
        link.stop()
        if not robot.drive.v256:
            link.rare(now_us, robot, "link.screen_menu").touch(self, said, robot, link)
    elif said == 1 or said == 4:
        link.stop()
    elif said:
        link.drive_itself()


@micropython.viper
def _update(self, now_us, robot, link):
    """Send the next command if it is time, hear the buttons. robot: as for the link.

    All in one function: its own names and frame for each part would take a hundred bytes of the heap.
    """
    work = ptr32(self.work)
    at = 0
    line = 0
    count = self._uart.readinto(self._input)
    if count:
        _listen(self, hear(self._cells, 0, 0, self.work, self._input, count), now_us, robot, link)
    passed = int(ticks_diff(now_us, self.work[_SENT_US]))
    patience = _LINE_US
    if not work[_ANSWERED]:
        patience = _PATIENCE_US + 1 if work[_MUTE] == _SILENT else _PATIENCE_US
    if passed >= 0 and passed < work[patience]:
        return
    if not work[_ANSWERED] and work[_MUTE] < _SILENT:
        work[_MUTE] += 1
    if self.page and link.state:
        self.leave()
    avoid = robot.avoid
    if work[_FILLED]:
        pass
    elif self.queue:
        told = self.queue.pop(0)
        at = int(emit(self._command, 0, told[0], told[1], told[2], self.work))
    else:
        line = work[_LINE]
        work[_LINE] = (line + 1) % _LINES
        if line == 0 or not self.page:
            # A line of text, if it is another than the screen shows.
            fault = int(robot.safety.fault)
            number = _STEERING
            colour = 6
            work[_NUMBERS] = _BIAS + int(avoid.mode)
            work[_NUMBERS + 1] = _BIAS + int(avoid.free)
            if line == 0:
                number = int(link.state)
                colour = 2 - number if number < 2 else 4  # as red, green and yellow windows
                number += _STATES
            elif line == 1:
                work[_NUMBERS] = _BIAS + int(avoid.af)
                work[_NUMBERS + 1] = _BIAS + int(avoid.ar)
                work[_NUMBERS + 2] = _BIAS + int(avoid.v)
            elif line == 2:
                number = _REASONS + int(avoid.why)
            elif fault:
                number = work[_FIRST_FAULT] + fault
                colour = 2
            else:
                number = _HEALTH
                work[_NUMBERS] = _BIAS + int(robot.health.battery_mv) // 100
                work[_NUMBERS + 1] = _BIAS + int(robot.lidar.speed20) * 3
            work[0] = 4
            work[1] = _TOP + _HIGH * line
            work[3] = work[1] + _HIGH - 1
            work[6] = work[_PALETTE + colour]
            work[_INSIDE] = number
            at = int(emit(self._command, 0, self.texts, self.ends, _TEXT, self.work))
            number = int(crc16(self._command, 0, at)) + 1
            if number == work[_SHOWN + line]:
                at = 0
            else:
                work[_SHOWN + line] = number
    if at == 0:
        # The picture goes on: boxes gather in the command until it is full or the picture is done.
        if work[_Y] == _ROWS:
            passed = int(ticks_diff(now_us, self.work[_BEGAN_US]))
            if passed >= 0 and passed < _PICTURE_US:
                return
            work[_Y] = 0
            work[_BEGAN_US] = int(now_us)
            aim = robot.drive.aim
            way(self._cells, self.work, aim.vx, aim.vy, aim.w, aim.span, avoid.v)
        at = work[_FILLED]
        left = _A_TURN
        work[_FRESH] = 1
        while at < _LAST and left and work[_Y] < _ROWS and int(avoid.points_count) >= 0 and avoid.points_ordered:
            left -= 1
            if int(box(self._cells, 0, 0, self.work, avoid.points_x, avoid.points_y, avoid.points_window, avoid.points_count)):
                at = int(emit(self._command, at, self.texts, self.ends, _BOX, self.work))
        work[_FILLED] = at
        if at == 0 or at < _LAST and work[_Y] < _ROWS:
            return
        work[_FILLED] = 0
    work[0] = at
    emit(self._command, _SIZE, self.texts, self.ends, -1, self.work)
    self._uart.write(self._command)
    work[_SENT_US] = int(now_us)
    work[_ANSWERED] = work[_COORDINATES]  # a Nextion is told not to answer


class Screen:
    """Shows the robot on a screen and hears its buttons.

    uart: UART with a txbuf of at least 256 bytes; kind, baud: screen.kind and screen.baud of robot.json; config: Config.
    page: 0, or the number of what is being set, of screen_menu.py, plus 1. queue: commands to be sent before all else, as (texts, ends, number).
    texts, ends, work: see screen_kernels.py.
    """

    def __init__(self, uart, kind, baud, config):
        from link.screen_build import build

        build(self, uart, kind, baud, config, _SIZE)

    update = _update

    def leave(self, anew=False):
        """Show the three buttons and all lines; `anew` on a screen that knows nothing yet."""
        self.page = 0
        for number in (_START, _START + 1, _BUTTONS) if anew else (_BUTTONS,):
            self.queue.append((self.texts, self.ends, number))
        for line in range(_LINES):
            self.work[_SHOWN + line] = 0
