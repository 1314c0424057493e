"""Each fault does what its name says: on the lidar's line, at the chips and pins, to the body, inside the board. What the robot makes of it is not asked here."""

import ast
import importlib
import inspect
import json

import numpy as np
import pytest

from host import compat
from host.link.address import AddressError
from host.link.twin import arguments_of
from host.twin import Observer, cli, faults, image, run, silence
from host.twin.faults import base, lidar, table
from host.twin.faults.board import PARTS

ENGINES = ("micropython", "cpython")
# Straight on at 400 mm/s through the registers alone, writing them anew every 20 ms, and printing what it sees.
DRIVES = """
import machine, time
i2c = machine.I2C(0, scl=machine.Pin(22), sda=machine.Pin(21), freq=400000)
enable = machine.Pin(33, machine.Pin.OUT, value=1)
button = machine.Pin(32, machine.Pin.IN, machine.Pin.PULL_UP)
adc = machine.ADC(35)
machine.PWM(machine.Pin(27), freq=20000, duty_u16=40960)
for address, prescale in ((0x40, 121), (0x41, 5), (0x42, 5)):
    i2c.writeto(address, bytes([0xFE, prescale]))
    i2c.writeto(address, bytes([0x00, 0x21]))
print("life", machine.reset_cause(), time.ticks_us())
i2c.writeto(0x40, bytes([0x06] + [0, 0, 307 & 255, 307 >> 8] * 10))
enable.value(0)
while True:
    before = time.ticks_us()
    try:
        for address in (0x41, 0x42):
            i2c.writeto(address, bytes([0x06] + [0, 0, 0, 5, 0, 0, 0, 0] * 5))
        bus = 0
    except OSError as error:
        bus = error.args[0]
    print(before, time.ticks_diff(time.ticks_us(), before), bus, button.value(), adc.read_uv() // 1000)
    time.sleep_ms(20)
"""


class Log(Observer):
    """Keeps the lidar's bytes by their time, what the board prints, and the simulation."""

    def __init__(self):
        self.frames = []
        self.printed = b""
        self.resets = []
        self.speeds = []

    def lidar(self, time, data):
        self.frames.append((time, bytes(data)))

    def serial(self, data):
        self.printed += data

    def reset(self, time, cause):
        self.resets.append((time, cause))

    def step(self, simulation):
        self.simulation = simulation
        self.speeds.append((simulation.now, simulation.body.twist[1], simulation.body.speeds.copy(), simulation.lidar.speed))

    def after(self, time):
        """Frames from then on, us."""
        return [data for when, data in self.frames if when > time]

    def rows(self):
        """What DRIVES printed in its loop: ticks, us that the writes took, errno, button, mV."""
        return np.array([line.split() for line in self.printed.decode().splitlines() if line[:1].isdigit()], int)


@pytest.fixture
def board(tmp_path):
    """board(fault, ...) runs DRIVES, or another source, with the fault at 1 s; the result and the log."""

    def start(fault, source=DRIVES, engine="micropython", limit_s=2.0, course="random", **settings):
        (tmp_path / "main.py").write_text(source)
        log = Log()
        result = run(course, gap=1500, engine=engine, watch=log, firmware=tmp_path, fault=fault, limit_s=limit_s, record=False, **settings)
        return result, log

    return start


def points_of(data):
    """signals, counts (quarter mm) of a frame."""
    points = np.frombuffer(data, np.uint8)[13:-2].reshape(-1, 3).astype(int)
    return points[:, 0], points[:, 1] << 8 | points[:, 2]


def whole(frames):
    """Only those that measure."""
    return [data for data in frames if lidar.measures(data)]


SETTLED = 2_050_000  # the lidar has its speed long before; the fault begins at 2 s


def seen(board, name):
    _, log = board(f"{name}@2", limit_s=3)
    assert len(whole(log.after(0))) > len(whole(log.after(SETTLED))), "nothing came before the fault"
    return log, log.after(SETTLED)


def test_lidar_silent(board):
    log, frames = seen(board, "lidar-silent")
    assert not frames
    assert log.speeds[-1][3] > 5  # it still turns


def test_lidar_unplugged(board):
    log, frames = seen(board, "lidar-unplugged")
    assert not frames
    cut = log.frames[-1][1]
    assert len(cut) < cut[2] + 2  # the last frame broke off
    assert log.speeds[-1][3] < 1


