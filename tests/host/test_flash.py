"""Flashing, with the real esptool and mpremote against a board emulated at its bytes (`emulated_board`).

Not covered, because only a real board has it: reset over DTR and RTS, the rates, the ROM's own timing, a firmware that really starts, and
the download from micropython.org.
"""

import hashlib
import os
import stat
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
import serial
from emulated_board import EmulatedBoard
from emulated_rom import ESP32_S2_MAGIC, MAC

from host.boards import build, places, usb
from host.boards.errors import FlashError
from host.budget import fit
from host.flash import __main__ as command_line
from host.flash import board, flow, hello, image, keep, ports, rescue, rom, tools
from link import frames as whole_frames
from link import protocol

HELLO = b"starting\r\n" + whole_frames.frame(protocol.HELLO, bytes(20) + b'{"firmware": "0.1.0", "robot": "twin"}')
IDENTITY = MAC.hex()
MINE = b'{"robot": {"length": 610}, "avoid": {"margin": 17}}'
DEFAULT = b'{"robot": {"length": 600}, "avoid": {"margin": 12}, "wifi": {"ssid": ""}}'
IMAGE = b"\xe9" + bytes(11) + b"\0\0" + bytes(range(256)) * 20

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the board is emulated on a pseudo-terminal")


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    """Keys, backups and downloads go into the test's own folder; a board that does not answer is given up soon."""
    monkeypatch.setattr(hello.ask_prompt, "__defaults__", (0.6,))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path


@pytest.fixture
def sources(tmp_path):
    """A small firmware."""
    folder = tmp_path / "firmware"
    (folder / "lib").mkdir(parents=True)
    (folder / "main.py").write_text("import wheels\n")
    (folder / "robot.json").write_bytes(DEFAULT)
    (folder / "lib" / "wheels.py").write_text("import micropython\n@micropython.viper\ndef double(n: int) -> int:\n    return n + n\n")
    (folder / "lib" / "names.py").write_text("NAMES = ('front', 'rear')\n")
    return folder


@pytest.fixture
def firmware(tmp_path):
    path = tmp_path / "image.bin"
    path.write_bytes(IMAGE)
    return path


@pytest.fixture
def connect(tmp_path):
    """Makes the one board of a test; it is unplugged at the end."""
    boards = []

    def make(**properties) -> EmulatedBoard:
        (tmp_path / "board").mkdir(exist_ok=True)
        boards.append(EmulatedBoard(tmp_path / "board", **{"hello": HELLO, **properties}).__enter__())
        return boards[-1]

    yield make
    for one in boards:
        one.__exit__()


@pytest.fixture
def perform(sources, firmware, capfd):
    """Runs steps against a board; returns what was printed."""

    def perform(steps, emulated, **options):
        options.setdefault("fits", lambda settings, sources: "it fits")
        job = flow.Job(emulated.port, options.pop("firmware", firmware), sources=sources, **options)
        flow.run(steps, job)
        return capfd.readouterr().out

    return perform


# --- the whole way


def test_flash_a_new_board(connect, perform, sources):
    emulated = connect()
    printed = perform(flow.FLASH, emulated)
    assert emulated.flash.read(0x1000, len(IMAGE)) == IMAGE
    assert emulated.get("main.py") == b"import wheels\n"
    assert emulated.get("lib/wheels.mpy")[:4] == b"M\x06\x2b\x1f"  # version 6.3, native code for xtensawin
    assert emulated.get("lib/wheels.py") is None
    assert emulated.get("robot.json") == DEFAULT
    assert "a new board" in printed and "firmware 0.1.0 says hello" in printed


def test_flash_keeps_the_settings(connect, perform):
    emulated = connect()
    emulated.install()
    emulated.put({"robot.json": MINE, "main.py": b"old"})
    printed = perform(flow.FLASH, emulated)
    assert emulated.get("robot.json") == MINE
    assert emulated.get("main.py") == b"import wheels\n"
    assert [path.read_bytes() for path in keep.backups(IDENTITY)] == [MINE]
    assert "lacks wifi.ssid" in printed


