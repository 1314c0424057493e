"""host.monitor without a browser: the station, the server and its key, the terminal."""

import asyncio
import base64
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path
from types import SimpleNamespace

import pytest

from host import recording
from host.link import parse
from host.link.base import Link
from host.monitor import text
from host.monitor.server import Server
from host.monitor.station import Station
from host.recording import Stream
from link import frames as whole_frames
from link import protocol


class Bench(Link):
    """A link to nowhere: remembers what is sent, receives what the test gives."""

    def __init__(self, address, begin=True):
        super().__init__(address)
        self.sent = []

    def _send(self, data):
        ((kind, _, payload),) = whole_frames.decode(data)
        self.sent.append((kind, payload))

    def hear(self, data):
        """Bytes from the robot."""
        self._receive(data)

    def tell(self, message):
        """A message that comes from elsewhere, as the twin's truth does."""
        self._put(message)

    def end(self, why):
        """No more messages."""
        self._end(why)

    def drives(self):
        """(what, AF, AR, V) of each DRIVE that was sent."""
        return [struct.unpack(protocol.DRIVE_FORMAT, payload)[1:] for kind, payload in self.sent if kind == protocol.DRIVE]


def decision(number, state=1):
    packed = struct.pack(protocol.DECISION_FORMAT, number, number * 100_000, state, 1, -300, 100, 108, 2, 3, 512, 125, 90, 1, 9000)
    return whole_frames.frame(protocol.DECISION, packed, number)


ROOT = Path(__file__).resolve().parents[2]
NAMES = whole_frames.frame(protocol.NAMES, b'{"reasons": ["waiting", "steering through the gap"], "faults": ["well", "lidar is silent"]}')


