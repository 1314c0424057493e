"""Charges what computing takes on the ESP32 to the simulated board's clock, from outside the firmware.

Public methods of the firmware's classes are replaced, when their module is imported, by the functions below. Each calls the method and adds its
price: instructions for the call, for each of two counts of work (points, candidates, bytes), all whole numbers, so that every interpreter
charges the same. What a method calls of another one in this list is that other's. Importing a module costs by the bytes of its .mpy, reading a
file by its bytes; a collection of garbage has one price. The prices are in prices.py, which the bench fits to executed instructions and checks.

What has gathered passes on the clock as soon as the firmware asks for the time or touches the board: `settle()`, called by time.py and machine.py.

The functions take what the methods take, position by position, and allocate nothing. Whoever renames such a method renames it here. They have no
names of their own, because a name takes room in the heap, which the board's own modules do not.
"""

import builtins
import os
import sys

import lockstep
import prices
from micropython import const

# What the board counts by itself.
taken_in = 0  # bytes that UARTs have handed to the firmware
given_out = 0  # bytes that it has given to UARTs

pending = 0  # instructions not yet on the clock
_per_us = 0  # instructions in a microsecond; 0 = computing takes no time
_percent = 0
_cpi = const(2)  # cycles an instruction: viper 1.3-2, the bytecode interpreter 2-2.5

_LONG_US = const(100_000_000)
_FIFO = const(128)  # bytes of the USB serial line
_TICK_US = const(10_000)  # a write that meets a full one sleeps to the next tick of the system
_fifo = 0  # bytes in it
_fifo_us = 0  # at this time

_originals = []
_wrapped = {}  # module: [(class or "", method, number)]
names = []  # of the methods below, by their numbers
_sizes = {}
_import = builtins.__import__
hook = None  # what stands in for it: MicroPython's module builtins goes on showing the first one
_tested = 0
_checked = 1  # points of the collision check that is prepared
_stride = 1
_idle = 0  # 1 while nothing is under way on the USB line
_read = 0  # bytes taken in from it in this turn
_boxes = 0  # looked for in this turn, for the screen
_composed = 0  # 1 when a line of it was put together
_closed = 0  # points that the cost to go being made has closed poses for
_CLOSE = const(7)  # the stage in which it does, cost_to_go.py
_SLICE = const(20)  # closed at a time


def settle():
    """What has been computed passes on the clock."""
    global pending
    if pending >= _per_us > 0:
        us = pending // _per_us
        pending -= us * _per_us
        while us > _LONG_US:
            lockstep.advance(_LONG_US)
            us -= _LONG_US
        lockstep.advance(us)


