"""Runs the firmware's main.py on a tape under MicroPython and writes down what each part of its loop took.

    runner.py WHAT TAPE LOG TWIN_BOARD FIRMWARE BASELINES [EVERY | COSTS]

WHAT: time   microseconds of each part here; every EVERY-th decision is made by the baselines too
      count  instructions on the ESP32: FIRMWARE has counters, COSTS (i32 each) says what each counted block costs
      heap   heap that the steady loop takes, and the bytes of all buffers
LOG   time and count: rows of i32: kind, value, extra, simulated time (us); the kinds are below. TURN is what the rest of a turn of the loop
      took, extra the whole turn. count: after the rows the counters of the worst row of each kind
      heap: one line of JSON
"""

import gc
import sys
import time as clock
from array import array

import micropython

_what, _tape, _log_path, _twin_board, _firmware, _baselines = sys.argv[1:7]
sys.path[:] = [sys.argv[0].rsplit("/", 1)[0], _twin_board, _firmware, _firmware + "/lib", _baselines]


def _take_over(name):
    sys.modules.pop(name, None)
    sys.modules[name] = __import__(name)


import lockstep

_take_over("time")
_take_over("machine")

POLL, PLACE, GUARD, WORK, UPDATE, COMMAND, POINTS, PAPER, PLAIN, FEED, TURN = range(1, 12)
_KINDS = 12
_ROWS = 300000
_STEADY_US = 4000000
_WATCHED_US = 8000000  # of the heap: it takes long to look at

_rows = array("i", bytes(16 * _ROWS)) if _what != "heap" else None
_count = 0


def _write(kind, value, extra):
    global _count
    at = 4 * _count
    _rows[at] = kind
    _rows[at + 1] = value
    _rows[at + 2] = extra
    _rows[at + 3] = lockstep.now
    _count += 1


def _robot():
    return getattr(sys.modules.get("main"), "robot", None)


class Watch:
    """Measures the calls of one robot's parts. What a part calls of another is that other's."""

    def __init__(self, robot):
        self.robot = robot
        self.before = 0  # of the odometry, to be added to the frame
        self.inner = [0] * 8  # what the calls made from each open call took
        self.depth = 0
        avoid = robot.avoid
        self.wrap(robot, "step", self.after_step)
        self.wrap(robot.odometry, "advance", self.after_advance)
        self.wrap(robot.lidar, "poll", self.after_poll)
        self.wrap(avoid, "frame", self.after_place)
        self.wrap(avoid, "guard", self.after_guard)
        self.wrap(avoid, "work", self.after_work)
        self.wrap(robot.drive, "command", self.after_command)
        self.wrap(robot.drive, "update", self.after_update)

    def wrap(self, part, name, after):
        function = getattr(part, name)

        def call(*arguments):
            self.depth += 1
            self.inner[self.depth] = 0
            self.begin()
            began = lockstep.now
            out = function(*arguments)
            own = self.end(name)
            self.depth -= 1
            self.inner[self.depth] += own + self.inner[self.depth + 1]
            after(own, out, lockstep.now - began)
            self.resume()
            return out

        setattr(part, name, call)

    def after_step(self, value, out, waited):
        if out:
            _write(TURN, value, value + self.inner[self.depth + 1])

    def after_advance(self, value, out, waited):
        self.before = value

    def after_poll(self, value, out, waited):
        if out:
            _write(POLL, value + self.before, lockstep.now - lockstep.last_byte_us)
            self.before = 0

    def after_place(self, value, out, waited):
        _write(PLACE, value, 0)

    def after_guard(self, value, out, waited):
        _write(GUARD, value, 1 if out is True else 0)

    def after_work(self, value, out, waited):
        _write(WORK, value, 1 if out else 0)
        if out:
            avoid = self.robot.avoid
            inside = 0
            for i in range(avoid.points_count):
                if avoid.points_window[i]:
                    inside += 1
            _write(POINTS, avoid.points_count, inside)
            self.decided(avoid)

    def after_command(self, value, out, waited):
        _write(COMMAND, value, 0)

    def after_update(self, value, out, waited):
        if waited or out:
            _write(UPDATE, value, waited)

    def decided(self, avoid):
        pass


