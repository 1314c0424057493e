"""A recording run through the firmware again gives the same bytes; what differs is found and named."""

import shutil

import pytest

from host.link import messages
from host.recording import Decision, Header, Reader, Stream, Writer
from host.replay import __main__ as command_line
from host.replay import compare, table
from host.replay.tape import Log
from host.twin import Observer, cli, image, recorder, run
from link import frames as whole_frames
from link import protocol

SECONDS = 6

# Writes into a register what it sees of everything it can see, so that any difference shows
PROGRAM = """
import select, sys, time
import machine

i2c = machine.I2C(0, scl=machine.Pin(22), sda=machine.Pin(21), freq=400000)
uart = machine.UART(2, baudrate=230400, rx=16, rxbuf=4096)
motor = machine.PWM(machine.Pin(27), freq=20000, duty_u16=40000)
stop = machine.Pin(32, machine.Pin.IN, machine.Pin.PULL_UP)
battery = machine.ADC(machine.Pin(35))
poll = select.poll()
poll.register(sys.stdin, select.POLLIN)
buffer = bytearray(300)
seen = heard = 0
while True:
    count = uart.readinto(buffer) or 0
    for i in range(count):
        seen = (seen * 31 + buffer[i]) & 0xFFFF
    if poll.poll(0):
        heard = (heard + sys.stdin.buffer.read(1)[0]) & 255
    try:
        prescale = i2c.readfrom_mem(0x41, 0xFE, 1)[0]
    except OSError:
        prescale = 1
    i2c.writeto_mem(0x40, 6, bytes([seen & 255, seen >> 8, count & 255, heard, stop.value(), prescale, battery.read_u16() >> 8]))
    time.sleep_ms(3)
"""


class Meddler(Observer):
    """Does everything that may be done to a robot from outside."""

    def __init__(self):
        self._now = 0

    def step(self, simulation):
        self._now = simulation.now
        electronics = simulation.electronics
        electronics.stop_pressed = 600_000 < self._now < 900_000
        electronics.battery_volts = 7.0 if self._now > 1_000_000 else 7.8
        if self._now > 1_100_000 and 0x41 in electronics.chips:
            electronics.chips[0x41].registers[0xFE] = 77
        if self._now > 1_300_000:
            electronics.chips.pop(0x41, None)

    def commands(self):
        return b"\x05" if 500_000 < self._now < 700_000 else b""


class Hand(Observer):
    """Drives by hand for a while, tunes, then lets the robot drive itself."""

    def __init__(self):
        self._now = 0
        self._next = 500_000
        self._sent = 0

    def step(self, simulation):
        self._now = simulation.now

    def commands(self):
        if self._now < self._next:
            return b""
        self._next += 100_000
        self._sent += 1
        if self._sent < 20:
            return whole_frames.frame(protocol.DRIVE, messages.drive(self._sent, "manual", 20, -20, 108))
        if self._sent == 20:
            return whole_frames.frame(protocol.TUNE, messages.tune(self._sent, "avoid.margin", 19))
        return whole_frames.frame(protocol.DRIVE, messages.drive(self._sent, "auto"))


@pytest.fixture(scope="module")
def firmware(tmp_path_factory):
    """A copy of the firmware, and the recording of its first seconds."""
    folder = tmp_path_factory.mktemp("firmware") / "firmware"
    shutil.copytree(image.FIRMWARE, folder)
    run("Z", 600, firmware=folder, limit_s=SECONDS, record=folder / "run.rec")
    return folder


@pytest.fixture
def recording(firmware):
    return firmware / "run.rec"


def replay(firmware, *arguments):
    return command_line.main([*map(str, arguments), "--firmware", str(firmware)])


@pytest.mark.parametrize("engine", ["micropython", "cpython"])
def test_the_firmware_decides_the_same_again(firmware, recording, engine, capsys):
    assert replay(firmware, recording, "--engine", engine) == 0
    printed = capsys.readouterr().out
    assert printed.count("all the same") == 2 and "differ" not in printed
    assert int(printed.split(" decisions compared")[0].split()[-1]) > 20


