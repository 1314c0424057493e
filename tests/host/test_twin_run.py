"""The firmware in lockstep: small programs on the simulated board, then the robot's own firmware."""

import json
import os

import pytest

from host.twin import Observer, image, process, run, silence

ENGINES = ("micropython", "cpython")  # of what does not depend on the size of words


class Log(Observer):
    """Keeps what the board sends."""

    def __init__(self):
        self.printed = b""
        self.writes = []
        self.lidar_bytes = []
        self.uart_bytes = []

    def serial(self, data):
        self.printed += data

    def registers(self, time, address, data):
        self.writes.append((time, address, bytes(data)))

    def lidar(self, time, data):
        self.lidar_bytes.append((time, data))

    def uart(self, time, gpio, data):
        self.uart_bytes.append((time, gpio, bytes(data)))


@pytest.fixture
def board(tmp_path):
    """board(source, ...) runs a program as main.py; returns the result and the log."""

    def start(source, engine="micropython", watch=None, **settings):
        (tmp_path / "main.py").write_text(source)
        watch = watch or Log()
        settings = {"config": {}, "limit_s": 3, "record": False, **settings}
        return run("Z", 550, engine=engine, watch=watch, firmware=tmp_path, **settings), watch

    return start


PERIPHERALS = """
import json, time
import machine
from micropython import heap_lock, heap_unlock

seen = {}
i2c = machine.I2C(0, scl=machine.Pin(22), sda=machine.Pin(21), freq=400000)
seen["scan"] = i2c.scan()
try:
    i2c.writeto(0x50, b"x")
except OSError as error:
    seen["absent"] = error.args[0]
before = time.ticks_us()
i2c.writeto(0x40, bytes([0x06] + [0] * 40))
seen["burst_us"] = time.ticks_diff(time.ticks_us(), before)
seen["mode1"] = list(i2c.readfrom_mem(0x40, 0, 2))
seen["stop"] = machine.Pin(32, machine.Pin.IN, machine.Pin.PULL_UP).value()
seen["battery"] = machine.ADC(machine.Pin(35)).read_uv()
led = machine.Pin(33, machine.Pin.OUT, value=1)
seen["led"] = led.value()

before = time.ticks_ms()
time.sleep_ms(250)
seen["slept"] = time.ticks_diff(time.ticks_ms(), before)
seen["wrap"] = [time.ticks_add(2**30 - 1, 2), time.ticks_diff(1, 2**30 - 1), time.ticks_diff(2**30 - 1, 1)]

small = machine.UART(2, baudrate=230400, tx=17, rx=16, rxbuf=256)
motor = machine.PWM(machine.Pin(27), freq=20000, duty_u16=40000)
time.sleep_ms(1500)
seen["kept"] = small.any()
time.sleep_ms(2)

uart = machine.UART(2, baudrate=230400, tx=17, rx=16, rxbuf=4096)
buffer = bytearray(300)
total = 0
longest = 0
count = 0
turns = 400
heap_lock()
while turns:
    time.sleep_us(700)
    count = uart.readinto(buffer)
    if count:
        total += count
        if count > longest:
            longest = count
    turns -= 1
heap_unlock()
seen["total"] = total
seen["longest"] = longest
seen["rest"] = uart.readinto(buffer)
slow = machine.UART(2, baudrate=115200, tx=17, rx=16, rxbuf=4096)
time.sleep_ms(100)
seen["wrong_baud"] = slow.any()
machine.UART(1, tx=25, rx=26).write(b"hello")
time.sleep_ms(20)
print(json.dumps(seen))
"""


@pytest.mark.parametrize("engine", ENGINES)
def test_peripherals(board, engine):
    result, log = board(PERIPHERALS, engine)
    seen = json.loads(log.printed)
    assert seen["scan"] == [0x40, 0x41, 0x42]
    assert seen["absent"] == 19
    assert 950 < seen["burst_us"] < 1050
    assert seen["mode1"] == [0x11, 0x11]  # without auto-increment the chip stays at a register
    assert seen["stop"] == 1
    assert seen["battery"] == pytest.approx(2.6e6, rel=0.01)
    assert seen["led"] == 1
    assert seen["slept"] == 250
    assert seen["wrap"] == [1, 2, -2]
    assert seen["kept"] == 256
    assert result.overflows > 1000
    # 280 ms at about 130 bytes in 10 ms; never more in 700 us than the wire carries.
    assert 2500 < seen["total"] < 4500
    assert seen["longest"] <= 17
    assert seen["rest"] is None
    assert seen["wrong_baud"] == 0
    assert log.uart_bytes[0][1:] == (25, b"hello")
    assert result.reason == "the firmware's main.py came to its end (exit 0)"