class Stopwatch(Watch):
    """Microseconds here."""

    def __init__(self, robot):
        import paper
        import plain

        self.paper = paper.Planner(robot.config)
        self.plain = plain.Planner(robot.config, robot.avoid.envelopes)
        self.every = int(sys.argv[7])
        self.count = 0
        self.now = clock.ticks_us
        self.began = [0] * 8
        super().__init__(robot)

    def begin(self):
        self.began[self.depth] = self.now()

    def end(self, name):
        return clock.ticks_diff(self.now(), self.began[self.depth]) - self.inner[self.depth]

    def resume(self):
        pass

    def decided(self, avoid):
        self.count += 1
        if self.every == 0 or self.count % self.every:
            return
        # Now and then the decision is made by the baselines as well; the time that takes is nobody's.
        for kind, planner in ((PAPER, self.paper), (PLAIN, self.plain)):
            xs = [avoid.points_x[i] for i in range(avoid.points_count)]
            ys = [avoid.points_y[i] for i in range(avoid.points_count)]
            gc.collect()
            gc.enable()  # they make objects of every float
            began = self.now()
            planner.decide(xs, ys)
            took = clock.ticks_diff(self.now(), began)
            gc.disable()
            gc.collect()
            _write(kind, took, len(xs))


@micropython.viper
def _sum(counters: ptr32, costs: ptr32, count: int) -> int:
    total = 0
    i = 0
    while i < count:
        n = counters[i]
        if n:
            total += n * costs[i]
        i += 1
    return total


@micropython.viper
def _clear(counters: ptr32, count: int):
    i = 0
    while i < count:
        counters[i] = 0
        i += 1


class Counter(Watch):
    """Instructions on the ESP32, from the counters of the firmware's blocks."""

    def __init__(self, robot):
        from counters import COUNTERS

        with open(sys.argv[7], "rb") as file:
            self.costs = array("i", file.read())
        self.size = len(self.costs)
        self.own = [0] * 8
        self.counters = COUNTERS
        self.worst = [0] * _KINDS
        self.worst_counters = [array("i", bytes(4 * self.size)) for _ in range(_KINDS)]
        self.kinds = {"poll": POLL, "frame": PLACE, "guard": GUARD, "work": WORK, "command": COMMAND, "update": UPDATE, "advance": FEED, "step": TURN}
        super().__init__(robot)

    def begin(self):
        """What has been counted since the enclosing call began or went on is its own."""
        self.own[self.depth - 1] += _sum(self.counters, self.costs, self.size)
        self.own[self.depth] = 0
        _clear(self.counters, self.size)

    def end(self, name):
        last = _sum(self.counters, self.costs, self.size)
        kind = self.kinds[name]
        if last > self.worst[kind]:
            self.worst[kind] = last
            target = self.worst_counters[kind]
            for i in range(self.size):
                target[i] = self.counters[i]
        return self.own[self.depth] + last

    def resume(self):
        _clear(self.counters, self.size)


def _measure():
    """Install the watch as soon as there is a robot; write the log at the end."""
    watch = None

    def step(time):
        nonlocal watch
        if watch is None and _robot() is not None:
            watch = (Stopwatch if _what == "time" else Counter)(_robot())

    def end():
        lockstep.on_step, lockstep.on_end = None, lambda: None  # the firmware switches off yet
        with open(_log_path, "wb") as file:
            file.write(memoryview(_rows)[: 4 * _count])
            if _what == "count":
                for counters in watch.worst_counters:
                    file.write(counters)
        sys.exit(0)

    gc.disable()
    lockstep.on_step, lockstep.on_end = step, end


def _buffers():
    """Bytes on the ESP32 of all arrays and bytearrays reachable from the robot and the firmware's modules, each once."""
    sizes = {"b": 1, "B": 1, "h": 2, "H": 2, "i": 4, "I": 4, "l": 4, "L": 4, "q": 8, "Q": 8, "f": 4, "d": 8}
    board = ("machine", "lockstep", "time", "sys", "gc", "__main__")
    seen = set()
    total = 0
    todo = [module for name, module in sys.modules.items() if name not in board]
    while todo:
        thing = todo.pop()
        if id(thing) in seen:
            continue
        seen.add(id(thing))
        if isinstance(thing, bytearray):
            total += len(thing)
        elif isinstance(thing, array):
            total += len(thing) * sizes[repr(thing[:0])[7]]
        elif isinstance(thing, (list, tuple)):
            todo.extend(thing)
        elif isinstance(thing, dict):
            todo.extend(thing.values())
        elif hasattr(thing, "__dict__") and getattr(type(thing), "__module__", None) not in board and type(thing).__name__ not in _BOARD_CLASSES:
            todo.extend(thing.__dict__.values())
    return total


_BOARD_CLASSES = ("UART", "I2C", "Pin", "PWM", "ADC", "WDT", "type")


def _watch_heap():
    """The most that the heap grew from one sleep of the steady loop to the next.

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
        with open(_log_path, "w") as file:
            file.write('{"worst": %d, "all": %d, "sleeps": %d, "buffers": %d}\n' % (state[1], state[2], state[3], _buffers()))
        sys.exit(0)

    time.sleep_ms = watched_sleep_ms
    lockstep.on_end = end


if _what == "heap":
    _watch_heap()
else:
    _measure()
lockstep.connect(_tape)

import main
