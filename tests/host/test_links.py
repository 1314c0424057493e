"""host.link: addresses, messages, the links to the twin, to a recording, over a serial line and over UDP."""

import json
import os
import pty
import select
import shutil
import socket
import struct
import subprocess
import sys
import threading
import time
import tty
from pathlib import Path

import pytest

from host import recording
from host.link import AddressError, LinkError, connect, messages, playback, radio
from host.link import address as addresses
from host.recording import Stream
from link import frames as whole_frames
from link import protocol

from link import auth  # isort: skip

KEY = bytes(range(32))
SESSION = b"12345678"
HELLO = b'{"robot": "gapseeker-0000", "board": "00ff", "firmware": "0.1.0", "full_speed": 1280}'


def hello(counter=0, session=SESSION, tag=b""):
    return whole_frames.frame(protocol.HELLO, struct.pack(protocol.HELLO_FORMAT, session, counter, tag) + HELLO)


@pytest.mark.parametrize(
    "text, expected",
    [
        ("serial:/dev/ttyUSB0", ("serial", "/dev/ttyUSB0", {})),
        ("udp:robot.local:9750", ("udp", "robot.local:9750", {})),
        ("twin:z?width=550&seed=3", ("twin", "z", {"width": "550", "seed": "3"})),
        ("file:what? really.rec", ("file", "what? really.rec", {})),
    ],
)
def test_addresses(text, expected):
    assert addresses.parse(text) == expected


@pytest.mark.parametrize("text", ["", "z", "twin:", "http://robot", "/dev/ttyUSB0"])
def test_what_is_no_address_is_told_what_would_be(text):
    with pytest.raises(AddressError, match="serial:/dev/ttyUSB0"):
        connect(text)


@pytest.mark.parametrize("text, words", [("twin:q", "courses are Z"), ("twin:z?colour=red", "width"), ("twin:z?width=wide", "a number")])
def test_what_the_twin_does_not_know(text, words):
    with pytest.raises(AddressError, match=words):
        connect(text)


def test_a_twin_that_fails_leaves_a_recording_and_one_driven_by_hand_has_time(tmp_path, monkeypatch):
    from host.twin import recorder, simulation

    monkeypatch.setattr(recorder, "OUT", tmp_path)
    monkeypatch.setattr(simulation, "LIMIT_US", 2e6)
    with connect("twin:z?speed=max") as link:
        told = link.wait_for("ended", 20)["text"]
    assert "timeout" in told and "python -m host.replay" in told
    assert str(next(tmp_path.iterdir())) in told
    with connect("twin:z?speed=2") as link:
        link.drive("stop")
        link.wait_for("reply")
        end = time.monotonic() + 2.5
        while time.monotonic() < end:
            message = link.get(1)
            assert message is None or message["type"] != "ended"


@pytest.mark.parametrize("text", ["serial:/dev/no-such-port", "file:/no/such.rec", "udp:localhost:many", "udp:no-such-robot.invalid"])
def test_what_cannot_be_opened(text):
    with pytest.raises(LinkError):
        connect(text)