def test_flash_keeps_even_broken_settings(connect, perform):
    settings = "{ kein JSON, größer".encode()
    emulated = connect()
    emulated.install()
    emulated.put({"robot.json": settings})
    assert "no valid JSON" in perform(flow.FLASH, emulated)
    assert emulated.get("robot.json") == settings


@pytest.mark.parametrize(
    "settings, told",
    [
        (b"", "no valid JSON"),
        (b"[]", "no JSON object"),
        (b'{"avoid": {"margin": 900}}', "avoid.margin = 900"),
        (b'{"avoid": {"margn": 9}}', "avoid.margn"),
        (b'{"avoid": {"margin": 9}}', "lacks robot.length, wifi.ssid"),
        (DEFAULT, ""),
    ],
)
def test_doubts_about_settings(settings, told):
    assert told in keep.doubts(settings, DEFAULT)
    assert bool(told) == bool(keep.doubts(settings, DEFAULT))


def test_settings_are_rescued_from_a_board_that_does_not_answer(connect, perform):
    """A program that holds the prompt: the file system is read through the ROM loader, and robot.json taken out of it."""
    emulated = connect(deaf=True)
    emulated.install()
    emulated.put({"robot.json": MINE, "lib/other.py": b"x = 1" * 900})
    steps = [step for step in flow.FLASH if step.title.startswith(("stock", "look", "save", "erase"))]
    perform(steps, emulated)
    assert set(emulated.flash.read(0x200000, 4096)) == {0xFF}
    assert [path.read_bytes() for path in keep.backups(IDENTITY)] == [MINE]
    assert not list(places.backup_dir().glob("*.bin"))


def test_settings_survive_a_flash_broken_off_after_the_erase(connect, perform):
    emulated = connect()
    emulated.install()
    emulated.put({"robot.json": MINE})
    perform([step for step in flow.FLASH if step.title.startswith(("stock", "look", "save", "erase"))], emulated)
    printed = perform(flow.FLASH, emulated)
    assert emulated.get("robot.json") == MINE
    assert "restored from" in printed


def test_deploy_copies_only_what_changed(connect, perform, sources):
    emulated = connect()
    perform(flow.FLASH, emulated)
    assert "0 of 4 files had changed" in perform(flow.DEPLOY, emulated)
    (sources / "lib" / "names.py").write_text("NAMES = ()\n")
    printed = perform(flow.DEPLOY, emulated)
    assert "1 of 4 files had changed" in printed
    assert "cp" in printed and "wheels.mpy" not in printed
    assert printed.rstrip().endswith("firmware 0.1.0 says hello")


def test_deploy_leaves_settings_and_foreign_files_alone(connect, perform):
    emulated = connect()
    emulated.install()
    emulated.put({"robot.json": MINE, "notes.txt": b"mine", "lib/sensor.py": b"mine"})
    perform(flow.DEPLOY, emulated)
    assert [emulated.get(name) for name in ("robot.json", "notes.txt", "lib/sensor.py")] == [MINE, b"mine", b"mine"]
    assert [path.read_bytes() for path in keep.backups(IDENTITY)] == [MINE]


def test_deploy_removes_a_source_that_would_hide_the_compiled_module(connect, perform):
    emulated = connect()
    emulated.install()
    emulated.put({"lib/wheels.py": b"stale"})
    perform(flow.DEPLOY, emulated)
    assert emulated.get("lib/wheels.py") is None
    assert emulated.get("lib/wheels.mpy")


def test_folders_are_made_and_what_an_older_firmware_left_goes(connect, perform, sources):
    (sources / "lib" / "planner").mkdir()
    (sources / "lib" / "planner" / "queue.py").write_text("SIZE = 4\n")
    emulated = connect()
    emulated.install()
    mine = {"lib/sensor.mpy": b"mine", "lib/planner/notes.txt": b"mine"}
    emulated.put({"lib/field.mpy": b"old", "lib/lidar.mpy": b"old", "lib/planner/gone.mpy": b"old", **mine})
    perform(flow.DEPLOY, emulated)
    assert emulated.get("lib/planner/queue.mpy")
    assert [emulated.get(name) for name in ("lib/field.mpy", "lib/lidar.mpy", "lib/planner/gone.mpy")] == [None] * 3
    assert {name: emulated.get(name) for name in mine} == mine


