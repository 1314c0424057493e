"""First thing in main.py: the motors are silenced, whatever a former life left them doing, and with whatever robot.json there is. Let go after.

Needs nothing but the board. A pin or an address that robot.json does not tell, because it is damaged, is the default's.
"""

import json
import os

import machine
from micropython import const

PROMPT = const(1)

_LARGEST = const(16384)  # bytes of a robot.json that is worth reading

_OUTPUT_ENABLE = const(33)
_SCL = const(22)
_SDA = const(21)
_LEFT = const(0x41)
_RIGHT = const(0x42)
_ALL_OFF = const(b"\xfd\x10")  # of a PCA9685: every output off
_TRIES = const(3)  # a transfer that the reset has cut off spoils the first


def silence(path="robot.json"):
    """Motors off: by the output enable pin, and each chip by itself, where that pin is not wired. Raises nothing."""
    try:
        pins, i2c, motors = _wiring(path)
    except Exception:
        pins = i2c = motors = {}
    try:
        gpio = pins.get("output_enable", _OUTPUT_ENABLE)
        if gpio is not None:
            machine.Pin(gpio, machine.Pin.OUT, value=1)
    except Exception:
        pass
    try:
        bus = machine.I2C(0, scl=machine.Pin(i2c.get("scl", _SCL)), sda=machine.Pin(i2c.get("sda", _SDA)), freq=100_000)
    except Exception:
        return
    for address in (_address(motors.get("left"), _LEFT), _address(motors.get("right"), _RIGHT)):
        for _ in range(_TRIES):
            try:
                bus.writeto(address, _ALL_OFF)
                break
            except Exception:
                pass


def former():
    """What the life before this one left: the bytes of watchdog.py, None after power was switched on, PROMPT if it wants no robot now but the prompt."""
    try:
        memory = machine.RTC().memory
        note = bytearray(memory())
        if len(note) != 5 or note[:2] != b"GS":
            return None
        wish = note[3]
        note[3] = 0
        memory(note)
        return PROMPT if wish else note
    except Exception:
        return None


def _wiring(path):
    if os.stat(path)[6] > _LARGEST:
        return {}, {}, {}
    with open(path) as file:
        values = json.load(file)
    return [group if isinstance(group, dict) else {} for group in [values.get(name) for name in ("pins", "i2c", "motors")]]


def _address(value, usual):
    try:
        return int(value, 0) if isinstance(value, str) else int(value)
    except (ValueError, TypeError):
        return usual