def test_every_message_of_the_wire_becomes_a_dict():
    decision = struct.pack(protocol.DECISION_FORMAT, 7, 1_500_000, 1, 4, -300, 45, 108, 4, 255, 512, 10, -20, 2, 12345)
    assert messages.decode(protocol.DECISION, decision) == {
        "type": "decision", "number": 7, "time": 1.5, "state": "auto", "mode": 4, "af": -30.0, "ar": 4.5, "v": 108, "window": 4, "zone": None,
        "free": 512, "block": [10, -20], "why": 2, "took": 12.345,
    }  # fmt: skip
    wheels = struct.pack(protocol.WHEELS_FORMAT + "4h4h", 0, 0, 0, 18 * 256, 2, 4, 0, 900, -900, 5, 16384, -16384, 8192, 0)
    assert messages.decode(protocol.WHEELS, wheels)["speeds"] == [256.0, -256.0, 128.0, 0.0]
    points = struct.pack("<IH2h2h2B", 5, 2, 1, -2, 3, -4, 0, 4)
    assert messages.decode(protocol.POINTS, points) == {"type": "points", "time": 5e-6, "x": [1, -2], "y": [3, -4], "window": [0, 4]}
    scan = struct.pack("<IHHB3H", 5, 3550, 50, 3, 4000, 0, 2) + struct.pack("<IHHB1H", 6, 100, 100, 1, 8)
    decoded = messages.decode(protocol.SCAN, scan)
    assert decoded["bearings"] == [355.0, 0.0, 5.0, 10.0] and decoded["distances"] == [1000.0, 0.0, 0.5, 2.0]
    health = struct.pack(protocol.HEALTH_FORMAT, 5000, 60000, 4000, 0, 120, 3, 2, 10, 11, 12, 13, 14)
    decoded = messages.decode(protocol.HEALTH, health)
    assert decoded["battery"] is None and decoded["lidar_ok"] and decoded["chips"] and not decoded["radio"] and decoded["worst"] == 4.0
    pose = messages.decode(protocol.POSE, struct.pack(protocol.POSE_FORMAT, 0, -256, 512, 90000))
    assert (pose["x"], pose["y"], pose["heading"]) == (-1.0, 2.0, 90.0)
    values = (100, 0, -200, 0, 300, 65535)  # two candidates: AF, AR, free; the second was not looked at
    for variant, first in ((0, (10, -20)), (1, (-10, 20)), (2, (20, -10)), (3, (-20, 10))):
        decoded = messages.decode(protocol.CANDIDATES, struct.pack(protocol.CANDIDATES_FORMAT + "4h2H", 0, variant, 1, 2, *values))
        assert (decoded["list"][0]["af"], decoded["list"][0]["ar"]) == first and decoded["backward"] == (variant > 1)
        assert [row["free"] for row in decoded["list"]] == [300, None] and [row["chosen"] for row in decoded["list"]] == [False, True]
    assert messages.decode(protocol.LOG, b"\1low")["text"] == "low"
    reply = messages.decode(protocol.REPLY, struct.pack(protocol.REPLY_FORMAT, 3, protocol.TUNE, protocol.REFUSED) + b"no")
    assert reply == {"type": "reply", "counter": 3, "command": "tune", "status": "refused", "text": "no"}


def test_what_does_not_fit_is_no_message():
    for kind in range(256):
        for payload in (b"", b"\xff", bytes(11), b"\xff" * 40):
            message = messages.decode(kind, payload)
            assert message is None or message["type"], (kind, payload)


@pytest.mark.parametrize("values", [("fly", 0, 0, 90), ("manual", 91, 0, 90), ("manual", 0, 0, 181)])
def test_a_command_that_cannot_be_is_not_sent(values):
    with pytest.raises(ValueError):
        messages.drive(1, *values)


@pytest.fixture
def line():
    """(our end of a serial line, address of the other)."""
    ours, theirs = pty.openpty()
    tty.setraw(ours)
    tty.setraw(theirs)
    yield ours, f"serial:{os.ttyname(theirs)}"
    os.close(ours)
    os.close(theirs)


def test_over_a_serial_line(line):
    ours, address = line
    with connect(address) as link:
        assert whole_frames.decode(os.read(ours, 100))[0][0] == protocol.GREET
        os.write(ours, b"MPY: soft reboot\r\n" + hello())
        assert link.wait_for("text")["text"] == "MPY: soft reboot"
        assert link.wait_for("hello")["robot"] == "gapseeker-0000"
        link.tune("avoid.margin", 20)
        kind, _, payload = whole_frames.decode(os.read(ours, 100))[0]
        assert (kind, payload[4:]) == (protocol.TUNE, b"avoid.margin=20")


def test_an_unplugged_board_ends_the_link():
    ours, theirs = pty.openpty()
    with connect(f"serial:{os.ttyname(theirs)}") as link:
        os.close(ours)
        os.close(theirs)
        assert "connect again" in link.wait_for("ended")["text"]