def test_lidar_garbage(board):
    _, frames = seen(board, "lidar-garbage")
    assert len(set(frames)) == len(frames) > 50
    assert not any(data[0] == 0xAA and data[3:5] == b"\x01\x61" for data in frames)


def test_lidar_slow_says_so_instead_of_points(board):
    log, _ = seen(board, "lidar-slow")
    late = log.after(2_700_000)
    assert late and all(data[5] == 0xAE for data in late)
    assert log.speeds[-1][3] == pytest.approx(3, abs=0.3)


def test_lidar_frozen(board):
    _, frames = seen(board, "lidar-frozen")
    assert len(set(frames)) == 1 and len(frames) > 50


def test_lidar_stuck(board):
    _, frames = seen(board, "lidar-stuck")
    assert len(set(frames)) <= 17
    assert frames[:16] == frames[16:32] and len(set(frames[:16])) == 16


@pytest.mark.parametrize("name, count, signal", [("lidar-blind", 0, 0), ("lidar-far", 65535, 100), ("lidar-near", 799, 100)])
def test_lidar_all_alike(board, name, count, signal):
    _, frames = seen(board, name)
    assert len(frames) > 50
    for data in frames:
        signals, counts = points_of(data)
        assert set(counts) == {count} and set(signals) == {signal}


def test_lidar_covered_from_the_start(board):
    result, log = board("lidar-covered")
    assert result.fault.fault_at_s == pytest.approx(0, abs=0.1)
    assert whole(log.after(0)) and all(not points_of(data)[1].any() for data in whole(log.after(0)))


@pytest.mark.parametrize("changes", [{}, {"lidar.offset": 90}, {"lidar.offset": 90, "lidar.mirrored": True}])
@pytest.mark.parametrize("name, missing, half", [("lidar-front", 2, 22.5), ("lidar-half", 8, 90)])
def test_lidar_sectors_never_sent(board, name, missing, half, changes):
    _, log = board(f"{name}@2", limit_s=3, changes=changes)
    starts = {lidar.start_of(data) for data in log.after(SETTLED)}
    lost = {lidar.start_of(data) for data in whole(log.after(0))} - starts
    assert len(lost) == missing and len(starts) == 16 - missing
    sign = -1 if changes.get("lidar.mirrored") else 1
    middles = [(sign * (start / 100 + 11.25) + changes.get("lidar.offset", 0) + 180) % 360 - 180 for start in lost]
    assert all(abs(middle) < half for middle in middles)


def test_lidar_hole(board):
    _, log = board("lidar-hole@2", limit_s=3)
    starts = {lidar.start_of(data) for data in log.after(SETTLED)}
    assert len(starts) == 15 and len({lidar.start_of(data) for data in whole(log.after(0))}) == 16


def test_lidar_lost(board):
    _, log = board("lidar-lost@2", limit_s=6)
    times = np.array([time for time, data in log.frames if lidar.measures(data) and time > SETTLED])
    gaps = np.diff(times) > 1.5 * np.median(np.diff(times))
    assert gaps.sum() == 3


def test_lidar_glass(board):
    _, frames = seen(board, "lidar-glass")
    for data in frames:
        _, counts = points_of(data)
        start = lidar.start_of(data)
        if start in (0, 2250, 31500, 33750):
            assert not counts.any()
        elif 9000 <= start < 27000:
            assert counts.any()


def test_lidar_dust(board):
    _, frames = seen(board, "lidar-dust")
    dust = [count for data in frames for signal, count in zip(*points_of(data)) if signal == 50 and 1000 <= count < 2400]
    total = sum(len(points_of(data)[1]) for data in frames)
    assert 0.004 < len(dust) / total < 0.03


def test_chip_gone(board):
    result, log = board("chip-gone@1")
    rows = log.rows()
    after = rows[rows[:, 0] > 1_050_000]
    assert set(after[:, 2]) == {19} and not rows[rows[:, 0] < 950_000][:, 2].any()
    assert (result.fault.still_ms, result.fault.driven_after_s) == (None, 1)  # it goes on with what it heard last


def test_chip_reset_loses_its_registers(board):
    result, log = board("chip-reset@1")
    chips = log.simulation.electronics.chips
    assert not chips[0x41].awake and chips[0x42].awake
    assert log.speeds[-1][2][0] < 10 and log.speeds[-1][2][1] > 300
    assert result.fault.still_ms is None  # the right side drives on


