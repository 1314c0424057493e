"""First thing in main.py: the motors are silenced, whatever a former life left them doing, and with whatever robot.json there is. Let go after.

Needs nothing but the board. A pin or an address that robot.json does not tell, because it is damaged, is the default's. (The keys are one text,
as each text that could be a name would stay in the board's table of names for ever; hence the names of the functions, too.)
"""

import json
import os
import time

import machine
from micropython import const

PROMPT = const(1)

_LARGEST = const(16384)  # bytes of a robot.json that is worth reading
_KEYS = const("pins/output_enable i2c/scl i2c/sda motors/left motors/right pins/stop_button pins/stop_closed")
_USUAL = const((33, 22, 21, 0x41, 0x42, 32, 0))
_ALL_OFF = const(b"\xfd\x10")  # of a PCA9685: every output off
_WDT_RESET = const(3)  # of machine.reset_cause()
_SETTLE_MS = const(5)  # for the pull-up
_TRIES = const(3)  # a transfer that the reset has cut off spoils the first


def stop(path="robot.json"):
    """Motors off: by the output enable pin, and each chip by itself, where that pin is not wired. Raises nothing.

    True while the stop button is held, unless the watchdog has reset the board: who wants the prompt. One that opens when pressed does not say so, for
    its broken wire could.
    """
    values = {}
    try:
        if os.stat(path)[6] <= _LARGEST:
            with open(path) as file:
                values = json.load(file)
    except Exception:
        pass
    wiring = []
    for key, usual in zip(_KEYS.split(" "), _USUAL):
        try:
            group, _, name = key.partition("/")
            value = values[group][name]
            wiring.append(int(value, 0) if isinstance(value, str) else None if value is None else int(value))
        except Exception:
            wiring.append(usual)
    enable, scl, sda, left, right, button, closed = wiring
    try:
        if enable is not None:
            machine.Pin(enable, machine.Pin.OUT, value=1)
    except Exception:
        pass
    for address in (left, right) * _TRIES:
        try:
            machine.I2C(0, scl=machine.Pin(scl), sda=machine.Pin(sda), freq=100_000).writeto(address, _ALL_OFF)
        except Exception:
            pass
    try:
        if button is not None and not closed and machine.reset_cause() != _WDT_RESET:
            button = machine.Pin(button, machine.Pin.IN, machine.Pin.PULL_UP)
            time.sleep_ms(_SETTLE_MS)
            return not button.value()
    except Exception:
        pass
    return False


def load():
    """What the life before this one left: the bytes of watchdog.py, None after power was switched on, PROMPT if it wants no robot now but the prompt."""
    try:
        memory = machine.RTC().memory
        note = bytearray(memory())
        if len(note) != 4 or note[:2] != b"GS":
            return None
        wish = note[3]
        note[3] = 0
        memory(note)
        return PROMPT if wish else note
    except Exception:
        return None
