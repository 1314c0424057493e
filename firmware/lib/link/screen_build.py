"""The fields of a Screen, and the texts of reasons and faults as it shows them; needed once, when it is made.

Three families: screen_usart_gpu.py, screen_uart_lcd.py, screen_nextion.py, of which only the one that robot.json names is loaded. All are held upright,
240 x 320. Source: the vendors' command lists; they disagree from unit to unit, so the dialect must be tried.
"""

import sys
from array import array

from micropython import const

from core.unload import forget

_COLUMNS = const(48)  # as in screen_kernels.py
_SHAPE = const(912)
_CELLS = const(954)
_AHEAD = const(21)
_FIRST_FORMS = const(10)  # texts before those of the reasons

# The states with mode and free way, the steering, battery and lidar. What the low bytes stand for: screen_kernels.emit
_FORMS = (
    b"STOP  mode \x10  free \x11 mm\nAUTO  mode \x10  free \x11 mm\nHAND  mode \x10  free \x11 mm\nAF \x18  AR \x19  V \x12\nbattery \x18 V  lidar \x11 rpm\n"
)

# A line each, by the numbers of planner/reasons.py and safety/faults.py, as short as a line of the screen; reason_texts.py has them in full
REASONS = b"""waiting for lidar
way is free
through the gap
off an obstacle
moving sideways
second move
two moves
backing out
backing to line up


closed in
stopped
fault
by hand

another way
new in the way
press START
awaits a goal
at its goal
! goal closed off
lost on its map
"""
FAULTS = b"""
! stop button
! lidar silent
! PWM chip silent
! battery empty
! well again
! too slow
! out of memory
! chip lost 3 times
! part failed
! program hung
! wheel limits
! scan not sound
! nothing moves
! turns wrongly
! slow, or slips
"""


def build(self, uart, kind, baud, config, size):
    """Fields of a Screen."""
    name = "link.screen_" + kind.replace("-", "_")
    __import__(name)
    dialect = sys.modules[name]
    self.texts = texts = b"".join((dialect.DRAWING, _FORMS, dialect.START, REASONS, FAULTS))
    self.ends = ends = array("H", bytes(2 * texts.count(b"\n")))
    end = 0
    for k in range(len(ends)):
        end = texts.find(b"\n", end) + 1
        ends[k] = end
    first_fault = _FIRST_FORMS + REASONS.count(b"\n")
    nextion = kind == "nextion"
    line_us = size * 10_000_000 // baud * (3 if nextion else 2) // 2  # what a Nextion needs to draw is not told by an answer
    fills = (0xFF, 0xFF) if nextion else (0x0D, 0x0A)
    scale = max(config.robot_length // 13, 8)  # the body is 13 cells long, whatever its size
    numbers = (36, 1, scale, config.robot_length // 2, int(nextion)) + fills + (first_fault, line_us, line_us + 300_000, line_us + 50_000, 0, 0, 1)
    self.work = array("i", (0,) * 16 + dialect.COLOURS + numbers + (0,) * 7)
    dialect = None
    forget(name)
    self._uart = uart
    self._command = bytearray(size)
    self._input = bytearray(16)
    self._cells = cells = bytearray(_CELLS)
    self.queue = []
    self.leave(True)
    across = -(-config.robot_width // (2 * scale))
    along = -(-config.robot_length // (2 * scale))
    cells[_SHAPE] = max(_COLUMNS // 2 - across, 0)
    cells[_SHAPE + 1] = min(_COLUMNS // 2 + across - 1, _COLUMNS - 1)
    cells[_SHAPE + 2] = _AHEAD - along
    cells[_SHAPE + 3] = _AHEAD - 1 + along