def test_both_interpreters_see_the_same(board):
    one, two = (board(PERIPHERALS, engine)[1] for engine in ENGINES)
    assert json.loads(one.printed) == json.loads(two.printed)
    assert one.lidar_bytes == two.lidar_bytes
    assert one.writes == two.writes


@pytest.mark.parametrize("engine", ENGINES)
def test_a_crash_ends_the_run_with_its_traceback(board, engine):
    result, _ = board("import time\ntime.sleep_ms(100)\nraise ValueError('a wheel fell off')\n", engine)
    assert result.result == "blocked"
    assert "Traceback" in result.reason and "a wheel fell off" in result.reason and "line 3" in result.reason
    assert result.time_s == pytest.approx(0.1, abs=0.02)


def test_an_endless_loop_ends_the_run(board, monkeypatch):
    monkeypatch.setattr(silence, "LIMIT_S", 0.3)
    result, _ = board("while True:\n    pass\n")
    assert result.result == "blocked"
    assert "without letting time pass" in result.reason


def test_a_firmware_that_waits_for_nothing_ends_the_run(board, monkeypatch):
    monkeypatch.setattr(silence, "LIMIT_S", 0.3)
    result, _ = board("import sys\nsys.stdin.readline()\n")
    assert "nobody sends" in result.reason


def test_a_process_that_is_kept_waiting_has_computed_nothing(board, monkeypatch):
    monkeypatch.setattr(silence, "LIMIT_S", 0.3)
    source = "import os, signal, time\nfor _ in range(3):\n    time.sleep_ms(100)\nos.kill(os.getpid(), signal.SIGSTOP)\ntime.sleep_ms(100)\nprint('went on')\n"

    class Nurse(Log):
        """Lets the stopped process go on, four times the limit later."""

        def step(self, simulation):
            if simulation.now > 250_000:
                import subprocess
                import threading

                wake = "sleep 1.2; for p in $(ps -o pid= --ppid %d); do kill -CONT $p; done" % os.getpid()
                threading.Thread(target=lambda: subprocess.run(["sh", "-c", wake], check=False)).start()

    _, log = board(source, engine="cpython", watch=Nurse())
    assert b"went on" in log.printed


LIVES = """
import machine, time
cause = machine.reset_cause()
with open("lives", "a") as file:
    file.write("%d " % cause)
with open("lives") as file:
    lives = file.read()
enable = machine.Pin(33, machine.Pin.OUT, value=0)
time.sleep_ms(100)
print(lives, time.ticks_ms())
if cause == 1:
    machine.reset()
if cause == 2:
    machine.soft_reset()
if cause == 5:
    watchdog = machine.WDT(timeout=500)
    for _ in range(9):
        time.sleep_ms(100)
        watchdog.feed()
    time.sleep(1)
time.sleep(3)
"""


@pytest.mark.parametrize("engine", ENGINES)
def test_the_board_starts_again(board, engine):
    class Lives(Log):
        def __init__(self):
            super().__init__()
            self.resets = []
            self.enabled = []

        def reset(self, time, cause):
            self.resets.append((time, cause))
            self.enabled.append((time, self.simulation.electronics.enabled))

        def step(self, simulation):
            self.simulation = simulation
            self.enabled.append((simulation.now, simulation.electronics.enabled))

    result, log = board(LIVES, engine, watch=Lives(), limit_s=4)
    lines = [line.split() for line in log.printed.decode().splitlines()]
    assert [line[:-1] for line in lines] == [["1"], ["1", "2"], ["1", "2", "5"], ["1", "2", "5", "3"]]  # the file is kept
    assert [int(line[-1]) for line in lines] == [100, 100, 500, 100]  # a soft reset leaves the clock alone; 300 ms to main.py
    assert log.resets == [(100_000, 2), (500_000, 5), (2_300_000, 3)]  # bitten 500 ms after the last feeding, 1.4 s after 0.9
    assert not any(enabled for time, enabled in log.enabled if 110_000 < time < 390_000)  # the pins float
    assert (100_000, True) in log.enabled
    assert result.reason == "4 s are over"


def test_source_that_does_not_compile_is_named(board):
    with pytest.raises(SyntaxError, match="main.py does not compile"):
        board("def\n")