def test_chip_resets_come_again(board):
    wakes = DRIVES.replace("    try:\n", "    i2c.writeto(0x41, bytes([0x00, 0x21]))\n    try:\n")
    _, log = board("chip-resets@1", wakes, limit_s=4.5)
    slow = [time for time, _, speeds, _ in log.speeds if speeds[0] < 0.97 * speeds[1] and time > 1e6]
    kicks = [time for time, before in zip(slow, [0, *slow]) if time - before > 500_000]
    assert len(kicks) == 4 and np.diff(kicks) == pytest.approx(1.1e6, abs=3e4)


def test_bus_stuck_until_it_is_clocked(board):
    _, log = board("i2c-stuck@1", limit_s=12)
    late = log.rows()[-1]
    assert late[2] == 116 and late[1] == 100_000 * 42  # 41 bytes and the address; 100 ms each is the driver's limit
    clocks = """
    if bus:
        scl = machine.Pin(22, machine.Pin.OUT)
        for _ in range(9):
            scl(0)
            scl(1)
"""
    slow = DRIVES.replace("0, 0, 0, 5", "0, 0, 0, 1") + clocks
    _, log = board("i2c-stuck@1", slow, limit_s=8)
    assert set(log.rows()[-10:, 2]) == {0} and 116 in log.rows()[:, 2]
    _, log = board("i2c-dead@1", slow, limit_s=12)
    assert set(log.rows()[-2:, 2]) == {116}


@pytest.mark.parametrize("name, cause", [("reset", 2), ("brown-out", 1), ("oe-open", 2)])
def test_the_processor_starts_anew(board, name, cause):
    result, log = board(f"{name}@1", limit_s=3)
    lives = [line.split()[1:] for line in log.printed.decode().splitlines() if line.startswith("life")]
    assert [int(life[0]) for life in lives] == [1, cause]
    assert int(lives[1][1]) < 100_000  # the clock as well
    on = [(time, on) for time, on in log.simulation.electronics.switched if time > 900_000]
    if name == "oe-open":
        assert not on  # the motors turn and turn: this firmware does not say otherwise
    else:
        assert on[0] == (pytest.approx(1e6, abs=25e3), False) and on[1][0] > 1_300_000


def test_robot_json_is_empty_after_the_reset(board):
    source = DRIVES.replace('print("life"', 'print(len(open("robot.json").read()), "long")\nprint("life"')
    _, log = board("oe-open-json@1", source)
    lengths = [int(line.split()[0]) for line in log.printed.decode().splitlines() if line.endswith("long")]
    assert lengths[0] > 2 and lengths[1:] == [0]


@pytest.mark.parametrize("name, pressed", [
    ("button-held", [(0, 0.95)]),
    ("button-short", [(0, 0.2)]),
    ("button-bounce", [(0, 0.02), (0.04, 1.5), (1.52, 3)]),
    ("button-wire", [(0, 0.02), (3, 4.2)]),
    ("button-off", []),
])  # fmt: skip
def test_stop_button(board, name, pressed):
    quick = DRIVES.replace("sleep_ms(20)", "sleep_ms(2)")
    _, log = board(f"{name}@1", quick, limit_s=1.95 if name == "button-held" else 5.6)
    rows = log.rows()
    down = rows[rows[:, 3] == 0][:, 0] / 1e6 - 1
    periods = np.split(down, np.nonzero(np.diff(down) > 0.015)[0] + 1) if len(down) else []
    assert [(period[0], period[-1]) for period in periods] == [pytest.approx(one, abs=0.016) for one in pressed]


@pytest.mark.parametrize("name, volts", [("battery-off", 0), ("battery-low", 6.4), ("battery-empty", 5.5)])
def test_battery(board, name, volts):
    rows = board(f"{name}@1")[1].rows()
    assert rows[10, 4] * 3 / 1000 == pytest.approx(7.8, abs=0.01)
    assert rows[-1, 4] * 3 / 1000 == pytest.approx(volts, abs=0.01)


def test_battery_empty_and_then_off(board):
    rows = board("battery-latch@1", limit_s=8)[1].rows()
    assert rows[rows[:, 0] > 7_050_000][:, 4].max() == 0
    middle = rows[(rows[:, 0] > 1_050_000) & (rows[:, 0] < 6_950_000)]
    assert middle[:, 4] * 3 / 1000 == pytest.approx(5.5, abs=0.01)


@pytest.mark.parametrize("name, share", [("slip", 0), ("slip-half", 0.5), ("reversed", -1)])
def test_wheels_without_grip(board, name, share):
    result, log = board(f"{name}@1", limit_s=1.7)
    before = [speed for time, speed, _, _ in log.speeds if time < 990_000][-1]
    assert before > 350
    assert log.speeds[-1][1] == pytest.approx(share * before, abs=2)
    assert result.fault.still_ms is None and result.fault.driven_after_s == pytest.approx(0.7, abs=0.03)  # the motors are on all the same