class RobotSocket:
    """The robot's end of the network, without the robot."""

    session = SESSION

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.settimeout(3)
        self.port = self.socket.getsockname()[1]

    def announce(self, **kw):
        self.socket.sendto(hello(**kw), ("127.0.0.1", self.port + 1))

    def answer(self, counter=0, session=SESSION, key=KEY, nonce=None):
        """Answer the latest greeting as the robot does; or the one with this nonce, word for word as then."""
        plain = struct.pack("<8sI", session, counter)
        tag = auth.Signer(key).digest(nonce or self.nonce, bytes((protocol.VERSION, protocol.HELLO)), plain, HELLO)[:8]
        self.socket.sendto(hello(counter, session, tag), self.peer)

    def receive(self):
        data, self.peer = self.socket.recvfrom(2048)
        ((kind, sequence, payload),) = whole_frames.decode(data)
        if kind == protocol.GREET:
            self.nonce = payload[5:13]
        signed = struct.pack("<BBHH", protocol.VERSION, kind, sequence, len(payload)) + payload[:-8]
        genuine = payload[-8:] == auth.Signer(KEY).tag(self.session, signed)
        return kind, struct.unpack_from("<I", payload)[0], genuine


@pytest.fixture
def robot():
    end = RobotSocket()
    yield end
    end.socket.close()


def test_over_the_network_commands_are_signed_and_counted(robot):
    with radio.RadioLink("udp:", f"127.0.0.1:{robot.port}", key=KEY) as link:
        assert robot.receive() == (protocol.GREET, 1, False)  # asks for the session
        robot.answer(counter=41)
        while not (received := robot.receive())[2]:
            pass
        kind, counter, _ = received
        assert kind == protocol.GREET and counter >= 42
        link.drive("stop")
        while (received := robot.receive())[0] != protocol.DRIVE:
            pass
        assert received[1] > counter and received[2]
        robot.socket.sendto(whole_frames.frame(protocol.LOG, b"\0hi") + bytes(20), robot.peer)
        assert link.wait_for("log")["text"] == "hi"


def received(robot, kind, genuine=True):
    """Counter of the next command of this type that is signed for the robot's session (or is not)."""
    while True:
        got, counter, signed = robot.receive()
        if got == kind and signed == genuine:
            return counter


def test_a_forged_hello_changes_nothing(robot):
    """One with a counter near its end, one of another session, one with another board, one signed with another key, and an old one."""
    with radio.RadioLink("udp:", f"127.0.0.1:{robot.port}", key=KEY) as link:
        robot.receive()
        old = robot.nonce
        robot.answer(counter=41, session=b"before..")
        robot.session = b"before.."
        received(robot, protocol.GREET)
        robot.session = SESSION
        robot.answer(counter=5)
        first = received(robot, protocol.GREET)
        assert first < 20  # the session is new, and so is its counter
        for forged in (hello(2**32 - 2), hello(2**32 - 2, tag=b"guessed!"), hello(5, b"evilevil"), hello().replace(b"00ff", b"00fe")):
            robot.socket.sendto(forged, robot.peer)
        robot.answer(2**32 - 2, key=bytes(32))
        robot.answer(counter=41, session=b"before..", nonce=old)
        time.sleep(0.2)
        link.drive("stop")
        assert first < received(robot, protocol.DRIVE) < 40
        assert link.forged >= 3


def test_a_stop_goes_out_however_far_the_counter_is(robot):
    with radio.RadioLink("udp:", f"127.0.0.1:{robot.port}", key=KEY) as link:
        robot.receive()
        robot.answer(counter=2**32 - 1)
        received(robot, protocol.GREET)
        for _ in range(3):
            link.drive("stop")
            assert received(robot, protocol.DRIVE) == 2**32 - 1


def test_a_stop_is_told_again_to_a_robot_that_has_started_anew(robot):
    with radio.RadioLink("udp:", f"127.0.0.1:{robot.port}", key=KEY) as link:
        robot.receive()
        robot.answer()
        received(robot, protocol.GREET)
        robot.session = b"the next"
        link.drive("stop")
        told = received(robot, protocol.DRIVE, genuine=False)
        robot.receive()
        robot.answer(session=b"the next")
        assert received(robot, protocol.DRIVE) == 1 < told  # counted from the start in the new session


@pytest.mark.parametrize("size", [0, 1, 31, 33])
def test_a_key_that_is_not_whole_is_none(robot, tmp_path, monkeypatch, size):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    path = radio.places.key_path("00ff")
    path.parent.mkdir(parents=True)
    path.write_bytes(bytes(size))
    with radio.RadioLink("udp:", f"127.0.0.1:{robot.port}") as link:
        robot.receive()
        robot.answer(key=bytes(size))
        assert f"no key of 32 bytes, but one of {size}" in link.wait_for("text")["text"]
        link.drive("stop")
        robot.socket.settimeout(0.3)
        with pytest.raises(TimeoutError):
            while robot.receive()[0] == protocol.GREET:
                pass


