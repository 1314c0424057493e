"""The three times that decide whether the firmware keeps pace with its lidar, for one run with everything on: `host.budget` shows them."""

import numpy as np

from host.twin import Observer, image, run
from planner import reasons

from . import calibrate, costs, scans
from .measure import Bench

COURSE: dict = {"course": "Z", "width": 550, "seed": 3, "limit_s": 12, "changes": {"screen.kind": "nextion"}}
_STEP, _LINK, _SCREEN = "robot:Robot.step", "link.link:Link.update", "link.screen:Screen.update"
_COMMAND = 192  # bytes of a screen's command
_LIMIT_S = 20
_DUTY = 0.6  # of the lidar's motor: about its speed


def times(firmware=image.FIRMWARE):
    """{"start_ms_esp32", "turn_worst_ms_esp32", "link_worst_ms_esp32", "screen_worst_ms_esp32"}, ms at 240 MHz, modelled, and "screen_bytes_s"; None where nothing was measured.

    start: from main.py's first line to the first decision, while the lidar turns, on the twin that charges for computing. turn, link: executed
    instructions and the time on the I2C bus, in a loop that drives the Z, writes a screen and sends candidates and raw scans. BenchError.
    """
    (tape, *_) = scans.tapes((COURSE,), firmware, 1, twin=False)
    named, calls = calibrate.names(), Bench(firmware).calibrate(tape, calibrate.watched())
    turns, link = worst(named, calls)
    update, line = screen(named, calls)
    return {
        "start_ms_esp32": start(firmware),
        "turn_worst_ms_esp32": turns,
        "link_worst_ms_esp32": link,
        "screen_worst_ms_esp32": update,
        "screen_bytes_s": None if line is None else round(line / COURSE["limit_s"]),
    }


def start(firmware=image.FIRMWARE):
    """ms from main.py's first line to the first decision on the twin, None if there is none in 20 s."""
    observer = _Turning()
    run("Z", width=550, watch=observer, firmware=firmware, limit_s=_LIMIT_S, record=False, chip=1.0)
    return None if observer.first_us is None else round(observer.first_us / 1000)


def worst(named, calls):
    """(worst turn of the loop, worst link.update), ms, of the calls of one tape (rows of board/meter.py, in their order)."""
    step, link = (named.index(name) for name in (_STEP, _LINK))
    ends = (calls[:, 0] == step).nonzero()[0]
    turn = told = 0.0
    begin = 0
    for end in ends.tolist():
        rows = calls[begin : end + 1]
        if begin:  # what comes before the first turn is the start
            turn = max(turn, _ms(rows))
            if (said := rows[rows[:, 4] == link]).size:
                told = max(told, costs.us(int(said[:, 1].sum())) / 1000)
        begin = end + 1
    return (round(turn, 3), round(told, 3)) if len(ends) > 1 else (None, None)


def screen(named, calls):
    """(worst screen.update, ms, with all that it calls; bytes given to its line) of the calls of one tape, None both where there is no screen."""
    if _SCREEN not in named:
        return None, None
    update = named.index(_SCREEN)
    rows = calls[calls[:, 4] == update]
    ends = (rows[:, 0] == update).nonzero()[0]
    if not len(ends):
        return None, None
    parts = np.split(rows[:, 1], ends[:-1] + 1)
    return round(max(costs.us(int(part.sum())) for part in parts) / 1000, 3), _COMMAND * int(rows[ends, 2].sum())


def _ms(rows):
    """Computing, and the bus on which the processor waits."""
    return (costs.us(int(rows[:, 1].sum())) + int(rows[-1, 5])) / 1000


class _Turning(Observer):
    """Has the lidar turn before the firmware starts, and notes when the first decision is made."""

    def __init__(self):
        self.first_us = None
        self._turns = False

    def step(self, simulation):
        if not self._turns:
            self._turns = True
            simulation.lidar.spin(simulation.now, _DUTY)

    def decision(self, decision):
        if self.first_us is None and decision.why not in (reasons.WAITING, reasons.FAULT, reasons.STOPPED):
            self.first_us = decision.time_us