def test_an_emptied_folder_goes_too(sources, tmp_path, monkeypatch):
    monkeypatch.setattr(board, "_OLD_PACKAGES", frozenset({"nose"}))
    files = build.build(tmp_path / "out", sources)
    found = {"lib/nose/tip.mpy": "0", "lib/wheels.mpy": "0"}
    survey = board.Survey("00", (1, 24, 0), 1 << 20, found, ["lib", "lib/nose"], "Generic ESP32 module with ESP32", 0, 167_000)
    (command,) = board.clear_commands("PORT", files, survey)
    assert command[-7:] == ["fs", "rm", ":lib/nose/tip.mpy", "+", "fs", "rmdir", ":lib/nose"]


def test_the_tables_are_made_for_the_boards_own_robot_json(connect, perform):
    emulated = connect()
    perform(flow.FLASH, emulated)
    first = emulated.get("tables.bin")
    assert first
    emulated.put({"robot.json": MINE})
    perform(flow.DEPLOY, emulated)
    assert emulated.get("tables.bin") not in (first, None)


# --- what does not fit is refused before anything is written


def refuse(settings, sources):
    raise fit.DoesNotFit("no room for 2393 bytes of machine code of lidar", "switch the screen off")


@pytest.mark.parametrize("steps", ("FLASH", "DEPLOY"))
def test_options_that_do_not_fit_are_refused(connect, perform, steps):
    emulated = connect()
    emulated.install()
    emulated.put({"robot.json": MINE, "main.py": b"old"})
    with pytest.raises(FlashError, match="2393 bytes.*\n.*switch the screen off"):
        perform(getattr(flow, steps), emulated, fits=refuse)
    assert 0xD0 not in emulated.loader.commands and emulated.get("main.py") == b"old"


ARM = (build.FIRMWARE.parent / "host" / "arm" / "arms" / "mt-arm.json").read_bytes()


@pytest.mark.parametrize("steps", ("FLASH", "DEPLOY"))
def test_the_boards_arm_stays(connect, perform, steps):
    emulated = connect()
    emulated.install()
    emulated.put({"robot.json": MINE, "arm.json": ARM, "reach.bin": b"kept"})
    printed = perform(getattr(flow, steps), emulated)
    assert emulated.get("arm.json") == ARM
    assert "arm: mt-arm, 5 servos on outputs 10, 11, 12, 13, 14" in printed


def test_an_arm_is_put_on_the_board(connect, perform):
    emulated = connect()
    emulated.install()
    perform(flow.DEPLOY, emulated, arm=ARM)
    assert emulated.get("arm.json") == ARM


@pytest.mark.parametrize(
    "settings, arm, told",
    [
        (b'{"axles": {"spacings": [80, 80, 80, 80, 80]}}', ARM, "output 10 .* the 6 axles leave 4 outputs .12, 13, 14, 15., the arm wants 5"),
        (MINE, ARM.replace(b'"servos"', b'"sevros"'), "unknown key sevros"),
        (MINE, ARM[:200], "not JSON"),
        (MINE, b'{"joints": [{"length_mm": 1, "mass_kg": 1}]}', "length_mm"),
    ],
)
def test_an_arm_that_has_no_room_is_refused_before_anything_is_written(connect, perform, settings, arm, told):
    emulated = connect()
    emulated.install()
    emulated.put({"robot.json": settings, "main.py": b"old"})
    with pytest.raises(FlashError, match=told):
        perform(flow.DEPLOY, emulated, arm=arm)
    assert emulated.get("main.py") == b"old" and emulated.get("arm.json") is None


def test_nothing_is_refused_where_the_heap_is_large(connect, perform):
    emulated = connect(heap=4 << 20)
    emulated.install()
    assert "PSRAM" in perform(flow.DEPLOY, emulated, fits=refuse)


