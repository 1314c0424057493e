"""What the firmware has of the board's heap in the twin, what lives in it after the start, and that everything it can do fits.

Only the 32-bit MicroPython takes what the board takes.
"""

import json
import shutil

import pytest
from test_link_twin import Hand

from host import micropython
from host.budget import report
from host.link import messages
from host.micropython import mpy
from host.twin import Observer, courses, image, memory, run
from link import protocol

KIB = 1024
WIFI = {"wifi.ssid": "net", "wifi.password": "12345678"}
# What may live after the start, default robot.json: 98 KiB and 2 for real rooms, 5 more for WiFi and 4 more for a screen.
LIVE_KIB = {"usb": 100, "wifi": 105, "screen": 109}
OPTIONS = {"usb": {}, "wifi": WIFI, "screen": {**WIFI, "screen.kind": "nextion"}}

needs_32_bits = pytest.mark.skipif(micropython.find().word_bytes != 4, reason="no 32-bit MicroPython here: run `make setup` where apt can be asked")

FIRST_LINE = "import gc\nprint('heap', gc.mem_alloc() + gc.mem_free())\n"
ASK = """
import gc
gc.collect()
print("live", gc.mem_alloc())
"""
BEFORE_THE_LOOP = "\ntry:\n    while robot"


class Printed(Observer):
    """Keeps what the firmware prints."""

    def __init__(self):
        self.data = b""

    def serial(self, data):
        self.data += data

    def figure(self, word):
        """The number printed behind a word."""
        assert word.encode() in self.data, self.data[-500:].decode(errors="replace")
        return int(self.data.split(word.encode())[1].split()[0])


@pytest.fixture
def changed(tmp_path):
    """changed(**places): the firmware with text put before its main.py's first line or its loop."""

    def change(first="", loop=""):
        folder = tmp_path / "firmware"
        shutil.copytree(image.FIRMWARE, folder, ignore=shutil.ignore_patterns("__pycache__"))
        text = (folder / "main.py").read_text()
        assert BEFORE_THE_LOOP in text
        (folder / "main.py").write_text(first + text.replace(BEFORE_THE_LOOP, loop + BEFORE_THE_LOOP))
        return folder

    return change


@pytest.mark.parametrize("engine", micropython.ENGINES)
@pytest.mark.parametrize("changes, kib", (({}, 200), (WIFI, 163)), ids=("usb", "wifi"))
def test_the_heap_is_what_the_board_has(changed, engine, changes, kib):
    firmware = changed(first=FIRST_LINE)
    printed = Printed()
    run(engine=engine, changes=changes, firmware=firmware, watch=printed, limit_s=0.1, record=False)
    port = micropython.find(engine)
    folder, _ = image.compiled(firmware, port)
    of_the_twin, _ = memory.taken_by_the_board(port, folder, radio=bool(changes))
    code = sum(count for name, count in mpy.machine_code_bytes(firmware).items() if not name.startswith(memory.not_loaded(False, False, False)))
    expected = (kib * KIB - code - memory.NAMES) * port.heap_factor  # the places of its names are there already, among what the twin takes
    assert printed.figure("heap") - of_the_twin == pytest.approx(expected, abs=256)


@needs_32_bits
def test_what_lives_in_the_loop():
    """By the budget's stand-ins for the devices: the twin's board has names of its own, which move a step of the interpreter's list of names."""
    found = report.live(json.loads((image.FIRMWARE / "robot.json").read_text()))
    kib = {option: round(size / KIB, 1) for option, size in found.items()}
    print(f"live: {kib} KiB")
    assert all(kib[option] <= LIVE_KIB[option] for option in LIVE_KIB)


def _everything(seconds):
    """Greeting, all parameters, tuning, keeping, raw scans and candidates, over and over, as a page that is loaded anew does it."""
    plan = []
    for k in range(seconds):
        plan += [
            (k + 1.0, protocol.WATCH, messages.watch(k, True, True)),
            (k + 1.1, protocol.GREET, messages.greet(k, True)),
            (k + 1.2, protocol.LIST, messages.plain(k)),
            (k + 1.3, protocol.TUNE, messages.tune(k, "speed.max", 200 + k)),
            (k + 1.4, protocol.TUNE, messages.tune(k, "avoid.margin", 15 + k % 5)),
            (k + 1.5, protocol.KEEP, messages.plain(k)),
        ]
    return plan


# Not with WiFi and a screen: there the names of the twin's own board make the interpreter's list of names grow by a step of 9 kB, which the chip does not take.
@pytest.mark.parametrize("option", ["usb", "wifi"])
def test_all_that_a_page_asks_for_fits_while_it_drives(option):
    page = Hand(_everything(12))
    result = run("Z", 550, seed=1, changes=OPTIONS[option], watch=page, record=False)
    assert (result.result, result.contacts) == ("pass", 0), result.reason
    assert len(page.told("parameter")) > 200 and len(page.told("scan")) > 20
    assert len(page.told("reply")) > 20
    assert not [reply for reply in page.told("reply") if "memory" in str(reply).lower()]


@pytest.mark.parametrize("course", courses.NAMES)
def test_every_course_is_driven_in_that_heap(course):
    """With computing charged as on the chip."""
    result = run(course, width=620, seed=1, record=False, chip=1)
    assert result.result == "pass" and not result.contacts, result.reason