def test_without_the_key_no_command_is_sent(robot, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    with radio.RadioLink("udp:", f"127.0.0.1:{robot.port}") as link:
        robot.announce()
        assert "no key for gapseeker-0000" in link.wait_for("text")["text"]
        link.drive("auto")
        robot.socket.settimeout(0.5)
        with pytest.raises(TimeoutError):
            while robot.receive()[0] == protocol.GREET:
                pass


def test_robots_are_found_by_what_they_announce(robot):
    from host.link import discover

    threading.Timer(0.2, robot.announce).start()
    found = discover.robots(1.0, robot.port)
    assert [(address, told["firmware"]) for address, told in found] == [(f"udp:127.0.0.1:{robot.port}", "0.1.0")]


@pytest.fixture
def recorded(tmp_path):
    """A recording of three seconds with a decision every tenth."""
    path = tmp_path / "drive.rec"
    header = recording.Header(firmware="1", robot="", source="twin:z?width=600&seed=2", reasons=("one", "two"))
    with recording.Writer(path, header) as writer:
        for k in range(30):
            data = whole_frames.frame(protocol.DECISION, struct.pack(protocol.DECISION_FORMAT, k, k * 100_000, 1, 4, 0, 0, 108, 4, 0, 700, 32767, 0, 1, 5))
            writer.write(Stream.TELEMETRY, k * 100_000, data[:20])
            writer.write(Stream.TELEMETRY, k * 100_000 + 1000, data[20:])
            writer.write(Stream.POSE, k * 100_000, recording.Pose(k, 2 * k, 3).pack())
        writer.event(3_000_000, "pass")
    return path


def test_a_recording_plays_as_it_was(recorded):
    with connect(f"file:{recorded}") as link:
        link.rate = 30
        assert link.wait_for("names")["reasons"] == ["one", "two"]
        assert len(link.wait_for("world")["walls"]) == 7
        assert [link.wait_for("decision")["number"] for _ in range(30)] == list(range(30))
        assert link.wait_for("event")["text"] == "pass"


def test_without_true_poses_no_walls_are_shown(tmp_path):
    """Where the robot thinks it is begins anywhere; between the walls of the course it would stand in one of them."""
    told = whole_frames.frame(protocol.POSE, struct.pack(protocol.POSE_FORMAT, 5, 0, 0, 0))
    for poses in (0, 1):
        path = tmp_path / f"{poses}.rec"
        with recording.Writer(path, recording.Header("1", "", "twin:z?width=550", clock="host")) as writer:
            writer.write(Stream.TELEMETRY, 0, told)
            for _ in range(poses):
                writer.write(Stream.POSE, 10, recording.Pose(750, 0, 0).pack())
        kinds = [message["type"] for _, message in playback.story(recording.Reader(path))]
        assert ("world" in kinds) == ("truth" in kinds) == bool(poses)


def test_a_jump_tells_what_was_so_then(recorded):
    with connect(f"file:{recorded}") as link:
        link.playing = False
        link.seek(1.55)
        assert link.wait_for("jump")
        assert link.wait_for("truth")["x"] == 15
        assert link.wait_for("playback")["position"] == 1.55
        link.seek(99)
        numbers = []
        while (message := link.get(1))["type"] != "playback" or message["position"] != 3.0:
            numbers += [message["number"]] if message["type"] == "decision" else []
        assert numbers[-1] == 29


def test_a_link_counts_what_was_lost(line):
    ours, address = line
    with connect(address) as link:
        os.write(ours, hello())
        link.wait_for("hello")
        os.write(ours, whole_frames.frame(protocol.LOG, b"\0a", 1) + whole_frames.frame(protocol.LOG, b"\0b", 5))
        link.wait_for("log"), link.wait_for("log")
        assert link.lost == 3


@pytest.fixture
def radio_robot():
    """(process, port) of the firmware's link in MicroPython, on this computer's network."""
    beside = Path(sys.executable).parent / "micropython"
    program = str(beside) if beside.exists() else shutil.which("micropython")
    if program is None:
        pytest.skip("left out: the firmware's own radio link; to get it: make setup")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    here = Path(__file__).resolve().parent
    library = here.parents[1] / "firmware" / "lib"
    process = subprocess.Popen([program, str(here / "radio_robot.py"), str(library), str(port)], stdout=subprocess.PIPE, text=True)
    yield process, port
    process.kill()
    process.wait()


def test_the_firmware_s_own_radio_link(radio_robot):
    process, port = radio_robot
    with radio.RadioLink("udp:", f"127.0.0.1:{port}", key=KEY) as link:
        assert process.stdout.readline().endswith("1\n")  # drives itself
        assert link.wait_for("hello")["robot"] == "gapseeker-0000"
        assert link.wait_for("wheels")  # it sends to us by now
        link.drive("manual", v=100)
        began, manual = map(int, process.stdout.readline().split())
        ended, stopped = map(int, process.stdout.readline().split())  # nobody goes on driving by hand
        assert (manual, stopped) == (2, 0) and ended - began < 300_000
        link.drive("auto")
        assert process.stdout.readline().endswith("1\n")


def test_the_firmware_takes_no_orders_from_strangers(radio_robot):
    process, port = radio_robot
    heard = []
    with radio.RadioLink("udp:", f"127.0.0.1:{port}", key=KEY) as link:
        process.stdout.readline()
        link.wait_for("wheels")
        link.taps.append(lambda direction, data: heard.append(data) if direction == "out" else None)
        link.drive("stop")
        assert process.stdout.readline().endswith("0\n")
        link.drive("auto")
        assert process.stdout.readline().endswith("1\n")
        link.drive("stop")
        assert process.stdout.readline().endswith("0\n")
    go = [data for data in heard if data[3] == protocol.DRIVE][1]
    other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with other, radio.RadioLink("udp:", f"127.0.0.1:{port}", key=bytes(32)) as stranger:
        stranger.wait_for("hello")
        for _ in range(20):
            stranger.drive("auto")
            other.sendto(go, ("127.0.0.1", port))  # what was said before, word for word
            time.sleep(0.01)
    assert not select.select([process.stdout], [], [], 0.3)[0]


def test_what_moves_in_the_twin_is_told_where_it_is(tmp_path):
    world = tmp_path / "street.json"
    mover = {"size": [300, 200], "path": [[0, -1000, 3000], [20, 1000, 3000]]}
    world.write_text(json.dumps({"segments": [[-1500, -800, 1500, -800], [-1500, -800, -1500, 4000]], "start": [0, 0, 0], "moving": [mover]}))
    with connect(f"twin:{world}?speed=4") as link:
        first, later = link.wait_for("moving"), None
        while (later := link.wait_for("moving")) and later["walls"] == first["walls"]:
            pass
    assert len(first["walls"]) == len(later["walls"]) == 4
    assert [y for _, y, _, _ in first["walls"]] == [y for _, y, _, _ in later["walls"]] and first["walls"][0][0] < later["walls"][0][0]


def test_a_box_or_a_pace_that_cannot_be_is_refused():
    nan = float("nan")
    with connect("twin:z?width=620", begin=False) as link:
        for box in ((nan, 0, 200), (0, -nan, 200), (1e9, 0, 200), (0, 0, 20), (0, 0, nan)):
            with pytest.raises(ValueError, match="a box"):
                link.put_box(*box)
        for speed in (nan, 0, -1, 1e9):
            with pytest.raises(ValueError, match="times real time"):
                link.set_pace(speed)


def test_the_house_with_its_map_is_a_twin_s_address_too():
    with pytest.raises(AddressError, match="twin option 'door'"):
        connect("twin:z?door=shut", begin=False)
    with connect("twin:house?errand=0&speed=max") as link:
        drawn, told = link.wait_for("map", 30), link.wait_for("goal", 10)
        assert drawn["rows"] == drawn["cols"] == 30 and len(drawn["doors"]) >= 1 and told["state"] == "none"
        link.go("there", 7150, 5005)
        while told["state"] == "none":
            told = link.wait_for("goal", 10)
        assert told["goal"] == [7150, 5005]
