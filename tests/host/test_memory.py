"""What the robot takes of its heap; see HEAP in host/twin/process.py."""

import re
import shutil
from pathlib import Path

import pytest

from host.twin import image, process, run

PROBE = Path(__file__).with_name("memory_probe.py")
LIVE, ARRAYS, BLOCK = 199_000, 70_000, 1000  # bytes
BEFORE_THE_LOOP = "\ntry:\n    while True:"
ASK = """
import gc
import micropython
gc.collect()
print("live", gc.mem_alloc())
micropython.mem_info()
import memory_probe
memory_probe.report()
raise SystemExit
"""


def _asked(tmp_path, monkeypatch, heap, mode):
    """What the firmware prints when it is asked before its loop begins."""
    firmware = tmp_path / "firmware"
    shutil.copytree(image.FIRMWARE, firmware)
    shutil.copy(PROBE, firmware / "lib")
    main = (firmware / "main.py").read_text()
    assert BEFORE_THE_LOOP in main
    (firmware / "main.py").write_text(main.replace(BEFORE_THE_LOOP, ASK + BEFORE_THE_LOOP))
    monkeypatch.setattr(process, "HEAP", heap)
    printed = []
    original = process.Process.__init__

    def listen(self, engine, config_text, on_serial, firmware=image.FIRMWARE):
        original(self, engine, config_text, lambda data: (printed.append(data), on_serial(data)), firmware)

    monkeypatch.setattr(process.Process, "__init__", listen)
    run(record=False, course="Z", mode=mode, firmware=firmware)
    return b"".join(printed).decode(errors="replace")


def _number(pattern, text):
    found = re.search(pattern, text)
    assert found, text[-1000:]
    return int(found.group(1))


@pytest.mark.parametrize("mode", ("aws", "naws"))
def test_what_lives_after_the_start(tmp_path, monkeypatch, mode):
    said = _asked(tmp_path, monkeypatch, "2M", mode)
    live = _number(r"live (\d+)", said)
    arrays = _number(r"arrays (\d+)", said)
    print(f"live after the start {live} bytes, arrays and tables {arrays} bytes")
    assert live < LIVE
    assert arrays < ARRAYS


@pytest.mark.parametrize("mode", ("aws", "naws"))
def test_room_is_left_in_one_piece(tmp_path, monkeypatch, mode):
    said = _asked(tmp_path, monkeypatch, process.HEAP, mode)
    block = _number(r"max free sz: (\d+)", said) * 32
    print(f"largest free block {block} bytes of a heap of {process.HEAP}")
    assert block >= BLOCK  # a parameter's message


@pytest.mark.parametrize("mode, width", (("aws", 550), ("naws", 600)))
def test_it_drives_in_that_heap(mode, width):
    result = run(record=False, course="Z", width=width, mode=mode, seed=1)
    assert result.result == "pass", result.reason
    assert not result.summary()["contacts"]
    if mode == "naws":
        assert {decision.ar for decision in result.log} == {0}  # the last axle stays straight
