"""The model of the chip's memory, and our own start played against it."""

import json
import re
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

from host import micropython
from host.budget import __main__ as command_line
from host.budget import chip_memory, fit, peak, targets, trace
from host.budget.chip_memory import ChipMemory, NoRoom
from host.twin import image

YESTERDAY = Path(__file__).with_name("start_af3b427.json")
CONFIG = json.loads((image.FIRMWARE / "robot.json").read_text())
KIB = 1024

try:
    WORD_BYTES = micropython.find().word_bytes
except micropython.ToolMissing:
    WORD_BYTES = 0
with_the_boards_words = pytest.mark.skipif(WORD_BYTES != 4, reason="no MicroPython with words of 32 bits here: make setup")


# --- the model


def test_code_goes_to_the_places_of_its_own_first():
    memory = ChipMemory()
    memory.add_code("a", [14_000, 15_000, 900, 200])
    assert [place.block for place in memory.places[1:]] == [
        "the 14656 bytes for code",
        "the 15320 bytes for code",
        "the shared block",
        "the 14656 bytes for code",
    ]
    assert memory.code == 30_100


def test_the_heap_doubles_then_takes_what_is_left():
    memory = ChipMemory()
    memory.use_heap("a", 50 * KIB, 60 * KIB)
    assert memory.areas == [64 * KIB, 64 * KIB]
    memory.use_heap("b", 100 * KIB, 130 * KIB)
    assert memory.areas[2] == 110_592 - 64 * KIB
    memory.use_heap("c", 100 * KIB, 165 * KIB)
    assert memory.areas[3] == 14 * KIB


def test_a_heap_that_fits_does_not_grow():
    memory = ChipMemory()
    memory.use_heap("a", 40_000, chip_memory.FIRST_FREE)
    assert memory.areas == [64 * KIB]


def test_code_that_comes_after_the_heap_has_taken_all():
    memory = ChipMemory()
    memory.add_code("early", [14_640, 15_300])
    memory.use_heap("tables", 120_000, 130_000)
    with pytest.raises(NoRoom, match="no room for 2393 bytes of machine code of lidar: the heap had taken the last of the shared block for tables"):
        memory.add_code("lidar", [2393])


def test_a_start_that_fits_in_one_order_fails_in_another():
    code, heap = ["code", "lidar", [14_640, 15_300, 2393]], ["heap", "tables", 120_000, 130_000]
    chip_memory.replay([code, heap])
    with pytest.raises(NoRoom):
        chip_memory.replay([heap, code])


def test_the_radio_comes_before_the_heap_has_grown_and_before_code():
    memory = ChipMemory()
    memory.switch_radio_on()
    assert memory.blocks[0].free == 98_304 and memory.code_left == 98_304 + 15_320
    memory.connect_radio()
    for too_early in (["heap", "a", 50_000, 70_000], ["code", "a", [500]]):
        with pytest.raises(NoRoom, match="must be switched on before"):
            chip_memory.replay([too_early, ["radio", "on"]])


def test_a_uart_that_comes_after_the_heap_has_taken_all():
    memory = ChipMemory()
    memory.add_uart("lidar", 4096, 256)
    memory.use_heap("all", 180_000, 181_000)
    with pytest.raises(NoRoom, match="UART ring of screen"):
        memory.add_uart("screen", 40_000, 0)


def test_heap_and_code_together_are_what_the_chip_was_seen_to_hold():
    memory = ChipMemory()
    memory.switch_radio_on()
    memory.add_code("a", [36 * KIB])
    with pytest.raises(NoRoom, match="beside 36864 of machine code"):
        memory.use_heap("b", 120 * KIB, 128 * KIB)


def test_yesterdays_start_is_refused():
    """It ended on the chip while telemetry was loaded: the heap had grown into what machine code needed."""
    events = json.loads(YESTERDAY.read_text())["events"]
    with pytest.raises(NoRoom, match="machine code of .*: the heap had taken the last of the shared block"):
        chip_memory.replay(events)
    # The one change with which it started: four modules loaded before all else.
    early = [event for event in events if event[0] == "code" and event[1] in ("telemetry", "drive", "outputs", "pca9685", "lidar", "crc16")]
    code = [event for event in events if event[0] == "code" and event not in early]
    rest = [event for event in events if event[0] != "code"]
    chip_memory.replay([*early, *code, *rest])


# --- our own start


@with_the_boards_words
@pytest.mark.parametrize("option", trace.OPTIONS)
def test_our_start_fits_the_chip(option):
    with trace.board(trace.merged(CONFIG, trace.OPTIONS[option])) as folder:
        events = trace.record(folder, trace.native_pieces())
    kinds = [event[0] for event in events]
    assert {"code", "heap", "uart"} <= set(kinds)
    if option != "usb":
        assert kinds.index("radio") < kinds.index("code") and ["radio", "connected"] in events
    # The rule of the order: machine code while the heap still lies in its first area.
    peaks = [event[3] for event in events[: max(k for k, kind in enumerate(kinds) if kind == "code")] if event[0] == "heap"]
    assert max(peaks) < chip_memory.FIRST_FREE, "machine code is loaded when the heap has grown: see _MACHINE_CODE in core/start.py"
    memory = chip_memory.replay(events)
    assert memory.heap_left >= targets.COMES_AND_GOES, events[-1]


