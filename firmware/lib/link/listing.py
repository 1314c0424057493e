"""Tells the parameters, for the command LIST. Loaded when it comes, let go after."""

import json

from micropython import const

from core.unload import forget
from link import messages
from params.next_start import NEXT_START

forget("params.next_start")  # what has been taken from it stays

_PARAMETER = const(0x07)


def parameter(data, config, number):
    """PARAMETER number `number` into the encoder's data: those of config.live, then the servos' trims. Returns (length, how many there are)."""
    live = len(config.live)
    total = live + 2 * config.axles
    if number < live:
        name = config.live[number]
        key = name.replace("_", ".", 1)
        low, high = config.limits[2 * number], config.limits[2 * number + 1]
        value = getattr(config, name)
    else:
        wheel = number - live
        key, low, high = "servos.trims.%d" % wheel, -20, 20
        value = config.servos_trims[wheel] / 10
    row = {"key": key, "value": value, "low": low, "high": high, "number": number, "of": total, "restart": key in NEXT_START}
    return messages.text(_PARAMETER, data, 0, json.dumps(row).encode()), total