def test_an_image_for_psram_is_judged_when_it_runs(connect, perform, tmp_path):
    psram = tmp_path / "psram.bin"
    psram.write_bytes(IMAGE + b"Generic ESP32 module with SPIRAM with ESP32")
    without = connect()
    with pytest.raises(FlashError, match="switch the screen off"):
        perform(flow.FLASH, without, firmware=psram, fits=refuse)
    assert without.get("main.py") is None


def test_an_image_for_psram_where_there_is_some(connect, perform, tmp_path, sources):
    psram = tmp_path / "psram.bin"
    psram.write_bytes(IMAGE + b"Generic ESP32 module with SPIRAM with ESP32")
    (sources / "robot.json").write_text('{"lidar": {"rx": 34}}')
    assert "everything fits" in perform(flow.FLASH, connect(heap=4 << 20), firmware=psram, fits=refuse)


@pytest.mark.parametrize(
    "package, settings, told",
    [
        (5, DEFAULT, ""),
        (5, b'{"lidar": {"rx": 16}}', "ESP32-PICO-D4 needs GPIO 16 and 17 for its flash memory, and robot.json has lidar.rx = 16"),
        (7, b'{"lidar": {"rx": 34}, "screen": {"kind": "nextion", "tx": 17, "rx": 35}}', "ESP32-D0WDR2-V3 needs .* its PSRAM, .* screen.tx = 17"),
        (7, b'{"lidar": {"rx": 34}, "screen": {"kind": "none", "tx": 17, "rx": 35}}', ""),
        (1, b'{"lidar": {"rx": 16}}', ""),
    ],
)
@pytest.mark.parametrize("steps", ("FLASH", "DEPLOY"))
def test_pins_that_the_chip_needs_for_itself(connect, perform, steps, package, settings, told):
    emulated = connect(package=package)
    emulated.install()
    emulated.put({"robot.json": settings})
    if told:
        with pytest.raises(FlashError, match=told):
            perform(getattr(flow, steps), emulated)
        assert emulated.get("main.py") is None and 0xD0 not in emulated.loader.commands
    else:
        perform(getattr(flow, steps), emulated)


def test_deploy_to_another_chip(connect, perform):
    emulated = connect(name="Generic ESP32S3 module with ESP32S3")
    emulated.install()
    with pytest.raises(FlashError, match="ESP32S3\n.*plain ESP32"):
        perform(flow.DEPLOY, emulated)


# --- the key


def test_the_key_is_made_once_and_private(connect, perform):
    emulated = connect()
    perform(flow.FLASH, emulated)
    path = places.key_path(IDENTITY)
    key = path.read_bytes()
    assert len(key) == 32 and emulated.get(flow.KEY_FILE) == key
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert "known" in perform(flow.DEPLOY, emulated)
    assert emulated.get(flow.KEY_FILE) == key


def test_a_second_laptop_learns_the_key(connect, perform):
    emulated = connect()
    perform(flow.FLASH, emulated)
    places.key_path(IDENTITY).unlink()
    assert "learnt from the board" in perform(flow.DEPLOY, emulated)
    assert places.key_path(IDENTITY).read_bytes() == emulated.get(flow.KEY_FILE)


@pytest.mark.parametrize("size", [0, 16])
def test_a_short_key_is_replaced(connect, perform, size):
    emulated = connect()
    perform(flow.FLASH, emulated)
    emulated.put({flow.KEY_FILE: bytes(size)})
    places.key_path(IDENTITY).write_bytes(bytes(size))
    assert "new: " in perform(flow.DEPLOY, emulated)
    key = places.key_path(IDENTITY).read_bytes()
    assert len(key) == 32 and emulated.get(flow.KEY_FILE) == key


def test_every_flash_makes_a_new_key(connect, perform):
    emulated = connect()
    perform(flow.FLASH, emulated)
    first = emulated.get(flow.KEY_FILE)
    perform(flow.FLASH, emulated)
    assert emulated.get(flow.KEY_FILE) not in (first, None)


# --- what can go wrong on the board


def test_wrong_chip(connect, perform):
    emulated = connect(magic=ESP32_S2_MAGIC)
    with pytest.raises(FlashError, match="needs a plain ESP32"):
        perform(flow.FLASH, emulated)
    assert 0xD0 not in emulated.loader.commands  # nothing was erased