@with_the_boards_words
def test_a_hundred_rounds_of_everything_leave_the_heap_as_it_was():
    few, _ = peak.live_after(CONFIG, 10)
    many, said = peak.live_after(CONFIG, peak.ROUNDS)
    assert not said.refused and said.replies == 6 * peak.ROUNDS
    assert said.hellos >= peak.ROUNDS
    assert many - few < 90 * 16  # less than the smallest block a round; what the collector takes for a pointer differs from time to time


# --- the command


def test_a_row_that_misses_its_target_says_so():
    figures = {
        "live_bytes": {"usb": 101 * KIB, "wifi": 105 * KIB, "screen": None},
        "peak_bytes": 7 * KIB,
        "native_bytes": 37 * KIB,
        "native_screen_bytes": 9 * KIB,
        "native_goal_bytes": 2 * KIB,
        "start_ms_esp32": None,
        "turn_worst_ms_esp32": 10,
        "link_worst_ms_esp32": 1,
        "screen_worst_ms_esp32": 2,
        "screen_bytes_s": None,
        "word_bytes": 4,
    }
    rows = targets.rows(figures)
    assert [row.missed for row in rows] == [True, False, False, False, True, False, False, False, True, False, True, False]
    assert "misses by 1.0" in rows[0].text() and "not measured" in rows[2].text()


def test_an_option_that_is_none_is_refused(capsys):
    assert command_line.main(["--option", "screen"]) == 2
    assert "group.key=value" in capsys.readouterr().err


# --- the stand-in for the port's network, which the twin's board has as well

_WIFI = """
import sys
sys.path[:] = [{board!r}]
for name in ("network", "socket"):
    sys.modules.pop(name, None)
import network, socket, select
said = []
network.tell = lambda *words: said.append(words)
def fails(what, *arguments, **named):
    try:
        what(*arguments, **named)
    except OSError as error:
        return error.args[0]
wlan = network.WLAN(network.STA_IF)
assert wlan is network.WLAN(network.WLAN.IF_STA) and not wlan.active()
assert fails(wlan.connect, "net", "12345678") == "Wifi Not Started"
assert wlan.active(True) and wlan.active(True) and said == [("radio", "on")]
wlan.connect("net", "wrong-one")
assert not any([wlan.isconnected() for _ in range(5)]) and wlan.status() == network.STAT_WRONG_PASSWORD
wlan.disconnect()
wlan.connect("nowhere", "12345678")
assert not any([wlan.isconnected() for _ in range(5)]) and wlan.status() == network.STAT_NO_AP_FOUND
wlan.disconnect()
wlan.connect("net", "12345678")
assert fails(wlan.connect, "net", "12345678") == "Wifi Internal State Error"
assert [wlan.isconnected() for _ in range(3)] == [False, False, True] and wlan.isconnected()
wlan.lose()
assert [wlan.isconnected() for _ in range(3)] == [False, False, True]
network.fails = "Wifi Out of Memory"
assert fails(wlan.active, True) == "Wifi Out of Memory" and wlan.active(True)
one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
address = socket.getaddrinfo("255.255.255.255", 9751)[0][-1]
socket.busy = 1
assert fails(one.sendto, b"abc", address) == 12 and one.sendto(b"abc", address) == 3 and socket.sent == 1
poller = select.poll()
poller.register(one, select.POLLIN)
assert not list(poller.ipoll(0)) and fails(one.recvfrom, 9) == 11
socket.inbox.append((b"hello", ("10.0.0.2", 7)))
assert list(poller.ipoll(0)) and one.recvfrom(9) == (b"hello", ("10.0.0.2", 7))
print("as the port")
"""


@pytest.mark.skipif(not WORD_BYTES, reason="no MicroPython here: make setup")
def test_the_stand_in_for_wifi_behaves_like_the_port():
    done = subprocess.run([*micropython.find().command, "-c", _WIFI.format(board=str(image.BOARD))], capture_output=True, text=True)
    assert done.stdout == "as the port\n", done.stderr


# --- what to switch off


@pytest.mark.parametrize(
    "needs_off, told",
    [
        ({"screen"}, "switch the screen off: set screen.kind"),
        ({"wifi"}, "switch the WiFi off: set wifi.ssid"),
        ({"screen", "wifi"}, "switch off the screen .* and the WiFi"),
        ({"everything"}, "needs a board with PSRAM"),
    ],
)
def test_what_to_switch_off_is_the_least_that_helps(monkeypatch, needs_off, told):
    def problem(config, firmware):
        on = {"screen"} if config["screen"]["kind"] != "none" else set()
        on |= {"wifi"} if config["wifi"]["ssid"] else set()
        on |= {"everything"}
        return ("no room" if on & needs_off else ""), 0

    monkeypatch.setattr(fit, "_problem", problem)
    monkeypatch.setattr(fit.micropython, "find", lambda: SimpleNamespace(word_bytes=4))
    settings = json.dumps(trace.merged(CONFIG, trace.OPTIONS["screen"])).encode()
    with pytest.raises(fit.DoesNotFit, match="no room") as refused:
        fit.check(settings, image.FIRMWARE)
    assert re.search(told, refused.value.remedy)
    assert "not checked" in fit.check(b"{", image.FIRMWARE)