def test_commands_inputs_and_faults_reach_the_board(board):
    class Person(Log):
        sent = False

        def step(self, simulation):
            simulation.electronics.stop_pressed = simulation.now > 0.5e6
            simulation.electronics.battery_volts = 6.0
            if simulation.now > 1e6:
                simulation.electronics.chips.pop(0x41, None)
            self.now = simulation.now

        def commands(self):
            first, self.sent = not self.sent, True
            return b"go\n" if first else b""

    source = """
import sys, time, machine
i2c = machine.I2C(0, scl=machine.Pin(22), sda=machine.Pin(21))
stop = machine.Pin(32, machine.Pin.IN, machine.Pin.PULL_UP)
time.sleep_ms(1)
print(sys.stdin.readline().strip())
for _ in range(3):
    print(stop.value(), i2c.scan(), round(machine.ADC(35).read_uv() / 1000))
    time.sleep_ms(600)
"""
    _, log = board(source, watch=Person())
    lines = log.printed.decode().split("\n")
    assert lines[0] == "go"
    assert lines[1:4] == ["1 [64, 65, 66] 2000", "0 [64, 65, 66] 2000", "0 [64, 66] 2000"]


def test_an_unplugged_lidar_is_silent(board):
    class Cut(Log):
        def step(self, simulation):
            simulation.lidar.unplugged = simulation.now > 1e6

    source = "import machine, time\nm = machine.PWM(27, freq=20000, duty_u16=40000)\nwhile True:\n    time.sleep_ms(5)\n"
    _, log = board(source, watch=Cut())
    assert 0.9e6 < log.lidar_bytes[-1][0] < 1.1e6


def test_what_the_firmware_finds_as_robot_json(board):
    source = "import json\nprint(json.dumps(json.load(open('robot.json'))))\n"
    _, log = board(source, mode="naws", changes={"windows.red": 25})
    assert json.loads(log.printed) == {"mode": "NAWS", "windows": {"red": 25}}


def test_compiling_happens_once(board, tmp_path):
    board("pass\n")
    first = image.compiled(tmp_path)
    stamp = first[1].stat().st_mtime_ns
    assert image.compiled(tmp_path) == first and first[1].stat().st_mtime_ns == stamp
    (tmp_path / "main.py").write_text("pass  # changed\n")
    assert image.compiled(tmp_path) != first


# The robot's own firmware

SECONDS = 4
ROUND = 2**30  # us, of the board's clock


def _writes(engine, **settings):
    log = Log()
    return run(engine=engine, watch=log, record=False, **settings), log


@pytest.mark.parametrize("course", (dict(course="Z", width=550, seed=2), dict(course="Z", width=600, seed=2, mode="naws")), ids=("aws", "naws"))
def test_the_engines_write_the_same_registers_at_the_same_ticks(course):
    (one, first), *others = (_writes(engine, **course) for engine in process.ENGINES)
    assert one.result == "pass" and len(first.writes) > 200
    for other, log in others:
        assert log.writes == first.writes, other.engine
        assert log.lidar_bytes == first.lidar_bytes, other.engine


@pytest.fixture(scope="module")
def drives():
    """The first seconds of Z 550, seed 2, twice."""
    return [_writes("micropython", course="Z", width=550, seed=2, limit_s=SECONDS) for _ in range(2)]


def test_the_firmware_drives(drives):
    result, log = drives[0]
    assert result.reason == f"{SECONDS} s are over"
    assert result.decisions > 3  # they rest while nothing changes
    assert result.overflows == 0
    assert result.track[-1, 2] > result.track[0, 2] + 100
    assert [decision.number for decision in result.log] == sorted(decision.number for decision in result.log)


def test_a_run_repeats_byte_for_byte(drives):
    assert drives[0][1].writes == drives[1][1].writes
    assert drives[0][1].lidar_bytes == drives[1][1].lidar_bytes


HOURS = """
import time
from micropython import heap_lock, heap_unlock
step = 0
late = 0
heap_lock()
before = time.ticks_us()
while step < 40:
    time.sleep_us(100001)
    if time.ticks_diff(time.ticks_us(), before) != 100001:
        late += 1
    before = time.ticks_add(before, 100001)
    step += 1
heap_unlock()
print(late, time.ticks_us(), time.ticks_ms(), time.time())
"""


@pytest.mark.parametrize("engine", process.ENGINES)
def test_the_clock_is_right_after_hours_and_takes_no_heap(board, engine):
    begins = 7 * ROUND - 2_000_000
    _, log = board(HOURS, engine, clock_us=begins, limit_s=5)
    now = begins + 40 * 100001
    assert [int(word) for word in log.printed.split()] == [0, now % ROUND, now // 1000 % ROUND, now // 1_000_000]


def test_the_twin_is_faster_than_the_robot(drives):
    # Five times and more on a free machine; the test must hold on a busy one too.
    assert min(result.wall_s for result, _ in drives) < SECONDS
