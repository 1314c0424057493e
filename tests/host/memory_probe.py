"""Put on the simulated board beside the firmware: what is in the heap once the robot has been built."""

import sys
from array import array

_SIZES = {"b": 1, "B": 1, "h": 2, "H": 2, "i": 4, "I": 4, "l": 8}


def _arrays(thing, seen, depth=0):
    """Bytes of all arrays and buffers that the thing leads to, the emulated board's not counted."""
    kind = type(thing)
    if thing is None or kind in (int, str, bytes, bool, float, type) or depth > 8 or id(thing) in seen:
        return 0
    seen[id(thing)] = True
    if kind is array:
        return len(thing) * _SIZES[repr(thing)[7]]
    if kind is bytearray:
        return len(thing)
    if kind in (list, tuple):
        inside = thing
    elif kind is dict:
        inside = thing.values()
    else:
        attributes = getattr(thing, "__dict__", {})
        inside = [attributes[name] for name in attributes if name not in ("sys", "machine", "lockstep", "time", "_uart")]
    return sum([_arrays(one, seen, depth + 1) for one in inside])


def report():
    """Print the bytes in the firmware's arrays."""
    seen = {}
    total = 0
    for name in list(sys.modules):
        if name not in ("sys", "lockstep", "machine", "time", "bootstrap"):
            total += _arrays(sys.modules[name], seen)
    print("arrays", total)
