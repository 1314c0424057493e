"""Every option of robot.json starts and drives, in the heap of the board, and nothing the network does ends the loop."""

import shutil

import pytest

from host.link import messages
from host.twin import Observer, image, run
from link import frames, protocol

WIFI = {"wifi.ssid": "net", "wifi.password": "12345678"}
# What the board has been through before main.py begins
FRESH = ""
JOINED = "import network\nw = network.WLAN(0)\nw.active(True)\nw.connect('net', '12345678')\nwhile not w.isconnected(): pass\n"
JOINING = "import network\nw = network.WLAN(0)\nw.active(True)\nw.connect('net', '12345678')\n"
LATE = "import network\nnetwork.joins_after = 3\n"
WRONG = "import network\nnetwork.networks = {'net': 'something else'}\n"
NOWHERE = "import network\nnetwork.networks = {}\n"
BROKEN = "import network\nnetwork.fails = 'WiFi Out of Memory'\n"
# As on old boards
UNCALIBRATED = "import machine\ndef read_uv(self): raise OSError(-1)\nmachine.ADC.read_uv = read_uv\n"
# Somebody asks for the session, and the radio has no buffers for a while.
ASKED = f"import socket\nsocket.inbox = [({frames.frame(protocol.GREET, bytes((1, 0, 0, 0, 1)))!r}, ('10.0.0.7', 4321))]\nsocket.busy = 5\n"


class Witness(Observer):
    """What the robot says, and on which UARTs."""

    def __init__(self):
        self.frames = frames.FrameReader()
        self.said = []
        self.uarts = set()

    def serial(self, data):
        self.said += [messages.decode(kind, payload) for kind, _, payload in self.frames.read(data)]

    def uart(self, time, gpio, data):
        self.uarts.add(gpio)

    def told(self, kind):
        return [message for message in self.said if message and message["type"] == kind]


def drive(tmp_path, changes, before=FRESH):
    """Two seconds or so of driving; what was seen."""
    firmware = image.FIRMWARE
    if before:
        firmware = tmp_path / "firmware"
        shutil.copytree(image.FIRMWARE, firmware, ignore=shutil.ignore_patterns("__pycache__"))
        main = firmware / "main.py"
        main.write_text(before + main.read_text())
    witness = Witness()
    result = run("Z", 620, watch=witness, limit_s=3, record=False, changes=changes, firmware=firmware)
    assert result.reason == "3 s are over" and not result.contacts, result.reason
    assert max(message["v"] for message in witness.told("wheels")) > 95
    return witness


@pytest.mark.parametrize("before", (FRESH, JOINED, JOINING, LATE, ASKED), ids=("fresh", "joined", "joining", "late", "asked"))
def test_a_robot_in_a_network_drives(tmp_path, before):
    witness = drive(tmp_path, WIFI, before)
    assert witness.told("health")[-1]["radio"]
    assert ["network.key" in message["text"] for message in witness.told("log")] == [True]  # and nothing else to say


@pytest.mark.parametrize("before", (WRONG, NOWHERE), ids=("password", "network"))
def test_without_its_network_it_drives_and_goes_on_asking(tmp_path, before):
    assert drive(tmp_path, WIFI, before).told("health")[-1]["radio"]


@pytest.mark.parametrize("changes", (WIFI, {**WIFI, "wifi.access_point": True}), ids=("station", "access point"))
def test_a_radio_that_fails_is_told_and_the_robot_drives(tmp_path, changes):
    witness = drive(tmp_path, changes, BROKEN)
    assert "no WiFi: WiFi Out of Memory" in witness.told("log")[0]["text"] and not witness.told("health")[-1]["radio"]


@pytest.mark.parametrize("password", ("", "12345678"), ids=("open", "closed"))
def test_a_robot_that_is_the_network_drives(tmp_path, password):
    witness = drive(tmp_path, {"wifi.ssid": "robot", "wifi.password": password, "wifi.access_point": True})
    assert witness.told("health")[-1]["radio"]


@pytest.mark.parametrize("kind", ("usart-gpu", "uart-lcd", "nextion"))
def test_each_screen_shows_while_it_drives(tmp_path, kind):
    assert drive(tmp_path, {"screen.kind": kind}).uarts


@pytest.mark.parametrize("pin", ("pins.stop_button", "pins.battery", "pins.output_enable", "lidar.motor_pin"))
def test_without_that_pin_it_drives(tmp_path, pin):
    drive(tmp_path, {pin: None})


@pytest.mark.parametrize("axles", range(2, 9))
def test_any_number_of_axles_drives(tmp_path, axles):
    lists = {"channels": list(range(2 * axles)), "directions": 1, "trims": 0, "low": -90, "high": 90, "pulse_low": 500, "pulse_high": 2500}
    changes = {f"servos.{key}": value for key, value in lists.items()}
    changes.update({"motors.channels": list(range(0, 2 * axles, 2)), "motors.directions": 1})
    drive(tmp_path, {**changes, "axles.spacings": [497 // (axles - 1)] * (axles - 1), "axles.first": 248.5})


def test_with_the_last_axle_straight_it_drives(tmp_path):
    drive(tmp_path, {"mode": "NAWS"})


def test_a_board_without_calibration_drives_and_says_so(tmp_path):
    witness = drive(tmp_path, {}, UNCALIBRATED)
    assert "not calibrated" in witness.told("log")[0]["text"]
    assert abs(witness.told("health")[-1]["battery"] - 7.8) < 0.1


def test_a_start_without_the_tables_is_told(tmp_path, monkeypatch):
    assert not [log for log in drive(tmp_path, {}).told("log") if "tables.bin" in log["text"]]
    monkeypatch.setattr(image, "tables", lambda text, firmware: None)
    assert [log for log in drive(tmp_path, {}).told("log") if log["text"].startswith("tables.bin was missing")]