@pytest.mark.parametrize("name, dead", [("side-dead", range(0, 10, 2)), ("motor-dead", [1])])
def test_motors_without_current(board, name, dead):
    _, log = board(f"{name}@1", limit_s=3)
    assert [wheel for wheel in range(10) if abs(log.speeds[-1][2][wheel]) < 1] == list(dead)


@pytest.mark.parametrize("name, dead", [("servos-dead", 4), ("servo-dead", 1)])
def test_servos_that_stay(board, name, dead):
    steers = "i2c.writeto(0x40, bytes([0x06] + [0, 0, 360 & 255, 360 >> 8] * 10)) if time.ticks_us() > 1_100_000 else None\n    "
    _, log = board(f"{name}@1", DRIVES.replace("before =", steers + "before ="))
    degrees = np.degrees(np.abs(log.simulation.body.angles))
    assert (degrees[:dead] < 5).all() and (degrees[dead:] > 15).all()


def test_held(board):
    _, log = board("held@1", limit_s=3)
    body = log.simulation.body
    there = np.searchsorted(body.times[: body.count], 1e6)
    far = np.hypot(*(body.poses[: body.count, :2] - body.poses[there, :2]).T)[there:]
    assert 90 < far.max() < 110 and far[-1] > 90


def test_pushed_and_turned(board):
    _, log = board("pushed@1", STANDS, limit_s=3)
    body = log.simulation.body
    assert np.hypot(*(body.poses[0, :2] - (body.x, body.y))) == pytest.approx(150, abs=1)
    _, log = board("turned@1", STANDS)
    assert np.degrees(log.simulation.body.heading - log.simulation.body.poses[0, 2]) == pytest.approx(20)


STANDS = "import time\nwhile True:\n    time.sleep_ms(10)\n"
# As the robot's link with its parts: a class in a module of that name, made and called by main.py.
PART = """
class Link:
    def update(self, now_us, robot):
        return 7
"""
CALLS = """
import gc, sys, time
sys.path.append("/lib")
from link.link import Link
link = Link()
while True:
    before = time.ticks_us()
    try:
        out = link.update(before, None)
    except Exception as error:
        out = repr(error)
    print("turn", before, time.ticks_diff(time.ticks_us(), before), gc.mem_free() if time.ticks_us() % 7 == 0 else 0, out)
    time.sleep_ms(20)
"""


@pytest.fixture
def part(tmp_path, board):
    """part(fault, ...) runs CALLS; the turns before and after the fault at 1 s: [(us it took, bytes free or 0, what came of it)]."""

    def start(fault, source=CALLS, **settings):
        (tmp_path / "lib" / "link").mkdir(parents=True)
        (tmp_path / "lib" / "link" / "link.py").write_text(PART)
        result, log = board(fault, source, **settings)
        turns = [line.split(" ", 4) for line in log.printed.decode().splitlines() if line.startswith("turn")]
        turns = [(int(turn[1]), (int(turn[2]), int(turn[3]), turn[4].strip())) for turn in turns]
        return [turn for time, turn in turns if time < 1e6], [turn for time, turn in turns if time > 1e6], result, log

    return start


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name, took, out", [
    ("slow", 400_000, "7"), ("slow-150", 150_000, "7"), ("exception-link", 0, "RuntimeError"), ("memory-error", 0, "MemoryError"),
])  # fmt: skip
def test_a_part_fails(part, name, took, out, engine):
    before, after, _, _ = part(f"{name}@1", engine=engine)
    assert {turn[0] for turn in before} == {0} and {turn[2] for turn in before} == {"7"}
    assert after and all(turn[0] == took and turn[2].startswith(out) for turn in after)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_part_hangs(part, engine):
    before, after, result, _ = part("hang-link@1", engine=engine, limit_s=4)
    assert len(before) > 40 and not after
    assert result.time_s == pytest.approx(4, abs=0.01)  # time passes


def test_heap_is_eaten(part):
    before, after, _, _ = part("heap@1", limit_s=6)
    assert min(turn[1] for turn in before if turn[1]) > 100_000
    free = [turn[1] for turn in after if turn[1]]
    assert free and max(free) < 20_000  # the rest are crumbs


