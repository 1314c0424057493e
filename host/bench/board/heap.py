"""The heap: by how much the steady loop makes it grow, and the buffers that lie in it."""

import gc
import sys
from array import array

import lockstep

_STEADY_US = 4000000
_WATCHED_US = 8000000  # looking takes long
_BOARD = ("machine", "lockstep", "time", "sys", "gc", "heap", "__main__")
_BOARD_CLASSES = ("UART", "I2C", "Pin", "PWM", "ADC", "WDT", "type")
_SIZES = {"b": 1, "B": 1, "h": 2, "H": 2, "i": 4, "I": 4, "l": 4, "L": 4, "q": 8, "Q": 8, "f": 4, "d": 8}


def buffers():
    """Bytes on the ESP32 of all arrays and bytearrays reachable from the robot and the firmware's modules, each once."""
    seen = set()
    total = 0
    todo = [module for name, module in sys.modules.items() if name not in _BOARD]
    while todo:
        thing = todo.pop()
        if id(thing) in seen:
            continue
        seen.add(id(thing))
        if isinstance(thing, bytearray):
            total += len(thing)
        elif isinstance(thing, array):
            total += len(thing) * _SIZES[repr(thing[:0])[7]]
        elif isinstance(thing, (list, tuple)):
            todo.extend(thing)
        elif isinstance(thing, dict):
            todo.extend(thing.values())
        elif hasattr(thing, "__dict__") and type(thing).__name__ not in _BOARD_CLASSES:
            todo.extend(thing.__dict__.values())
    return total


def watch(path):
    """The most that the heap grew from one sleep of the steady loop to the next, written into the file at the end.

    Looked at while the loop sleeps: at other times the interpreter has the frames of the larger functions on the heap, and takes them back.
    """
    import time

    sleep_ms = time.sleep_ms
    state = array("l", (0, 0, 0, 0))  # heap at the last sleep, worst growth, growth in all, sleeps

    def watched_sleep_ms(duration):
        sleep_ms(duration)
        if lockstep.now < _STEADY_US:
            return
        if state[0] == 0:
            gc.collect()
            gc.disable()
            state[0] = gc.mem_alloc()
            return
        grown = gc.mem_alloc() - state[0]
        if grown > 0:
            state[2] += grown
            if grown > state[1]:
                state[1] = grown
        state[0] += grown
        state[3] += 1
        if lockstep.now > _STEADY_US + _WATCHED_US:
            lockstep.on_end()

    def end():
        lockstep.on_end = lambda: None  # the firmware switches off yet
        with open(path, "w") as file:
            file.write('{"worst": %d, "all": %d, "sleeps": %d, "buffers": %d}\n' % (state[1], state[2], state[3], buffers()))
        sys.exit(0)

    time.sleep_ms = watched_sleep_ms
    lockstep.on_end = end
