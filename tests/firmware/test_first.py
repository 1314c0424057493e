"""first.py and remember.py: what is done before anything else, and what outlives the power."""

import json
import os
import sys

sys.modules["machine"] = sys  # what it imports; the tests put their own in its place
from safety import first  # noqa: E402

del sys.modules["machine"]
from safety.remember import Remember, stopped  # noqa: E402

_FILE = "first.json"


class Machine:
    """A board on which all that is asked for is noted."""

    class Pin:
        IN, OUT, PULL_UP = 1, 3, 2
        level = 1

        def __init__(self, gpio, mode=None, pull=None, value=None):
            self.gpio = gpio
            if gpio in Machine.broken:
                raise ValueError
            if mode is not None:
                Machine.pins[gpio] = (mode, pull, value)

        def value(self):
            return Machine.Pin.level

    class I2C:
        def __init__(self, number, scl, sda, freq):
            self.wires = scl.gpio, sda.gpio

        def writeto(self, address, data):
            Machine.sent.append((self.wires, address, bytes(data)))
            if Machine.fails:
                raise OSError(19)

    class RTC:
        kept = b""

        def memory(self, data=None):
            if data is None:
                return Machine.RTC.kept
            Machine.RTC.kept = bytes(data)

    def reset_cause():
        return Machine.cause

    pins, sent = {}, []
    broken = ()
    fails = False
    cause = 1


def stop(text=None, level=1, cause=1, broken=(), fails=False):
    """(whether the button is held, pins that were set, what the chips heard) with that in robot.json; None: none is there."""
    Machine.pins, Machine.sent = {}, []
    Machine.Pin.level, Machine.cause, Machine.broken, Machine.fails = level, cause, broken, fails
    try:
        os.remove(_FILE)
    except OSError:
        pass
    if text is not None:
        with open(_FILE, "w") as file:
            file.write(text)
    first.machine, kept = Machine, first.machine
    try:
        held = first.stop(_FILE)
    finally:
        first.machine = kept
        if text is not None:
            os.remove(_FILE)
    return held, Machine.pins, Machine.sent


USUAL = [((22, 21), address, b"\xfd\x10") for address in (0x41, 0x42)] * 3


def test_whatever_is_in_robot_json_the_motors_are_silenced():
    for text in (
        None,
        "",
        "null",
        "{}",
        "[1, 2]",
        '{"pins": 5, "i2c": null, "motors": []}',
        '{"motors": {"left": "nonsense", "right": {}}}',
        "{" * 50,
        " " * 16385,
    ):
        held, pins, sent = stop(text)
        assert not held and pins[33] == (Machine.Pin.OUT, None, 1) and sent == USUAL, text


def test_the_wiring_of_robot_json_is_taken():
    wiring = {"pins": {"output_enable": 4, "stop_button": 13}, "i2c": {"scl": 18, "sda": 19}, "motors": {"left": "0x43", "right": 70}}
    held, pins, sent = stop(json.dumps(wiring))
    assert pins[4] == (Machine.Pin.OUT, None, 1) and 33 not in pins and pins[13] == (Machine.Pin.IN, Machine.Pin.PULL_UP, None)
    assert sent == [((18, 19), address, b"\xfd\x10") for address in (0x43, 70)] * 3
    held, pins, sent = stop('{"pins": {"output_enable": null, "stop_button": null}}', level=0)
    assert not held and pins == {} and sent == USUAL
    assert stop(" " * 16000 + '{"pins": {"output_enable": 4}}')[1][4]


def test_a_chip_or_a_pin_that_fails_keeps_nothing_else_from_being_done():
    held, pins, sent = stop(fails=True, level=0)
    assert held and sent == USUAL and 33 in pins
    assert stop(broken=(33,), level=0)[0] and Machine.sent == USUAL
    assert not stop(broken=(32,), level=0)[0] and Machine.sent == USUAL
    assert stop(broken=(22,), level=0)[0] and Machine.sent == []


def test_a_held_stop_button_asks_for_the_prompt():
    assert stop(level=0)[0] and stop(level=0, cause=2)[0] and not stop(level=1)[0]
    assert not stop(level=0, cause=3)[0]  # after the watchdog somebody may hold it in fright
    assert not stop('{"pins": {"stop_closed": true}}', level=0)[0] and not stop('{"pins": {"stop_closed": true}}', level=1)[0]


def load(kept):
    Machine.RTC.kept = kept
    first.machine, before = Machine, first.machine
    try:
        return first.load()
    finally:
        first.machine = before


def test_what_the_life_before_left():
    assert load(b"") is None and load(b"GS\0") is None and load(b"XX\0\0") is None and load(b"GS\0\0\0") is None
    assert load(b"GS\x02\x00") == b"GS\x02\x00"
    assert load(b"GS\x02\x01") == first.PROMPT and Machine.RTC.kept == b"GS\x02\x00"  # once
    first.machine, before = None, first.machine
    try:
        assert first.load() is None
    finally:
        first.machine = before


def _there():
    try:
        os.stat("stopped")
        return True
    except OSError:
        return False


def test_a_stop_is_kept_until_a_start_and_written_once():
    if _there():
        os.remove("stopped")
    remember = Remember()
    for state, there in ((1, False), (0, True), (0, True), (2, False), (1, False), (0, True)):
        remember(state)
        assert _there() == there == stopped()
    os.remove("stopped")
    remember(0)
    assert not _there()  # nothing is written again and again
    remember(1)  # and nothing to remove harms nobody
    open("stopped", "w").close()
    remember = Remember()
    remember(1)
    assert not _there()
