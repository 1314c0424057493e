"""What the tools say to somebody who starts them with a Python that has none of their packages."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOLS = sorted(path.parent.name for path in (ROOT / "host").glob("*/__main__.py"))


@pytest.mark.parametrize("tool", TOOLS)
def test_a_missing_package_is_named_with_the_cure(tool):
    # -S: nothing of site-packages.
    done = subprocess.run([sys.executable, "-S", "-m", f"host.{tool}", "--help"], cwd=ROOT, capture_output=True, text=True, timeout=60)
    if done.returncode:
        assert done.returncode == 1 and done.stderr.count("\n") == 1
        assert "is not installed for this Python; run `make setup` and use .venv/bin/python" in done.stderr
    else:
        assert "usage" in done.stdout  # it needs none for that


def test_the_twin_s_address_needs_numpy_and_says_so():
    done = subprocess.run([sys.executable, "-S", "-m", "host.monitor", "twin:z", "--no-browser"], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "numpy is not installed" in done.stderr and done.stderr.count("\n") == 1