WATCHED = """
import machine, time
print("life", machine.reset_cause())
enable = machine.Pin(33, machine.Pin.OUT, value=0)
if machine.reset_cause() == 1:
    watchdog = machine.WDT(timeout=1000)
    for _ in range(10):
        time.sleep_ms(50)
        watchdog.feed()
    while True:
        pass
while True:
    time.sleep_ms(10)
"""


@pytest.mark.parametrize("engine", ENGINES)
def test_the_watchdog_bites_one_that_only_computes(board, engine):
    result, log = board("", WATCHED, engine, limit_s=3)
    assert [line for line in log.printed.decode().splitlines() if "life" in line] == ["life 1", "life 3"]
    assert log.resets == [(pytest.approx(1_500_000, abs=50_000), 3)]  # a second after the last feeding, or the last that the twin was told of
    assert result.fault is None and result.reason == "3 s are over"


def test_without_a_watchdog_it_is_an_endless_loop(board, monkeypatch):
    monkeypatch.setattr(silence, "LIMIT_S", 2.0)
    result, _ = board(
        "", WATCHED.replace("watchdog =", "watchdog = lambda: None; other =").replace("machine.WDT(timeout=1000)", "0").replace("watchdog.feed()", "pass")
    )
    assert result.result == "blocked" and "an endless loop?" in result.reason


RADIO = """
import select, socket, time
from network import WLAN
one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
poller = select.poll()
poller.register(one, select.POLLIN)
while True:
    before, count = time.ticks_us(), 0
    for _ in poller.poll(0):
        data = one.recvfrom(256)[0]
        print("datagram", before, len(data), data[3])
    time.sleep_ms(1)
"""


@pytest.mark.parametrize("name, least, most", [("flood", 290, 310), ("flood-10000", 700, 1000)])  # one a turn of 1.3 ms is all that this one takes
def test_flood(board, name, least, most):
    _, log = board(f"{name}@1", RADIO)
    lines = [line.split() for line in log.printed.decode().splitlines() if line.startswith("datagram")]
    assert least <= len(lines) <= most
    assert all(int(line[1]) >= 995_000 and line[2:] == ["28", str(0x41)] for line in lines)


@pytest.mark.parametrize("name, start", [("clock-29", 1 << 29), ("clock-30", 1 << 30)])
def test_clock(board, name, start):
    result, log = board(name)
    ticks = log.rows()[:, 0]
    assert ticks[0] == pytest.approx(start - 1e6, abs=5e4)
    assert ticks[-1] == pytest.approx((start + 1e6) % (1 << 30), abs=5e4)


@pytest.mark.parametrize("name", ["hang-link", "hang-hard"])
def test_a_hang_is_over_with_the_reset(part, tmp_path, name):
    guarded = CALLS.replace("link = Link()", "import machine\nprint('life', machine.reset_cause())\nlink = Link()\ndog = machine.WDT(timeout=500)")
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "avoid.py").write_text(PART.replace("Link", "Avoid").replace("update(self, now_us, robot)", "step(self, odometry)"))
    if name == "hang-hard":
        guarded = guarded.replace("link.link", "avoid").replace("Link", "Avoid").replace("link.update(before, None)", "link.step(None)")
    _, _, _, log = part(f"{name}@1", guarded.replace("    time.sleep_ms(20)", "    dog.feed()\n    time.sleep_ms(20)"), limit_s=3)
    lines = log.printed.decode().splitlines()
    assert [line for line in lines if line.startswith("life")] == ["life 1", "life 3"]
    assert log.resets == [(pytest.approx(1.5e6, abs=5e4), 3)]
    assert lines[-1].startswith("turn") and int(lines[-1].split()[1]) > 1e6  # of the second life


def test_a_press_and_a_reset(board):
    _, log = board("button-reset@1", limit_s=4)
    assert log.resets == [(pytest.approx(3e6, abs=5e4), 2)]
    rows = log.rows()
    assert rows[rows[:, 3] == 0][:, 0] == pytest.approx(1.15e6, abs=0.17e6)


def test_the_firmware_has_the_parts_that_fail():
    compat.install()
    source = ast.parse((image.BOARD / "fault.py").read_text())
    parts = next(ast.literal_eval(node.value) for node in source.body if isinstance(node, ast.Assign) and node.targets[0].id == "_PARTS")
    assert set(PARTS) <= set(parts)
    for module, owner, method, count in (*parts.values(), ("link.auth", "Signer", "signed", 3)):
        found = getattr(getattr(importlib.import_module(module), owner), method)
        assert len(inspect.signature(found).parameters) == count + 1, f"{module}:{owner}.{method}"