def test_a_loader_that_does_not_answer():
    master, slave = os.openpty()
    try:
        with pytest.raises(FlashError, match="hold the BOOT button"):
            tools.show(rom.erase_command(os.ttyname(slave), 460800))
    finally:
        os.close(master)
        os.close(slave)


def test_a_disturbed_line_is_noticed(connect, perform):
    with pytest.raises(FlashError, match="BAUD=115200"):
        perform(flow.FLASH, connect(spoil=True))


def test_not_enough_room(connect, perform):
    emulated = connect(file_space=16 * 4096)
    emulated.install()
    emulated.put({"data.bin": bytes(11 * 4096)})
    with pytest.raises(FlashError, match="not enough room"):
        perform(flow.DEPLOY, emulated)
    assert emulated.get("main.py") is None  # no half firmware


def test_deploy_to_a_board_without_micropython(connect, perform):
    with pytest.raises(FlashError, match="make flash"):
        perform(flow.DEPLOY, connect())


def test_files_that_differ_when_read_back(sources, tmp_path):
    files = build.build(tmp_path / "out", sources)
    found = {file.name: file.sha256 for file in files}
    board.compare(files, found)
    with pytest.raises(FlashError, match="lib/names.mpy"):
        board.compare(files, {**found, "lib/names.mpy": "0" * 64})


@pytest.mark.parametrize(
    "said, told",
    [
        (b"", "silent"),
        (b"rst:0x10 (RTCWDT_RTC_RESET)\r\ninvalid header\r\n" * 3, "boot loop"),
        (b"rst:0xc\r\nBrownout detector was triggered\r\n" * 3, "supply voltage"),
        (b"Traceback (most recent call last):\r\nConfigError: avoid.margin 900: 0 to 100\r\n>>> ", "avoid.margin 900"),
        (b"something else", "something else"),
    ],
)
def test_diagnosis(said, told):
    assert told in str(hello.diagnose(said, "no hello"))


def test_a_firmware_that_stops_is_quoted(connect, perform):
    emulated = connect(hello=b"Traceback (most recent call last):\r\n  File \"main.py\"\r\nImportError: no module named 'wheel'\r\n>>> ")
    with pytest.raises(FlashError, match="no module named 'wheel'"):
        perform(flow.FLASH, emulated)


def test_a_boot_loop_is_told(connect):
    with pytest.raises(FlashError, match="boot loop"):
        hello.wait_for_prompt(connect().port, timeout=5)


# --- ports


def port(device, vid=0x10C4):
    return SimpleNamespace(device=device, vid=vid, description="CP2102")


def plug(monkeypatch, *found):
    monkeypatch.setattr(usb.list_ports, "comports", lambda: list(found))
    monkeypatch.setattr(ports.os.path, "exists", lambda path: True)
    monkeypatch.setattr(ports.os, "access", lambda path, mode: True)


def test_the_only_board_is_taken(monkeypatch):
    plug(monkeypatch, port("/dev/ttyUSB0"), port("/dev/ttyS0", None), port("/dev/ttyACM9", 0x1234))
    assert ports.choose(None) == "/dev/ttyUSB0"


def test_no_board(monkeypatch):
    plug(monkeypatch)
    with pytest.raises(FlashError, match="cable"):
        ports.choose(None)


def test_a_board_whose_port_somebody_else_took_is_named(monkeypatch, tmp_path):
    plug(monkeypatch)
    board, hub = tmp_path / "1-4", tmp_path / "usb1"
    for device, vendor, product in ((board, "1a86", "7523"), (hub, "1d6b", "0002")):
        device.mkdir()
        (device / "idVendor").write_text(vendor + "\n")
        (device / "idProduct").write_text(product + "\n")
    assert "1a86:7523" in usb.obstacle(tmp_path) and "apt remove brltty" in usb.obstacle(tmp_path)
    monkeypatch.setattr(usb, "DEVICES", tmp_path)
    with pytest.raises(FlashError, match="brltty"):
        ports.choose(None)
    (board / "1-4:1.0" / "ttyUSB0").mkdir(parents=True)
    assert usb.obstacle(tmp_path) == ""


