"""Every test of the firmware runs twice: here in CPython (but for those named after what is allocated), and in the real MicroPython with the board's word size, where it is named test_...[micropython].

One MicroPython process runs the selected tests of one file (tests/firmware/runner.py). All of them run in an empty folder.
"""

import ast
import math
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FIRMWARE_TESTS = ROOT / "tests" / "firmware"
TIME_LIMIT_S = 300
HEAP = 4 * 1024 * 1024  # the tests compile the sources and build robots by the dozen; what the robot has is tests/host/test_memory.py's

if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))

from host import compat, micropython
from host.twin import process

compat.install()

# A shell's background job ignores Ctrl-C, and so would all that the tests start: those that interrupt it would wait for ever.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Most tests look at what the firmware does, not at when: computing takes no time, and the start is over at once. Those for which time counts name a chip.
process.CHIP = math.inf


@pytest.fixture(autouse=True)
def _empty_folder(request):
    if FIRMWARE_TESTS in request.path.parents:
        request.getfixturevalue("monkeypatch").chdir(request.getfixturevalue("tmp_path"))


def pytest_collect_file(file_path, parent):
    if file_path.parent == FIRMWARE_TESTS and file_path.name.startswith("test_") and file_path.suffix == ".py":
        return MicroPythonFile.from_parent(parent, path=file_path)
    return None


def pytest_collection_modifyitems(config, items):
    """Whether anything is allocated is seen in MicroPython only: in CPython heap_lock() does nothing, and such a test could not fail."""
    useless = [item for item in items if FIRMWARE_TESTS in item.path.parents and "allocat" in item.name and not isinstance(item, MicroPythonItem)]
    items[:] = [item for item in items if item not in useless]
    config.hook.pytest_deselected(items=useless)


class MicroPythonFile(pytest.File):
    """The tests of one file, run by one MicroPython process when the first of them is due."""

    def collect(self):
        self._outcomes = None
        for node in ast.parse(self.path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                yield MicroPythonItem.from_parent(self, name=node.name + "[micropython]", test=node.name, line=node.lineno)

    def outcome(self, test):
        """(passed, output) of one test."""
        if self._outcomes is None:
            selected = [item.test for item in self.session.items if item.parent is self]
            with tempfile.TemporaryDirectory() as folder:
                self._outcomes = self._run(selected, folder)
        return self._outcomes.get(test, (False, self._outcomes[None]))

    def _run(self, tests, folder):
        try:
            port = micropython.find()
        except micropython.ToolMissing as missing:
            return {None: str(missing)}
        path = ":".join(map(str, (FIRMWARE_TESTS, ROOT / "firmware" / "lib")))
        command = [*port.command, "-X", f"heapsize={HEAP * port.heap_factor}", str(FIRMWARE_TESTS / "runner.py"), self.path.stem, *tests]
        try:
            process = subprocess.run(
                command, cwd=folder, env={**os.environ, "MICROPYPATH": path}, capture_output=True, text=True, errors="replace", timeout=TIME_LIMIT_S
            )
        except subprocess.TimeoutExpired as stuck:
            output = (stuck.stdout or b"").decode(errors="replace")
            return _outcomes(output, "stopped: not done after %d s" % TIME_LIMIT_S)
        return _outcomes(process.stdout, process.stderr + "the interpreter ended with code %d" % process.returncode)


def _outcomes(output, ending):
    """{test: (passed, output)} of what the runner printed; under None what stands for a test that was never finished."""
    outcomes = {}
    lines = []
    for line in output.splitlines():
        word, _, name = line.removeprefix("## ").partition(" ")
        if line.startswith("## start "):
            lines = []
        elif line.startswith(("## passed ", "## failed ")):
            outcomes[name] = (word == "passed", "\n".join(lines))
            lines = []
        else:
            lines.append(line)
    outcomes[None] = "\n".join([*lines, ending])
    return outcomes


class MicroPythonFailure(Exception):
    """A test failed under MicroPython; the text is its output."""


class MicroPythonItem(pytest.Item):
    def __init__(self, *, test, line, **kwargs):
        super().__init__(**kwargs)
        self.test = test  # not `function`: pytest takes that for a function
        self.line = line

    def runtest(self):
        passed, output = self.parent.outcome(self.test)
        if not passed:
            raise MicroPythonFailure(output)
        if output:
            self.add_report_section("call", "stdout", output)

    def repr_failure(self, excinfo):
        if isinstance(excinfo.value, MicroPythonFailure):
            return str(excinfo.value)
        return super().repr_failure(excinfo)

    def reportinfo(self):
        return self.path, self.line - 1, self.name