def test_by_itself_it_waits_for_the_motors_and_four_seconds(board):
    result, _ = board("slip", limit_s=5)
    assert result.fault.fault_at_s == pytest.approx(4, abs=0.02)
    result, _ = board("slip", STANDS, limit_s=5)
    assert result.fault == faults.Outcome("slip", None, None, 0, 0.0)


def test_still_is_a_second_without_motors(board):
    def pauses(ms):
        off = f"""    if 1_100_000 < before < 1_130_000:
        enable.value(1)
        time.sleep_ms({ms})
        enable.value(0)
"""
        outcome = board("lidar-dust@1", DRIVES.replace("    time.sleep_ms(20)", off + "    time.sleep_ms(20)"), limit_s=5)[0].fault
        return outcome.still_ms, outcome.driven_after_s

    assert pauses(900) == (None, pytest.approx(3.1, abs=0.05))
    assert pauses(1100) == (pytest.approx(110, abs=25), pytest.approx(2.9, abs=0.05))


def test_contacts_after_the_fault_when_the_firmware_has_ended(board):
    ends = DRIVES.replace("    time.sleep_ms(20)", "    time.sleep_ms(20)\n    if before > 1_200_000:\n        raise ValueError('over')")
    result, _ = board("lidar-dust@1", ends, course="Z")
    assert result.result == "blocked" and "ValueError: over" in result.reason
    assert result.fault.still_ms is None and result.time_s > 5  # the chips drive on, and so the robot


def test_json_and_list(capsys, tmp_path):
    (tmp_path / "main.py").write_text(DRIVES)
    cli.main(["Z", "--fault", "chip-gone@1", "--json", "--no-record", "--firmware", str(tmp_path)])
    out = json.loads(capsys.readouterr().out)
    assert (out["fault"], out["fault_at_s"], out["still_ms"]) == ("chip-gone", pytest.approx(1, abs=0.02), None)
    assert out["touched_after"] == 1 and out["result"] == "blocked"
    assert cli.main(["--fault", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == sorted(faults.KINDS)
    assert all(len(line.split()) > 3 for line in lines)


@pytest.mark.parametrize("text, says", [("nonsense", "is no fault"), ("hang@soon", "seconds"), ("hang@-1", "seconds"), ("hang@", "seconds")])
def test_what_is_no_fault(text, says, capsys):
    with pytest.raises(ValueError, match=says):
        faults.make(text)
    with pytest.raises(SystemExit):
        cli.main(["Z", "--fault", text])
    assert says in capsys.readouterr().err
    with pytest.raises(AddressError, match=says):
        arguments_of("z", {"fault": text})


def test_addresses():
    assert arguments_of("z", {"fault": "hang@6.5"})["fault"] == "hang@6.5"


@pytest.mark.parametrize("name", sorted(faults.KINDS))
def test_each_can_be_made_and_acts_on_something(name):
    fault = faults.make(name)
    changed = {attribute for attribute in ("begin", "go_on", "distort") if getattr(type(fault), attribute) is not getattr(base.Fault, attribute)}
    assert changed or "fault.json" in fault.files or fault.clock_us
    assert base.KINDS[name].module in table.ORDER


def test_the_page_gets_the_table(tmp_path):
    page = tmp_path / "safety.md"
    page.write_text(f"before\n{table.BEGIN}\nold\n{table.END}\nafter\n")
    kinds = faults.KINDS
    rows = [
        table.Row(kinds["hang"], faults.Outcome("hang", 4.0, None, 1, 20.0), "blocked", "held by a wall for 10 s"),
        table.Row(kinds["button-held"], faults.Outcome("button-held", 4.0, 20.0, 0, 0.02), "timeout", "20 s"),
        table.Row(kinds["brown-out"], faults.Outcome("brown-out", 4.0, 0.0, 0, 9.0), "pass", ""),
        table.Row(kinds["flood"], faults.Outcome("flood", 4.0, None, 0, 9.0), "pass", ""),
    ]
    assert [row.kept for row in rows] == [False, True, False, True]
    text = table.markdown(rows)
    assert "**never**" in text and "2 of 4" in text and "**drives on, through the course**" in text
    table.write(text, page)
    assert page.read_text() == f"before\n{table.BEGIN}\n{text}\n{table.END}\nafter\n"
    page.write_text("nothing")
    with pytest.raises(ValueError, match="no place"):
        table.write(text, page)