@pytest.fixture
def station(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("host.monitor.station.connect", Bench)
    station = Station("serial:/dev/bench")
    yield station
    station.close()


@pytest.fixture
def server(station):
    """A server in a thread."""
    server = Server(station)
    loop = asyncio.new_event_loop()

    def serve():
        asyncio.set_event_loop(loop)
        task = loop.create_task(server.run())
        try:
            loop.run_forever()
        finally:
            task.cancel()
            loop.run_until_complete(asyncio.gather(task, return_exceptions=True))

    thread = threading.Thread(target=serve)
    thread.start()
    yield server
    loop.call_soon_threadsafe(loop.stop)
    thread.join()
    loop.close()


class Page:
    """A page's end of the WebSocket."""

    def __init__(self, server, key=None, host=None, origin=None):
        self.socket = socket.create_connection(("127.0.0.1", server.port), timeout=3)
        nonce = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /live?key={server.key if key is None else key} HTTP/1.1\r\nHost: {host or f'127.0.0.1:{server.port}'}\r\n{f'Origin: {origin}' + chr(13) + chr(10) if origin else ''}Upgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Key: {nonce}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        self.file = self.socket.makefile("rb")
        self.status = int(self.file.readline().split()[1])
        while self.status == 101 and self.file.readline() != b"\r\n":
            pass
        self.waiting = []

    def send(self, command):
        data = json.dumps(command).encode()
        assert len(data) < 126
        self.socket.sendall(bytes([0x81, 0x80 | len(data)]) + bytes(4) + data)

    def get(self, kind):
        """The next message of a type."""
        while True:
            while self.waiting:
                message = self.waiting.pop(0)
                if message["type"] == kind:
                    return message
            size = self.file.read(2)[1]
            if size == 126:
                size = int.from_bytes(self.file.read(2), "big")
            self.waiting += json.loads(self.file.read(size))

    def close(self):
        self.file.close()
        self.socket.close()


def until(condition, seconds=20.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.01)
    return False


def test_the_page_and_its_parts_are_served(server):
    for name, kind in (("", "text/html"), ("main.js", "text/javascript"), ("style.css", "text/css")):
        with urllib.request.urlopen(f"http://127.0.0.1:{server.port}/{name}", timeout=3) as answer:
            assert answer.headers["Content-Type"].startswith(kind) and len(answer.read()) > 500


@pytest.mark.parametrize("path", ["/server.py", "/../server.py", "/%2e%2e/server.py", "/page/../../cli.py", "//etc/passwd"])
def test_nothing_else_is_served(server, path):
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(f"http://127.0.0.1:{server.port}{path}", timeout=3)
    assert refused.value.code == 404


@pytest.mark.parametrize("key", ["", "guess"])
def test_without_the_key_nobody_drives(server, key):
    page = Page(server, key)
    assert page.status == 403
    page.close()


def test_other_names_and_other_pages_are_refused(server):
    """A name of somebody else's that leads here (DNS rebinding), and a page from elsewhere in the same browser, even with the key."""
    here = f"127.0.0.1:{server.port}"
    for host, origin, status in ((here, f"http://{here}", 101), (here, None, 101), ("evil.example", None, 403), (f"evil.example:{server.port}", None, 403),
                                 (here, "http://evil.example", 403), (here, "null", 403), (here, f"https://{here}", 403)):  # fmt: skip
        page = Page(server, host=host, origin=origin)
        assert page.status == status, (host, origin)
        page.close()
    request = urllib.request.Request(f"http://{here}/", headers={"Host": "evil.example"})
    with pytest.raises(urllib.error.HTTPError) as refused:
        urllib.request.urlopen(request, timeout=3)
    assert refused.value.code == 403


@pytest.mark.parametrize("path", ["/tmp/x.rec", "../x.rec", "out/../../x.rec", "out/x.py", "x", "out", "~/x.rec", ".rec/../../x.rec"])
def test_a_page_records_into_its_folder_only(station, path, tmp_path):
    with pytest.raises(ValueError, match="out"):
        station.command({"do": "record", "path": path}) if path != "~/x.rec" else station.command({"do": "record", "path": "/root/x.rec"})
    with pytest.raises(ValueError, match="out"):
        station.command({"do": "open", "address": f"file:{path}"}) if path != "~/x.rec" else station.command({"do": "open", "address": "file:/etc/x.rec"})
    assert station.recording is None and station.address == "serial:/dev/bench"


def test_a_page_records_under_a_name_of_its_choice(station, tmp_path):
    station.command({"do": "record", "path": "deep/drive.rec"})
    assert station.recording == "out/deep/drive.rec"
    station.stop_recording()
    station.command({"do": "open", "address": "file:deep/drive.rec"})
    assert station.address == "file:out/deep/drive.rec"


@pytest.mark.parametrize("option", ["firmware=/tmp/evil", "config=/etc/passwd", "record=/tmp/x.rec", "engine=cpython"])
def test_a_page_chooses_the_course_but_no_code_and_no_files(station, option):
    with pytest.raises(ValueError, match="command line only"):
        station.command({"do": "open", "address": f"twin:z?width=550&{option}"})
    station.command({"do": "open", "address": "twin:z?width=550&seed=3"})
    assert station.address == "twin:z?width=550&seed=3"


def test_what_was_given_on_the_command_line_may_be_opened_again(monkeypatch, tmp_path):
    monkeypatch.setattr("host.monitor.station.connect", Bench)
    station = Station("twin:z?config=/home/me/robot.json")
    station.command({"do": "open", "address": "twin:z"})
    station.command({"do": "open", "address": "twin:z?config=/home/me/robot.json"})
    assert station.address == "twin:z?config=/home/me/robot.json"
    station.close()


def test_a_recording_of_a_link_carries_what_the_robot_told_of_itself(station):
    told = b'{"firmware": "0.1.0", "robot": "gapseeker-1", "board": "00ff", "width": 260, "length": 700, "track": 230, "spacings": [115, 150]}'
    station.link.hear(whole_frames.frame(protocol.HELLO, struct.pack(protocol.HELLO_FORMAT, b"11111111", 0, b"") + told))
    for key, value in (("avoid.margin", b"20"), ("servos.trims.0", b"1.5"), ("servos.trims.1", b"-2")):
        station.link.hear(whole_frames.frame(protocol.PARAMETER, b'{"key": "%s", "value": %s}' % (key.encode(), value)))
    assert until(lambda: len(station.known()) == 5)
    station.command({"do": "record"})
    station.link.tell({"type": "truth", "x": 750.0, "y": 20.0, "heading": 90.0})
    path = station.recording
    assert until(lambda: [message for message in station.known() if message["type"] == "truth"])
    station.stop_recording()
    reader = recording.Reader(path)
    assert json.loads(reader.header.robot) == {
        "robot": {"width": 260, "length": 700}, "axles": {"track": 230, "spacings": [115, 150]}, "avoid": {"margin": 20}, "servos": {"trims": [1.5, -2]},
    }  # fmt: skip
    (pose,) = reader.stream(Stream.POSE)
    assert recording.Pose.unpack(pose.data) == (750, 20, 90)


def test_raw_scans_are_recorded_on_request(station):
    station.command({"do": "record"})
    assert protocol.WATCH not in [kind for kind, _ in station.link.sent]
    station.command({"do": "record", "path": "scans.rec", "scans": True})
    assert [payload[4] for kind, payload in station.link.sent if kind == protocol.WATCH] == [1]


def test_a_full_disk_ends_the_recording_and_not_the_link(station, monkeypatch):
    station.command({"do": "record"})
    heard = []
    station.listeners.append(heard.append)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(recording.Writer, "write", full)
    station.link.hear(decision(5))
    assert station.recording is None
    assert any("No space left" in message.get("text", "") for message in heard)
    assert until(lambda: any(message["type"] == "decision" for message in heard))


def test_messages_reach_the_page_and_late_pages_too(server, station):
    station.link.hear(NAMES + decision(5))
    page = Page(server)
    assert page.get("connected")["address"] == "serial:/dev/bench"
    assert page.get("names")["reasons"][1] == "steering through the gap"
    assert page.get("decision")["number"] == 5
    station.link.hear(decision(6))
    assert page.get("decision")["number"] == 6
    page.close()


def test_commands_reach_the_robot(server, station):
    page = Page(server)
    page.send({"do": "drive", "what": "manual", "af": -30, "ar": 12.5, "v": 100})
    page.send({"do": "tune", "key": "avoid.margin", "value": 20})
    page.send({"do": "point", "wheel": 3, "angle": -4})
    page.send({"do": "drive", "what": "auto"})
    page.send({"do": "restart"})
    assert until(lambda: len(station.link.sent) >= 7)  # LIST and GREET came first
    assert station.link.drives() == [(protocol.MANUAL, -300, 125, 100), (protocol.AUTO, 0, 0, 90)]
    kinds = [kind for kind, _ in station.link.sent]
    assert kinds == [protocol.LIST, protocol.GREET, protocol.DRIVE, protocol.TUNE, protocol.POINT, protocol.DRIVE, protocol.RESTART]
    page.close()


@pytest.mark.parametrize(
    "command", [{"do": "drive"}, {"do": "drive", "what": "manual", "af": "x"}, {"do": "fly"}, {"do": "drive", "what": "manual", "v": 999}, {}, {"do": "play"}]
)
def test_what_cannot_be_done_is_said(server, station, command):
    page = Page(server)
    page.send(command)
    assert page.get("refused")["text"]
    assert station.link.drives() == []
    page.close()


def test_a_closed_page_stops_a_robot_driven_by_hand(server, station):
    page = Page(server)
    page.send({"do": "drive", "what": "manual", "v": 100})
    assert until(lambda: station.link.drives())
    page.close()
    assert until(lambda: station.link.drives()[-1][0] == protocol.STOPPED, 1.0)


def test_a_closed_page_leaves_a_robot_alone_that_drives_itself(server, station):
    page = Page(server)
    page.send({"do": "drive", "what": "auto"})
    assert until(lambda: station.link.drives())
    page.close()
    time.sleep(0.2)
    assert station.link.drives() == [(protocol.AUTO, 0, 0, 90)]


def test_what_goes_over_the_link_is_recorded(server, station):
    station.link.hear(NAMES)
    page = Page(server)
    page.get("names")
    page.send({"do": "record"})
    path = page.get("recording")["path"]
    station.link.hear(decision(5))
    page.send({"do": "drive", "what": "stop"})
    assert until(lambda: station.link.drives())
    page.send({"do": "end_recording"})
    assert page.get("recording")["path"] is None
    page.close()
    reader = recording.Reader(path)
    assert reader.header.reasons == ("waiting", "steering through the gap") and reader.header.clock == "host"
    assert [record.data for record in reader.stream(Stream.TELEMETRY)] == [decision(5)]
    assert [whole_frames.decode(record.data)[0][0] for record in reader.stream(Stream.COMMAND)] == [protocol.DRIVE]
    assert reader.cut is None


def test_another_robot_can_be_opened(server, station):
    page = Page(server)
    page.get("connected")
    page.send({"do": "open", "address": "serial:/dev/other"})
    assert page.get("connected")["address"] == "serial:/dev/other"
    page.close()


def test_the_port_is_said_to_be_taken(server, capsys, monkeypatch):
    from host.monitor import cli

    monkeypatch.setattr("host.monitor.station.connect", Bench)
    assert cli.main(["serial:/dev/bench", "--no-browser", "--port", str(server.port)]) == 1
    assert "another with --port" in capsys.readouterr().err


def test_bad_arguments(capsys):
    from host.monitor import cli

    assert cli.main(["robot"]) == 2 and "serial:" in capsys.readouterr().err
    for address, says in (("twin:q", "courses are"), ("twin:z?width=20", "260 to 3000"), ("twin:z?speed=0", "0.01 to 1000"), ("twin:z?engine=x", "engines are"),
                          ("twin:z?config=/no/robot.json", "cannot be read"), ("file:/no/drive.rec", "cannot read")):  # fmt: skip
        assert cli.main([address, "--no-browser"]) == 2, address
        out, error = capsys.readouterr()
        assert says in error and not out, address  # no page was served
    assert cli.main(["serial:/dev/no-such-port"]) == 1 and "plugged in" in capsys.readouterr().err


def test_without_a_robot_the_twin_is_offered(monkeypatch, capsys):
    from host.link import discover
    from host.monitor import cli

    monkeypatch.setattr(discover, "boards", list)
    monkeypatch.setattr(discover, "robots", list)
    assert cli.main([]) == 1 and "python -m host.monitor 'twin:z" in capsys.readouterr().err
    monkeypatch.setattr(discover, "robots", lambda: [("udp:10.0.0.7", {})])
    assert cli.find() == "udp:10.0.0.7"
    monkeypatch.setattr(discover, "boards", lambda: ["serial:/dev/ttyUSB0"])
    assert cli.find() == "serial:/dev/ttyUSB0"


LATEST = {
    "hello": {"width": 250, "length": 600},
    "names": {"reasons": ["waiting", "steering through the gap"], "faults": ["well", "lidar is silent"]},
    "decision": {"time": 1.5, "state": "auto", "af": -30.0, "ar": 10.0, "v": 108, "free": 512, "why": 1, "window": 2, "zone": 3, "block": [125, 90]},
    "points": {"x": [200, -300], "y": [400, 0], "window": [4, 0]},
    "wheels": {"angles": [-12.3, 4.0], "speeds": [256.0, -3.0]},
    "health": {"fault": 0, "battery": 7.4, "lidar_speed": 6.6, "lidar_ok": True},
}


def test_terminal_shows_map_figures_and_reason():
    screen = "\n".join(text.picture(LATEST, ["battery low"]))
    for part in ("AF -30.0", "free  512", "steering through the gap (red, zone 3)", "X", "Y", "^", "battery low", "space stop", "-12", "7.4 V"):
        assert part in screen, part


def test_terminal_tells_faults_and_states():
    assert text.reason({**LATEST, "health": {**LATEST["health"], "fault": 1}}) == "lidar is silent"
    assert text.reason({**LATEST, "decision": {**LATEST["decision"], "state": "waiting", "why": 0}}) == "waiting"  # and no zone
    assert text.line({}) == "waiting for the robot"


def test_terminal_keys_drive(station):
    for key, mode in ((" ", "1"), ("a", "1"), ("\x1b[A", "1"), ("\x1b[D", "1"), ("\x1b[C", "4"), ("\x1b[C", "5"), ("x", "1")):
        text.obey(station, key, mode)
    assert station.link.drives() == [
        (protocol.STOPPED, 0, 0, 90), (protocol.AUTO, 0, 0, 90), (protocol.MANUAL, 0, 0, 105), (protocol.MANUAL, -600, 600, 90),
        (protocol.MANUAL, 900, -900, 105), (protocol.MANUAL, 900, 900, 105),
    ]  # fmt: skip


def hello(session):
    told = b'{"firmware": "0.1.0", "robot": "gapseeker-1", "board": "00ff", "boot": "restart"}'
    return whole_frames.frame(protocol.HELLO, struct.pack(protocol.HELLO_FORMAT, session, 0, b"") + told)


def test_a_robot_that_has_started_anew_is_asked_again(station):
    link = station.link
    link.hear(hello(b"11111111") + NAMES + whole_frames.frame(protocol.PARAMETER, b'{"key": "avoid.margin", "value": 20, "of": 1}'))
    assert until(lambda: len(station.known()) == 4)
    asked = len(link.sent)
    link.hear(hello(b"22222222"))
    assert until(lambda: protocol.LIST in [kind for kind, _ in link.sent[asked:]])
    assert "parameter" not in [message["type"] for message in station.known()]
    link.hear(hello(b"22222222"))
    assert [kind for kind, _ in link.sent[asked:]].count(protocol.LIST) == 1


def test_the_twin_waits_for_the_first_who_looks(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    station = Station("twin:z?width=620&speed=max")
    time.sleep(0.5)
    assert [message["type"] for message in station.known()] == ["connected"]
    heard = []
    station.listen(heard.append)
    assert until(lambda: any(message["type"] == "truth" for message in heard), 20)
    assert next(message for message in heard if message["type"] == "truth")["time"] < 0.5  # from the beginning
    station.close()


def test_by_hand_a_run_never_ends(monkeypatch, tmp_path):
    """The wall that holds it for 10 s, the end of the course and the 60 s are for a robot that drives itself."""
    monkeypatch.chdir(tmp_path)
    station = Station("twin:random?gap=1500&speed=max")
    heard = []
    station.listen(heard.append)
    end = time.monotonic() + 40

    def latest():
        return next((message["time"] for message in reversed(heard) if message["type"] == "truth"), 0)

    while latest() < 65 and time.monotonic() < end:
        station.command({"do": "drive", "what": "manual", "v": 110})
        time.sleep(0.002)
    truth = [message for message in heard if message["type"] == "truth"]
    assert latest() >= 65 and truth[-1]["y"] > 3000  # far beyond the end
    assert not any(message["type"] == "ended" for message in heard)
    station.close()


def test_a_goal_goes_to_the_robot(station):
    station.command({"do": "go", "what": "there", "x": 1200, "y": 800})
    kind, payload = station.link.sent[-1]
    assert kind == protocol.GO and struct.unpack(protocol.GO_FORMAT, payload)[1:4] == (1, 1200, 800)
    with pytest.raises(ValueError, match="one of"):
        station.command({"do": "go", "what": "astray"})


def test_again_with_another_course_takes_no_other_options_from_the_page(station):
    station.address = "twin:z?width=620&chip=2&firmware=/tmp/mine"
    station.command({"do": "again", "course": "random", "gap": "400&config=/etc/passwd", "firmware": "/tmp/evil"})
    assert parse(station.address) == ("twin", "random", {"chip": "2", "firmware": "/tmp/mine", "gap": "400&config=/etc/passwd"})
    with pytest.raises(ValueError, match="courses are"):
        station.command({"do": "again", "course": "z?firmware=/tmp/evil"})


def test_recordings_are_listed_with_what_became_of_them(station):
    station.link.hear(NAMES)
    station.command({"do": "record", "path": "first.rec"})
    for x in (0, 100, 200):
        station.link.tell({"type": "truth", "x": x, "y": 20.0, "heading": 90.0})
    station.link.end("pass after 20.0 s")
    assert until(lambda: any(message["type"] == "ended" for message in station.known()))
    heard = []
    station.listeners.append(heard.append)
    station.command({"do": "end_recording"})
    assert heard == [{"type": "recording", "path": None, "saved": "out/first.rec"}]
    (station_path := Path("out/broken.rec")).write_bytes(b"no recording")
    os.utime(station_path, (1, 1))
    good, broken = station.command({"do": "recordings"})["list"]
    assert good["path"] == "out/first.rec" and good["result"] == "pass after 20.0 s" and good["way"] == [[0, 20], [100, 20], [200, 20]]
    assert good["length"] < 5 and "no recording" in broken["result"]


def test_ctrl_c_with_a_page_open_says_nothing(tmp_path):
    command = [sys.executable, "-m", "host.monitor", "twin:z?width=620", "--no-browser"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        url = urllib.parse.urlsplit(child.stdout.readline().split()[-1])
        page = Page(SimpleNamespace(port=url.port, key=url.query.removeprefix("key=")))
        page.get("truth")
        child.send_signal(signal.SIGINT)
        _, error = child.communicate(timeout=20)
        page.close()
    assert (child.returncode, error) == (0, "")


def test_a_disk_that_is_full_before_a_recording_is_said_and_the_page_stays(server, station, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    page = Page(server)
    monkeypatch.setattr(recording.Writer, "write", full)
    page.send({"do": "record"})
    refused = page.get("refused")
    assert (refused["do"], refused["text"]) == ("record", "record: No space left on device")
    monkeypatch.undo()
    page.send({"do": "drive", "what": "auto"})
    assert until(lambda: station.link.drives())
    page.close()