def test_a_port_of_another_group_is_named_before_it_is_opened(monkeypatch, tmp_path):
    plug(monkeypatch, port("/dev/ttyUSB0"))
    monkeypatch.setattr(usb.os, "access", lambda path, mode: False)
    assert "dialout" in usb.obstacle(tmp_path)


def test_several_boards_are_asked_about(monkeypatch):
    plug(monkeypatch, port("/dev/ttyUSB1"), port("/dev/ttyUSB0"))
    assert ports.choose(None, lambda question: "2") == "/dev/ttyUSB1"
    assert ports.choose("/dev/ttyUSB7") == "/dev/ttyUSB7"
    with pytest.raises(FlashError, match="PORT=/dev/ttyUSB0"):
        ports.choose(None)
    with pytest.raises(FlashError, match="none of the numbers"):
        ports.choose(None, lambda question: "3")


def test_no_permission(monkeypatch):
    plug(monkeypatch, port("/dev/ttyUSB0"))
    monkeypatch.setattr(ports.os, "access", lambda path, mode: False)
    with pytest.raises(FlashError, match="dialout"):
        ports.choose(None)


def test_a_port_that_is_not_there():
    with pytest.raises(FlashError, match="no port /dev/nowhere"):
        ports.choose("/dev/nowhere")


def test_a_busy_port(connect):
    emulated = connect()
    with serial.Serial(emulated.port, exclusive=True):
        with pytest.raises(FlashError, match="close the program"):
            board.survey(emulated.port)
        with pytest.raises(FlashError, match="close the program"):
            hello.ask_prompt(emulated.port)


# --- the image


def published(path: Path, data: bytes) -> image.Image:
    path.write_bytes(data)
    return image.Image(path.as_uri(), len(data), hashlib.sha256(data).hexdigest())


def test_the_image_is_fetched_once(tmp_path):
    source = tmp_path / "stock.bin"
    wanted = published(source, IMAGE)
    path = image.fetch(wanted, tmp_path / "cache")
    assert path.read_bytes() == IMAGE
    source.unlink()
    assert image.fetch(wanted, tmp_path / "cache") == path


def test_a_damaged_cache_is_fetched_again(tmp_path):
    wanted = published(tmp_path / "stock.bin", IMAGE)
    path = image.fetch(wanted, tmp_path / "cache")
    path.write_bytes(IMAGE[:-1] + b"x")
    assert image.fetch(wanted, tmp_path / "cache").read_bytes() == IMAGE


@pytest.mark.parametrize("wrong", [IMAGE[:-1], IMAGE[:-1] + b"x"])
def test_another_image_is_refused(tmp_path, wrong):
    wanted = published(tmp_path / "stock.bin", IMAGE)
    (tmp_path / "stock.bin").write_bytes(wrong)
    with pytest.raises(FlashError, match="not the one that was published"):
        image.fetch(wanted, tmp_path / "cache")
    assert not list((tmp_path / "cache").iterdir())


def test_offline(tmp_path):
    with pytest.raises(FlashError, match="FIRMWARE=nothing.bin"):
        image.fetch(image.Image((tmp_path / "nothing.bin").as_uri(), 1, ""), tmp_path / "cache")


def test_a_given_image(tmp_path, firmware):
    assert image.given(firmware) == firmware
    other = tmp_path / "c3.bin"
    other.write_bytes(IMAGE[:12] + b"\x05\x00" + IMAGE[14:])
    with pytest.raises(FlashError, match="another chip"):
        image.given(other)
    other.write_bytes(b"PK\x03\x04" + bytes(40))
    with pytest.raises(FlashError, match="no ESP32 image"):
        image.given(other)
    with pytest.raises(FlashError, match="cannot read"):
        image.given(tmp_path / "none.bin")


# --- build


def test_build_names_the_files_of_the_board(tmp_path, sources):
    (sources / "lib" / "__pycache__").mkdir()
    (sources / "lib" / "__pycache__" / "x.pyc").write_bytes(b"")
    assert [file.name for file in build.build(tmp_path / "out", sources)] == ["lib/names.mpy", "lib/wheels.mpy", "main.py"]