def clock(hertz):
    """The processor's clock is set, Hz."""
    global _per_us
    settle()
    if _percent:
        _per_us = max(hertz // 1_000_000 * _percent // (100 * _cpi), 1)


def add(instructions):
    """Charge some instructions."""
    global pending
    pending += instructions
    if pending > 0x10000000:
        settle()


def enter():
    """A charged method begins. Here the bench puts a function of its own, and for the three that follow."""


def resume():
    """It begins only now: what has been asked of the firmware since `enter` is nobody's."""


def done():
    """It has ended; `leave` follows when its work has been counted."""


def leave(number, a, b):
    """Charged method `number` has ended, and done so much of its two kinds of work."""
    global pending
    price = _prices[number]
    pending += price[0] + (a * price[1] + b * price[2] >> 4)


def load(path):
    """Begin, if the twin has left a file that says how fast the chip is."""
    import json

    try:
        with open(path) as file:
            chip = json.load(file)
    except OSError:
        return
    begin(chip["percent"], chip["sizes"])


def begin(percent, sizes):
    """From now on computing takes time. percent: the chip's speed, 100 = an ESP32. sizes: {module of the firmware: bytes of its .mpy on the board}."""
    global _percent, _sizes
    _percent = percent
    _sizes = sizes
    global hook
    clock(160_000_000)
    builtins.__import__ = hook = _importing


# ---- imports


def _importing(name, space=None, local=None, wanted=None, level=0):
    """`import name`, charged and with the module's methods replaced when it is one of the firmware's that has not been loaded."""
    if name == "gc":
        return _Collector
    # True: MicroPython looks for a module of a package whose table has been shrunk, see _trim in core/start.py.
    for part in () if wanted is True else wanted or ():
        if name + "." + part in _sizes:
            _importing(name + "." + part, space, local, (part,), 0)
    if name not in _sizes or name in sys.modules:
        return _import(name, space, local, wanted, level)
    module = _import(name, space, local, wanted, level)
    size = _sizes[name]
    add(prices.IMPORT + size * prices.IMPORT_BYTE)
    settle()
    if name in _wrapped:
        _replace(name, sys.modules[name])
    if name == "core.unload" and sys.implementation.name != "micropython":
        module = sys.modules[name]
        module.forget, module.unload = _forget, _unload
    return module


def _forget(*names):
    """As core.unload does on the board: under CPython it lets nothing go, and what is wanted again would cost no time."""
    for name in names:
        sys.modules.pop(name, None)
        package, _, module = name.rpartition(".")
        if package and hasattr(sys.modules.get(package), module):
            delattr(sys.modules[package], module)


def _unload(*names):
    _forget(*names)
    _collect()


def _replace(name, module):
    for place, method, number in _wrapped[name]:
        owner = getattr(module, place, None) if place else module
        original = getattr(owner, method, None)
        if original is None:
            raise AttributeError("charge.py wraps %s, which is gone" % names[number])
        _originals[number] = original
        setattr(owner, method, _functions[number])


class _Collector:
    """Stands in for the module gc."""

    import gc as _gc

    enable = _gc.enable
    disable = _gc.disable
    isenabled = _gc.isenabled
    threshold = getattr(_gc, "threshold", None)
    _collect = _gc.collect
    _mem_alloc = getattr(_gc, "mem_alloc", None)
    _mem_free = getattr(_gc, "mem_free", None)


def _collect():
    add(prices.COLLECT)
    settle()
    return _Collector._collect()


def _mem_alloc():
    add(prices.COLLECT)
    return _Collector._mem_alloc()


def _mem_free():
    add(prices.COLLECT)
    return _Collector._mem_free()


_Collector.collect = _collect
_Collector.mem_alloc = _mem_alloc
_Collector.mem_free = _mem_free


# ---- the firmware's methods

_functions = []
_prices = []


def _wraps(number, name):
    """The function that follows stands for a method: "module:Class.method" or "module:function"."""
    module, _, path = name.partition(":")
    place, _, method = path.rpartition(".")
    _wrapped.setdefault(module, []).append((place, method, number))
    if number != len(names):
        raise ValueError("number of " + name)
    names.append(name)
    _originals.append(None)
    _prices.append(prices.OF.get(name, (0, 0, 0)))

    def keep(function):
        _functions.append(function)
        return function

    return keep


_CONFIG = const(0)
_AVOID = const(1)
_DRIVE = const(2)
_STEP = const(3)
_ADVANCE = const(4)
_POLL = const(5)
_INSERT = const(6)
_VIEW = const(7)
_SORT = const(8)
_FRAME = const(9)
_GUARD = const(10)
_DECIDE = const(11)
_OBSERVE = const(12)
_PREPARE = const(13)
_CHECK = const(14)
_SCORE = const(15)
_BOUNDS = const(16)
_BEST_FIRST = const(17)
_CHOOSE_FIRST = const(18)
_TRY_SECOND = const(19)
_FOLLOW = const(20)
_COST_TO_GO = const(21)
_COMMAND = const(22)
_UPDATE = const(23)
_STOP = const(24)
_SOLVE = const(25)
_OUTPUTS = const(26)
_HEALTH = const(27)
_LINK_FRAME = const(28)
_LINK = const(29)
_SEAL = const(30)
_LINE = const(31)
_TAKE = const(32)
_SCREEN = const(33)
_BUILD = const(34)
_SORT_NEAR = const(35)
_IDLE = const(36)
_ADD = const(37)
_WHOLE = const(38)
_OBEY = const(39)
_TEXT = const(40)
_DECISION = const(41)
_WHEELS = const(42)
_POINTS = const(43)
_TOLD_HEALTH = const(44)
_CANDIDATES = const(45)
_SCAN = const(46)
_GATHER = const(47)
_LINE_CHECK = const(48)
_TRUST = const(49)
_SAFETY = const(50)
_GOAL_FRAME = const(51)
_GOAL_STEP = const(52)
_EMIT = const(53)
_BOX = const(54)
_WAY = const(55)
_HEAR = const(56)
_FRESH = const(25)  # in the work of a Screen: 1 when a box is looked for in a new row


@_wraps(_CONFIG, "params.config:Config.__init__")
def _(self, values=None):
    enter()
    _originals[_CONFIG](self, values)
    leave(_CONFIG, 0, 0)
    settle()


@_wraps(_AVOID, "avoid:Avoid.__init__")
def _(self, config):
    enter()
    try:
        size = os.stat("tables.bin")[6]
    except OSError:
        size = 0  # there are none: they will be made
    out = _originals[_AVOID](self, config)
    leave(_AVOID, 0 if size else 1, 0)
    add(size * prices.FILE_BYTE)
    settle()
    return out


@_wraps(_DRIVE, "actuation.drive:Drive.__init__")
def _(self, steering, servo_chip, motor_left, motor_right, output_enable, config):
    enter()
    _originals[_DRIVE](self, steering, servo_chip, motor_left, motor_right, output_enable, config)
    leave(_DRIVE, 0, 0)
    settle()


@_wraps(_STEP, "robot:Robot.step")
def _(self):
    enter()
    before = self.lidar.frames
    out = _originals[_STEP](self)
    leave(_STEP, 0 if self.lidar.frames == before else 1, 0)
    return out


@_wraps(_ADVANCE, "perception.odometry:Odometry.advance")
def _(self, now_us, drive):
    enter()
    before = self.now_us
    _originals[_ADVANCE](self, now_us, drive)
    leave(_ADVANCE, lockstep.since(self.now_us, before) // 10000 if before >= 0 else 0, 0)


@_wraps(_POLL, "lidar:Lidar.poll")
def _(self, now_us):
    enter()
    before = taken_in
    out = _originals[_POLL](self, now_us)
    leave(_POLL, taken_in - before, self.n if out else 0)
    return out


@_wraps(_INSERT, "perception.local_map:LocalMap.frame")
def _(self, lidar, odometry):
    enter()
    _originals[_INSERT](self, lidar, odometry)
    done()
    leave(_INSERT, lidar.n, self.count)


@_wraps(_VIEW, "perception.local_map:LocalMap.view")
def _(self, x, y, heading, bx, by, reach):
    enter()
    out = _originals[_VIEW](self, x, y, heading, bx, by, reach)
    done()
    leave(_VIEW, self.count, out)
    return out


@_wraps(_SORT, "perception.windows:Windows.sort")
def _(self, px, py, n):
    enter()
    out = _originals[_SORT](self, px, py, n)
    leave(_SORT, n, 0)
    return out


@_wraps(_FRAME, "avoid:Avoid.frame")
def _(self, lidar, odometry):
    enter()
    _originals[_FRAME](self, lidar, odometry)
    leave(_FRAME, 0, 0)


@_wraps(_GUARD, "avoid:Avoid.guard")
def _(self, odometry, speed):
    enter()
    out = _originals[_GUARD](self, odometry, speed)
    mirrored = getattr(getattr(self, "plan", None), "mirroring", 0)  # to one side, to the back: the points are turned about for each
    leave(_GUARD, 1 if out else 0, _checked * ((mirrored & 1) + (mirrored >> 1)))
    return out


@_wraps(_DECIDE, "avoid:Avoid.step")
def _(self, odometry):
    enter()
    out = _originals[_DECIDE](self, odometry)
    leave(_DECIDE, 1 if out else 0, 0)
    return out


@_wraps(_OBSERVE, "avoid:Avoid.observe")
def _(self, odometry, why, af, ar, v):
    enter()
    _originals[_OBSERVE](self, odometry, why, af, ar, v)
    leave(_OBSERVE, 0, 0)


@_wraps(_PREPARE, "planner.collision:CollisionCheck.prepare")
def _(self, n, near, stride, floor):
    global _checked, _stride
    enter()
    _originals[_PREPARE](self, n, near, stride, floor)
    _checked = n
    _stride = stride
    leave(_PREPARE, 0, 0)


@_wraps(_CHECK, "planner.collision:CollisionCheck.check")
def _(self, px, py, first, last, free, soft, block):
    global _tested
    enter()
    _originals[_CHECK](self, px, py, first, last, free, soft, block)
    count = (last - first + _stride - 1) // _stride
    _tested += count
    leave(_CHECK, count, count * _checked)


@_wraps(_SCORE, "planner.move_cost:MoveCost.score")
def _(self, mirroring, free, soft, scores, first, last, stride, af, ar, extra):
    enter()
    out = _originals[_SCORE](self, mirroring, free, soft, scores, first, last, stride, af, ar, extra)
    leave(_SCORE, (last - first + stride - 1) // stride, 0)
    return out


@_wraps(_BOUNDS, "planner.move_cost:MoveCost.lower_bound")
def _(self, mirroring, free, scores, first, af, ar):
    enter()
    out = _originals[_BOUNDS](self, mirroring, free, scores, first, af, ar)
    leave(_BOUNDS, out - first, 0)
    return out


@_wraps(_BEST_FIRST, "planner.move_cost:MoveCost.best_first")
def _(self, ways, free, scores, most):
    enter()
    before = _tested
    out = _originals[_BEST_FIRST](self, ways, free, scores, most)
    leave(_BEST_FIRST, _tested - before, 0)
    return out


@_wraps(_CHOOSE_FIRST, "planner.two_step:TwoStep.choose_first")
def _(self):
    enter()
    out = _originals[_CHOOSE_FIRST](self)
    leave(_CHOOSE_FIRST, 0, 0)
    return out


@_wraps(_TRY_SECOND, "planner.two_step:TwoStep.try_second")
def _(self):
    enter()
    out = _originals[_TRY_SECOND](self)
    leave(_TRY_SECOND, self.ways.n, 0)
    return out


@_wraps(_FOLLOW, "planner.cost_to_go:CostToGo.follow")
def _(self, odometry):
    enter()
    _originals[_FOLLOW](self, odometry)
    leave(_FOLLOW, 0, 0)


@_wraps(_COST_TO_GO, "planner.cost_to_go:CostToGo.step")
def _(self, odometry, points):
    global _closed
    enter()
    stage = self._stage
    out = _originals[_COST_TO_GO](self, odometry, points)
    done()
    fresh = 0
    if stage == _CLOSE:
        fresh = max(min(points.count - _closed, _SLICE), 0)
        _closed += fresh
    else:
        _closed = 0
    leave(_COST_TO_GO, fresh, 1 if stage >= _CLOSE and not fresh else 0)
    return out


@_wraps(_COMMAND, "actuation.drive:Drive.command")
def _(self, af, ar, v):
    enter()
    out = _originals[_COMMAND](self, af, ar, v)
    leave(_COMMAND, 0, 0)
    return out


@_wraps(_UPDATE, "actuation.drive:Drive.update")
def _(self, now_us):
    enter()
    out = _originals[_UPDATE](self, now_us)
    leave(_UPDATE, 1 if out else 0, 0)
    return out


@_wraps(_STOP, "actuation.drive:Drive.stop")
def _(self):
    enter()
    _originals[_STOP](self)
    leave(_STOP, 0, 0)


@_wraps(_SOLVE, "steering:Steering.solve")
def _(self, af, ar):
    enter()
    out = _originals[_SOLVE](self, af, ar)
    leave(_SOLVE, 0, 0)
    return out


@_wraps(_OUTPUTS, "actuation.outputs:Outputs.write")
def _(self, angles, shares, v256):
    enter()
    out = _originals[_OUTPUTS](self, angles, shares, v256)
    leave(_OUTPUTS, 1 if v256 else 0, 0)
    return out


@_wraps(_HEALTH, "safety.health:Health.check")
def _(self, now_us):
    enter()
    out = _originals[_HEALTH](self, now_us)
    leave(_HEALTH, 0, 0)
    return out


@_wraps(_LINK_FRAME, "link.link:Link.frame")
def _(self, lidar):
    enter()
    _originals[_LINK_FRAME](self, lidar)
    leave(_LINK_FRAME, 0, 0)


@_wraps(_LINK, "link.link:Link.update")
def _(self, now_us, robot):
    enter()
    _originals[_LINK](self, now_us, robot)
    leave(_LINK, _idle, 0)


@_wraps(_SEAL, "link.telemetry:Encoder.seal")
def _(self, length):
    enter()
    _originals[_SEAL](self, length)
    leave(_SEAL, length, 0)


@_wraps(_LINE, "link.serial_line:SerialLine.go_on")
def _(self):
    enter()
    written = _originals[_LINE](self)
    leave(_LINE, 1 if written else 0, written)
    if written:
        _write(written)
    return written


@_wraps(_TAKE, "link.serial_line:SerialLine.take")
def _(self, now_us):
    global _read
    enter()
    _read = 0
    out = _originals[_TAKE](self, now_us)
    leave(_TAKE, _read, 0)
    return out


@_wraps(_SCREEN, "link.screen:Screen.update")
def _(self, now_us, robot, link):
    global _boxes, _composed
    enter()
    before = given_out
    _boxes = _composed = 0
    _originals[_SCREEN](self, now_us, robot, link)
    leave(_SCREEN, 1 if given_out != before else 0, _boxes + 2 * _composed)


@_wraps(_BUILD, "core.start:build")
def _(note=None, path="robot.json"):
    enter()
    out = _originals[_BUILD](note, path)
    leave(_BUILD, 0, 0)
    settle()
    return out


@_wraps(_SORT_NEAR, "perception.windows:Windows.sort_near")
def _(self, px, py, n):
    enter()
    out = _originals[_SORT_NEAR](self, px, py, n)
    leave(_SORT_NEAR, n, 0)
    return out


@_wraps(_IDLE, "link.serial_line:SerialLine.idle")
def _(self):
    global _idle
    enter()
    out = _originals[_IDLE](self)
    _idle = 1 if out else 0
    leave(_IDLE, 0, 0)
    return out


@_wraps(_ADD, "link.telemetry:Decoder.add")
def _(self, byte):
    global _read
    enter()
    _read += 1
    out = _originals[_ADD](self, byte)
    leave(_ADD, 0, 0)
    return out


@_wraps(_WHOLE, "link.telemetry:Decoder.take")
def _(self):
    enter()
    out = _originals[_WHOLE](self)
    leave(_WHOLE, self.end if out else 0, 0)
    return out


@_wraps(_OBEY, "link.commands:Commands.obey")
def _(self, line, now_us, robot):
    enter()
    out = _originals[_OBEY](self, line, now_us, robot)
    leave(_OBEY, 0, 0)
    return out


@_wraps(_TEXT, "link.messages:text")
def _(kind, data, before, what):
    enter()
    out = _originals[_TEXT](kind, data, before, what)
    leave(_TEXT, len(what), 0)
    return out


@_wraps(_DECISION, "link.messages:decision")
def _(data, avoid, state, now_us, took_us):
    enter()
    out = _originals[_DECISION](data, avoid, state, now_us, took_us)
    leave(_DECISION, 0, 0)
    return out


@_wraps(_WHEELS, "link.messages:wheels")
def _(data, drive, now_us):
    enter()
    out = _originals[_WHEELS](data, drive, now_us)
    leave(_WHEELS, 0, 0)
    return out


@_wraps(_POINTS, "link.messages:points")
def _(data, avoid, now_us):
    enter()
    out = _originals[_POINTS](data, avoid, now_us)
    leave(_POINTS, out, 0)
    return out


@_wraps(_TOLD_HEALTH, "link.messages:health")
def _(data, robot, dropped, refused, radio):
    enter()
    out = _originals[_TOLD_HEALTH](data, robot, dropped, refused, radio)
    leave(_TOLD_HEALTH, 0, 0)
    return out


@_wraps(_CANDIDATES, "link.watched:candidates")
def _(data, avoid, mirroring, now_us):
    enter()
    out = _originals[_CANDIDATES](data, avoid, mirroring, now_us)
    leave(_CANDIDATES, out, 0)
    return out


@_wraps(_SCAN, "link.watched:ScanGatherer.take")
def _(self, data):
    enter()
    out = _originals[_SCAN](self, data)
    leave(_SCAN, out, 0)
    return out


@_wraps(_GATHER, "link.watched:ScanGatherer.add")
def _(self, lidar):
    enter()
    _originals[_GATHER](self, lidar)
    leave(_GATHER, lidar.n, 0)


@_wraps(_LINE_CHECK, "link.screen:crc16")
def _(data, start, end):
    enter()
    out = _originals[_LINE_CHECK](data, start, end)
    leave(_LINE_CHECK, end - start, 0)
    return out


@_wraps(_TRUST, "perception.scan_trust:ScanTrust.frame")
def _(self, lidar, odometry, v256):
    enter()
    _originals[_TRUST](self, lidar, odometry, v256)
    leave(_TRUST, lidar.n, 0)


@_wraps(_SAFETY, "safety.safety:Safety.check")
def _(self, now_us):
    enter()
    out = _originals[_SAFETY](self, now_us)
    leave(_SAFETY, 0, 0)
    return out


@_wraps(_GOAL_FRAME, "goal.layer:Goal.frame")
def _(self, lidar, odometry):
    enter()
    before = self.numbers[7]
    _originals[_GOAL_FRAME](self, lidar, odometry)
    leave(_GOAL_FRAME, max(self.numbers[7] - before, 0), 0)


@_wraps(_GOAL_STEP, "goal.layer:Goal.step")
def _(self, odometry, points):
    enter()
    n = self.numbers
    stage, search = n[43], n[44]
    out = _originals[_GOAL_STEP](self, odometry, points)
    work = 0  # as much as a point matched
    if out:
        if stage == 0:
            work = n[7] if self.locate is None else 720
        elif stage == 1:
            work = 330
        elif stage == 2:
            work = min(points.count, 90) * 6
        elif stage == 3:
            work = n[1] * 6 // 5 if search == 0 else n[1] * 2 // 3 if search < 3 else 870
    leave(_GOAL_STEP, 1 if out else 0, work)


@_wraps(_EMIT, "link.screen:emit")
def _(command, at, texts, ends, number, work):
    enter()
    begin = work[0] if number < 0 else at
    out = _originals[_EMIT](command, at, texts, ends, number, work)
    leave(_EMIT, out - begin, 0)
    return out


@_wraps(_BOX, "link.screen:box")
def _(cells, c, at, work, px, py, windows, count):
    global _boxes
    enter()
    _boxes += 1
    fresh = work[_FRESH]
    out = _originals[_BOX](cells, c, at, work, px, py, windows, count)
    leave(_BOX, count if fresh else 0, fresh)
    return out


@_wraps(_WAY, "link.screen:way")
def _(cells, work, vx, vy, w, span, v):
    enter()
    _originals[_WAY](cells, work, vx, vy, w, span, v)
    leave(_WAY, 0, 0)


@_wraps(_HEAR, "link.screen:hear")
def _(cells, at, byte, work, data, count):
    enter()
    out = _originals[_HEAR](cells, at, byte, work, data, count)
    leave(_HEAR, count, 0)
    return out


def _write(count):
    """The USB serial line gets bytes, 11.52 of which it sends in a millisecond; the rest waits in its FIFO, or the writer does."""
    global _fifo, _fifo_us
    if _per_us == 0:
        return
    settle()
    _fifo += count
    while True:
        passed = min(max(lockstep.since(lockstep.now, _fifo_us), 0), 100_000)
        _fifo = max(_fifo - passed * 1152 // 100_000, 0)
        _fifo_us = lockstep.now
        if _fifo <= _FIFO:
            return
        lockstep.advance(_TICK_US - lockstep.now % _TICK_US)