def test_everything_from_outside_is_replayed(tmp_path, capsys):
    (tmp_path / "main.py").write_text(PROGRAM)
    path = tmp_path / "a.rec"
    run("Z", 600, config={}, firmware=tmp_path, limit_s=1.5, record=path, watch=Meddler())
    last = [record.data[2:] for record in Reader(path).stream(Stream.REGISTERS) if record.data[:2] == b"\x40\x06"][-1]
    assert last[3] > 5 and last[5] == 1  # commands were heard, the lost chip was noticed
    assert replay(tmp_path, path) == 0
    assert replay(tmp_path, path, "--engine", "cpython") == 0


def test_driving_by_hand_is_replayed(firmware, tmp_path, capsys):
    path = tmp_path / "hand.rec"
    run("Z", 600, firmware=firmware, limit_s=SECONDS, record=path, watch=Hand())
    decisions = [Decision.unpack(record.data) for record in Reader(path).stream(Stream.DECISION)]
    assert {decision.af for decision in decisions} > {200}
    assert replay(firmware, path) == 0, capsys.readouterr().out


def test_a_cut_file_is_replayed_up_to_the_cut(firmware, recording, tmp_path, capsys):
    cut = tmp_path / "cut.rec"
    cut.write_bytes(recording.read_bytes()[: recording.stat().st_size * 3 // 4])
    assert replay(firmware, cut) == 0
    assert "cut off at byte" in capsys.readouterr().out


def test_a_damaged_file_is_replayed_up_to_the_damage(firmware, recording, tmp_path, capsys):
    whole = recording.read_bytes()
    at = len(whole) * 3 // 4
    (tmp_path / "bad.rec").write_bytes(whole[:at] + bytes(40) + whole[at + 40 :])
    assert replay(firmware, tmp_path / "bad.rec") == 0
    told = capsys.readouterr().out
    assert "damaged at byte" in told and "decisions compared: all the same" in told


def test_where_nothing_is_compared_nothing_is_the_same(firmware, recording, tmp_path, capsys):
    """Cut off before the first decision, after the first writes."""
    reader = Reader(recording)
    with Writer(tmp_path / "short.rec", reader.header) as writer:
        for time, stream, data in reader:
            if stream == Stream.DECISION:
                break
            writer.write(stream, time, data)
    (tmp_path / "short.rec").write_bytes((tmp_path / "short.rec").read_bytes()[:-5])
    assert replay(firmware, tmp_path / "short.rec") == 2
    told = capsys.readouterr().out
    assert "nothing was compared" in told and "all the same" not in told


def test_other_settings_show_what_would_have_changed(firmware, recording, capsys):
    assert replay(firmware, recording, "--set", "drive.cruise=100", "--rows", "2") == 1
    printed = capsys.readouterr().out
    assert "V 108" in printed and "V 100" in printed
    assert "more (--rows N shows N)" in printed
    assert "drive it in the twin" in printed


@pytest.mark.parametrize(
    "change, told",
    [("drive.cruise=1000", "drive.cruise = 1000"), ("drive.crews=3", "unknown key drive.crews"), ("cruise", "section.key=value")],
)
def test_settings_that_cannot_be(firmware, recording, change, told, capsys):
    assert replay(firmware, recording, "--set", change) == 2
    assert told in capsys.readouterr().err


def test_one_wrong_byte_is_found(firmware, recording, tmp_path, capsys):
    reader = Reader(recording)
    changed = tmp_path / "changed.rec"
    spoilt = None
    with Writer(changed, reader.header) as writer:
        for time, stream, data in reader:
            if spoilt is None and stream == Stream.REGISTERS and len(data) > 40 and time > 2_000_000:
                spoilt = data[0], data[1] + 10, data[12]
                data = data[:12] + bytes((data[12] ^ 0x10,)) + data[13:]
            writer.write(stream, time, data)
    assert replay(firmware, changed) == 1
    printed = capsys.readouterr().out
    assert "1 differ" in printed
    chip, register, value = spoilt
    assert f"chip 0x{chip:02x}, register 0x{register:02x}: then {value ^ 0x10:02x}, now {value:02x}" in printed


def test_another_firmware_is_named(firmware, recording, tmp_path, capsys):
    other = tmp_path / "other"
    shutil.copytree(firmware, other)
    with open(other / "main.py", "a") as file:
        file.write("\n# changed\n")
    assert replay(other, recording) == 0
    assert "differences are to be expected" in capsys.readouterr().out


def test_a_recording_of_a_link_cannot_be_replayed(firmware, tmp_path, capsys):
    path = tmp_path / "link.rec"
    Writer(path, Header("1", "{}", "udp:robot.local", clock="host")).close()
    assert replay(firmware, path) == 2
    assert "without the lidar's bytes" in capsys.readouterr().err


def test_an_empty_recording_is_told(firmware, tmp_path, capsys):
    path = tmp_path / "empty.rec"
    Writer(path, Header("1", "{}", "twin:z")).close()
    assert replay(firmware, path) == 2
    assert "nothing to compare" in capsys.readouterr().err


# --- what a run leaves behind


@pytest.fixture
def out(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder, "OUT", tmp_path / "out")
    return tmp_path / "out"


def test_a_run_that_ends_badly_leaves_a_recording(tmp_path, out, capsys):
    (tmp_path / "main.py").write_text("import machine, time\nmachine.PWM(27, duty_u16=40000)\ntime.sleep(1)\nraise RuntimeError('wheel fell off')\n")
    assert cli.main(["Z", "--firmware", str(tmp_path), "--json"]) == 1
    (path,) = out.iterdir()
    assert f"python -m host.replay {path}" in capsys.readouterr().err
    events = [record.data.decode() for record in Reader(path).stream(Stream.EVENT)]
    assert "wheel fell off" in events[-1]


def test_a_run_that_is_not_to_be_recorded_leaves_nothing(tmp_path, out):
    (tmp_path / "main.py").write_text("")
    run("Z", 600, config={}, firmware=tmp_path, record=False)
    assert not out.exists()


def test_an_existing_recording_is_not_overwritten(tmp_path, capsys):
    path = tmp_path / "a.rec"
    path.write_bytes(b"precious")
    (tmp_path / "main.py").write_text("")
    assert cli.main(["Z", "--firmware", str(tmp_path), "--record", str(path)]) == 2
    assert path.read_bytes() == b"precious"
    assert "exists already" in capsys.readouterr().err


# --- the comparison itself


def decision(number, af=0, why=0):
    return Decision(number, af, 0, 108, 7, 4, 255, 700, 32767, 32767, why)


def test_decisions_by_number():
    then = Log([(10, decision(1)), (20, decision(2)), (40, decision(4)), (50, decision(5))])
    now = Log([(11, decision(1)), (29, decision(3)), (41, decision(4, af=10))])
    comparison = compare.decisions_by_number(then, now)
    # 2 fell between two moments of reading; 5 never came
    assert comparison.compared == 3
    assert comparison.differences == [
        compare.Difference(40, decision(4), decision(4, af=10)),
        compare.Difference(50, decision(5), None),
    ]


def test_decisions_by_time():
    then = Log([(10, decision(1)), (20, decision(2, af=10)), (30, decision(3))], [(40, 0x40, b"\x06")])
    now = Log([(11, decision(1)), (21, decision(2)), (25, decision(3, af=10)), (31, decision(4))])
    assert compare.decisions_by_time(then, now).differences == []
    now = Log([(16, decision(1))])
    assert [d.now for d in compare.decisions_by_time(then, now).differences] == [None, decision(1)]


def test_writes():
    then = Log([], [(10, 0x40, b"\x06\x01\x02"), (20, 0x40, b"\x06"), (30, 0x41, b"\x00\x01")])
    now = Log([], [(10, 0x40, b"\x06\x01\x03"), (20, 0x40, b"\x06"), (31, 0x41, b"\x00\x01")])
    first, last = compare.writes(then, now).differences
    assert table.write(first) == "at 0.000010 s: chip 0x40, register 0x07: then 02, now 03"
    assert table.write(last) == "at 0.000030 s: then 1 bytes to chip 0x41 from register 0x00 on; now nothing"