def test_compiled_modules_name_no_folder_of_this_machine(tmp_path, sources):
    files = build.build(tmp_path / "out", sources)
    assert not any(str(tmp_path).encode() in file.data for file in files)


def test_a_module_that_does_not_compile(tmp_path, sources):
    (sources / "lib" / "names.py").write_text("def (:\n")
    with pytest.raises(FlashError, match="lib/names.py does not compile"):
        build.build(tmp_path / "out", sources)


def test_the_firmware_itself_compiles(tmp_path):
    if not (build.FIRMWARE / "main.py").exists():
        pytest.skip("there is no firmware yet")
    assert {"main.py", "lib/steering.mpy", "lib/avoid.mpy"} <= {file.name for file in build.build(tmp_path / "out", build.FIRMWARE)}


# --- what is kept


def test_backups_are_never_overwritten():
    first = keep.backup(b"1", "ab")
    second = keep.backup(b"2", "ab")
    assert first != second and keep.backup(b"1", "ab") == first
    assert [path.read_bytes() for path in keep.backups("ab")] == [b"2", b"1"]


def test_a_damaged_file_system_is_kept_and_named(tmp_path):
    partition = tmp_path / "files.bin"
    partition.write_bytes(b"\x00littlefs" + bytes(8183))
    with pytest.raises(FlashError, match="files.bin is damaged"):
        rescue.extract(partition, "robot.json")
    assert partition.exists()


# --- the command line


def test_dry_run_touches_nothing(home, capsys, monkeypatch):
    monkeypatch.setattr(flow.fit, "check", lambda settings, sources: "it fits")
    before = sorted(home.rglob("*"))
    assert command_line.main(["--dry-run", "--port", "/dev/ttyUSB0"]) == 0
    printed = capsys.readouterr().out
    assert "--port /dev/ttyUSB0 --baud 460800 erase-flash" in printed
    assert "write-flash 0x1000 ESP32_GENERIC-20241025-v1.24.0.bin" in printed
    assert command_line.main(["--dry-run", "--deploy"]) == 0
    assert "erase-flash" not in capsys.readouterr().out
    assert sorted(home.rglob("*")) == before


def test_dry_run_makes_the_same_checks(tmp_path, capsys, monkeypatch):
    other = tmp_path / "text.bin"
    other.write_text("no image at all, but a text")
    assert command_line.main(["--dry-run", "--firmware", str(other)]) == 1
    assert "no ESP32 image" in capsys.readouterr().err
    monkeypatch.setattr(flow.fit, "check", refuse)
    assert command_line.main(["--dry-run"]) == 1
    assert "switch the screen off" in capsys.readouterr().err


def test_a_failure_is_told_with_its_remedy(capsys):
    assert command_line.main(["--port", "/dev/nowhere"]) == 1
    assert "  -> check the cable" in capsys.readouterr().err


@pytest.mark.parametrize(
    "said, told",
    [
        ("[Errno 13] Permission denied: '/dev/ttyUSB0'", "dialout"),
        ("Failed to connect to ESP32: No serial data received.", "BOOT button"),
        ("This chip is ESP32-S3, not ESP32. Wrong chip argument?", "plain ESP32"),
        ("mpremote: failed to access /dev/ttyUSB0 (it may be in use by another program)", "close the program"),
        ("OSError: [Errno 28] ENOSPC", "not enough room"),
        ("mpremote: could not enter raw repl", "EN (reset) button"),
        ("No module named esptool", "make setup"),
    ],
)
def test_remedies(said, told):
    assert told in tools.remedy(said)


def test_a_default_robot_json_that_the_robot_would_refuse_is_not_written(connect, perform, sources):
    (sources / "robot.json").write_text('{"avoid": {"margin": 900}}')
    emulated = connect()
    emulated.install()
    with pytest.raises(FlashError, match=r"robot\.json .*avoid\.margin = 900"):
        perform(flow.DEPLOY, emulated)
    assert emulated.get("main.py") is None and emulated.get("robot.json") is None
