"""Makes a part of the firmware fail, from outside it. Loaded only where the twin has left a fault.json; `host.twin.faults` says what there is.

A method of the part is replaced when its module is imported. It does what it always did until the twin sets the level of a pin that no ESP32 has;
from then on it fails. Nothing here allocates before that, so that it may run with the heap locked.
"""

import builtins
import gc
import sys

import charge
import lockstep
import machine
from micropython import const

gc = getattr(gc, "_gc", gc)  # the real one: what is eaten here takes no time

_BEGUN = const(63)
_BUS_STUCK = const(62)
_STEP_US = const(1000)
_LEFT = const(1024)  # bytes of heap that are left
_MEALS = const(3)
_WAITING = const(6)  # datagrams that the network stack keeps for a socket
_RECEIVE_US = const(300)  # to take a datagram in, on the ESP32
_VERIFY_US = const(3000)  # to check the tag of one
_TIMED_OUT = const(116)
_PER_BYTE_US = const(100_000)  # the port's driver waits so long for each byte and for the address

# module, class, method and its number of arguments
_PARTS = {
    "lidar": ("lidar", "Lidar", "poll", 1),
    "avoid": ("avoid", "Avoid", "step", 1),
    "drive": ("actuation.drive", "Drive", "update", 1),
    "stop": ("actuation.drive", "Drive", "stop", 0),
    "health": ("safety.health", "Health", "check", 1),
    "link": ("link.link", "Link", "update", 2),
    "telemetry": ("link.telemetry", "Encoder", "seal", 1),
    "screen": ("link.screen", "Screen", "update", 3),
}

_import = charge.hook or builtins.__import__
_todo = []  # [(module, class, what replaces its methods)]
_eaten, _times = [None], []


def load(what):
    """Be ready to fail. what: the dict of fault.json: `kind`, and what else that kind wants."""
    kind = what["kind"]
    if kind == "bus":
        _original = machine.I2C.transfer

        def transfer(self, address, count):
            if lockstep.level(_BUS_STUCK):
                lockstep.flush()  # what pins did a moment ago may have freed it
            if lockstep.level(_BUS_STUCK):
                lockstep.advance(_PER_BYTE_US * (1 + count))
                raise OSError(_TIMED_OUT)
            _original(self, address, count)

        machine.I2C.transfer = transfer
        return
    if kind == "flood":
        _flood(1_000_000 // what["rate"], bytes(what["datagram"]), *((_RECEIVE_US, _VERIFY_US) if what.get("timed", True) else (0, 0)))
    else:
        for part in (what["part"], what.get("also")):
            if part:
                module, owner, method, count = _PARTS[part]
                _later(module, owner, method, count, _failing(kind, part, what))
    builtins.__import__ = _importing


def _failing(kind, part, what):
    """The function that the part calls first, once the fault has begun."""

    def hang():
        while True:
            lockstep.advance(_STEP_US)

    def compute():
        lockstep.flush()
        while True:
            pass

    def fail():
        raise RuntimeError("injected into " + part)

    def no_memory():
        raise MemoryError("injected into " + part)

    def slow():
        lockstep.advance(what["us"])

    def eat():
        if len(_times) < _MEALS:  # what the first leaves as garbage the second gets
            _times.append(None)
            gc.collect()
            size = 4096
            while gc.mem_free() > _LEFT and size >= 16:
                try:
                    _eaten[0] = bytearray(min(size, gc.mem_free() - _LEFT)), _eaten[0]  # a list would need ever larger pieces
                except (MemoryError, ValueError):
                    size >>= 1

    return {"hang": hang, "compute": compute, "exception": fail, "memory": no_memory, "slow": slow, "heap": eat}[kind]


def _later(module, owner, method, count, first):
    """When the module is imported, let `first` run before the method whenever the fault is there."""

    def make(original):
        def none(self):
            if lockstep.level(_BEGUN):
                first()
            return original(self)

        def one(self, a):
            if lockstep.level(_BEGUN):
                first()
            return original(self, a)

        def two(self, a, b):
            if lockstep.level(_BEGUN):
                first()
            return original(self, a, b)

        def three(self, a, b, c):
            if lockstep.level(_BEGUN):
                first()
            return original(self, a, b, c)

        return (none, one, two, three)[count]

    _todo.append((module, owner, method, make))


def _importing(name, space=None, local=None, wanted=None, level=0):
    out = _import(name, space, local, wanted, level)
    for entry in _todo:
        module = sys.modules.get(entry[0])
        owner = getattr(module, entry[1], None)
        if owner is not None:
            setattr(owner, entry[2], entry[3](getattr(owner, entry[2])))
            _todo.remove(entry)
            break
    return out


def _flood(period_us, datagram, receive_us, verify_us):
    """Datagrams arrive at that pace; taking one in, and checking its tag, takes so long."""
    import socket

    sender = ("192.168.1.66", 9751)
    state = [0, 0]  # whether it has begun, and when the latest came

    def arrive():
        if not lockstep.level(_BEGUN):
            return
        if not state[0]:
            state[0], state[1] = 1, lockstep.now
        while lockstep.since(lockstep.now, state[1]) >= period_us:
            state[1] = lockstep.later(state[1], period_us)
            if len(socket.inbox) < _WAITING:
                socket.inbox.append((datagram, sender))

    ask = socket.socket.ioctl
    receive = socket.socket.recvfrom

    def ioctl(self, request, argument):
        arrive()
        return ask(self, request, argument)

    def recvfrom(self, count):
        arrive()
        if receive_us:
            lockstep.advance(receive_us)
        return receive(self, count)

    socket.socket.ioctl, socket.socket.recvfrom = ioctl, recvfrom

    def verify():
        if verify_us:
            lockstep.advance(verify_us)

    _later("link.auth", "Signer", "signed", 3, verify)
