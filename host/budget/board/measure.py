"""Runs main.py with the stub devices and writes down what it takes of the memory, line by line, into the file `told`.

    micropython measure.py WHAT TURNS BARE LEAVE

WHAT    trace     the start: "code MODULE" as a module's file is about to be loaded, "heap MODULE live" after it, "uart", "radio"
        rooms     what each module takes: "import MODULE depth bytes names", then "array MODULE bytes"
        end       nothing but the end
In each case "live BYTES" after TURNS turns of the loop that sleep, or "failed EVENTS": no memory after so many events. BARE: bytes of the heap that
count though they were there before, as they are on the board: what the interpreter itself has in it. LEAVE: if not 0, all of the heap but so many bytes is taken away once the loop runs.
"""

import gc
import sys

_WHAT = sys.argv[1]
_TURNS = int(sys.argv[2])
_BARE = int(sys.argv[3])
_LEAVE = int(sys.argv[4])
sys.path[:] = ["", "board", "lib"]

import builtins
import os

import clock
import machine

for _name in ("network", "socket"):
    try:
        sys.modules.pop(_name, None)
        __import__(_name)
    except ImportError:
        pass


class _Os:
    """The module os, but for its random bytes, which are zeros: the signed datagrams were made for them."""


for _name in dir(os):
    setattr(_Os, _name, getattr(os, _name))
_Os.urandom = lambda count: bytes(count)
sys.modules["os"] = _Os
_datagrams = open("datagrams.bin", "rb")
_told = open("told", "w")
_import = builtins.__import__
_SETTLED = 350  # turns after which the loop has what it keeps
_BLOCK = 256
_LISTENS = 1000  # turns from one greeting over WiFi to the next
_events = 0
_turns = 0
_depth = 0


def tell(*words):
    """Write an event down."""
    global _events
    _events += 1
    if _WHAT == "trace":
        gc.collect()
        print(_events, *words, gc.mem_alloc() - _stubs, file=_told)


def _hooked_import(name, globals=None, locals=None, names=(), level=0):
    global _depth
    if name in sys.modules or name in ("gc", "sys", "micropython", "select", "struct", "json", "math", "os"):
        return _import(name, globals, locals, names, level)
    tell("code", name)
    if _WHAT != "rooms":
        module = _import(name, globals, locals, names, level)
        tell("heap", name)
        return module
    import micropython

    gc.collect()
    before = gc.mem_alloc()
    _depth += 1
    print("before", name)
    micropython.qstr_info()
    module = _import(name, globals, locals, names, level)
    gc.collect()
    print("after", name, _depth, gc.mem_alloc() - before)
    micropython.qstr_info()
    _depth -= 1
    return module


_SIZES = {"b": 1, "B": 1, "h": 2, "H": 2}


def _walk(thing, owner, seen, sums):
    """Add the bytes of all arrays that a thing leads to, to the module of the object that holds them."""
    kind = type(thing)
    if thing is None or kind in (int, str, bool, float, type) or id(thing) in seen:
        return
    seen.add(id(thing))
    name = kind.__name__
    if name == "array":
        sums[owner] = sums.get(owner, 0) + 32 + len(thing) * _SIZES.get(repr(thing)[7], 4)
    elif name in ("bytearray", "bytes"):
        sums[owner] = sums.get(owner, 0) + 16 + len(thing)
    elif name in ("list", "tuple", "set"):
        for one in thing:
            _walk(one, owner, seen, sums)
    elif name == "dict":
        for one in thing.values():
            _walk(one, owner, seen, sums)
    elif hasattr(thing, "__dict__"):
        inner = owner if name == "module" else getattr(kind, "__module__", owner)
        attributes = thing.__dict__
        for one in list(attributes):
            _walk(attributes[one], inner, seen, sums)


def _arrays():
    seen, sums = set(), {}
    for name in ("machine", "clock", "network", "socket", "time", "sys", "gc", "__main__", "main"):
        if name in sys.modules:
            seen.add(id(sys.modules[name]))
    _walk(sys.modules["main"].robot, "main", seen, sums)
    for name in list(sys.modules):
        _walk(sys.modules[name], name, seen, sums)
    for owner in sums:
        print("array", owner, sums[owner])
    print("loaded", *list(sys.modules))


_held = []


def _take_all_but(count):
    """Fill the heap, so that this is all that is left for what comes and goes."""
    gc.collect()
    blocks = (gc.mem_free() - count) // _BLOCK
    _held.extend([None] * blocks)  # its own size counts as well: what it took is given back below
    gc.collect()
    blocks = (gc.mem_free() - count) // _BLOCK
    for k in range(blocks):
        _held[k] = bytes(_BLOCK - 17)  # with its head and its last zero that is a block


def _send():
    """Put the next datagram where the firmware's socket finds it; over USB nobody takes them, and they must not count."""
    inbox = sys.modules["socket"].inbox
    inbox.clear()
    head = _datagrams.read(2)
    if head:
        inbox.append((_datagrams.read(head[0] | head[1] << 8), ("192.168.1.20", 9751)))


def _turn():
    global _turns
    _turns += 1
    if _turns == _SETTLED and _LEAVE:
        _take_all_but(_LEAVE)
    if _turns % _LISTENS == 100 and "socket" in sys.modules:
        _send()
    if _turns == _TURNS:
        if "socket" in sys.modules:
            sys.modules["socket"].inbox.clear()
        tell("loop")
        if _WHAT == "rooms":
            builtins.__import__ = _import
            gc.collect()
            print("\nlive", gc.mem_alloc() - _stubs)
            _arrays()
        else:
            gc.collect()
            print("live", gc.mem_alloc() - _stubs, file=_told)
        raise SystemExit


machine.tell = tell
if "network" in sys.modules:
    sys.modules["network"].tell = tell
clock.on_turn = _turn
builtins.__import__ = _hooked_import
gc.collect()
_stubs = gc.mem_alloc() - _BARE
try:
    import main  # noqa: F401
except MemoryError:
    gc.collect()
    print("failed", _events, file=_told)
finally:
    print("stubs", _stubs, file=_told)
    _told.close()
