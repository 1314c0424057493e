"""Installs the host's packages with pip, for `make setup`: says what it is doing, and takes wheels that lie at hand first.

    python tools/install.py [--wheels FOLDER] REQUIREMENT...     inside the virtual environment

With a folder of wheels (`make setup WHEELS=FOLDER`, or wheels/ in the checkout) nothing is fetched if all are there; what is missing is fetched. Only Python's own modules are used.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

KEPT = 15  # lines of pip's last words when it fails
STEP = re.compile(r"^\s*(Collecting|Downloading|Using cached|Processing|Building|Preparing|Installing|Requirement already satisfied:)\s*(.*)")
WORDS = {"Using cached": "taking from the cache", "Processing": "taking", "Requirement already satisfied:": "has"}


def main(arguments=None):
    """Exit code: pip's."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--wheels", type=Path, default=Path("wheels"), metavar="FOLDER", help="wheels to take (default wheels/, where it exists)")
    parser.add_argument("requirements", nargs="+", metavar="REQUIREMENT")
    options = parser.parse_args(arguments)
    editable = [part for name in options.requirements for part in (("-e", name) if name.startswith(".") else (name,))]
    if options.wheels.is_dir():
        wheels = ["--find-links", str(options.wheels)]
        print(f"Wheels in {options.wheels}: {len(list(options.wheels.glob('*.whl')))}", flush=True)
        code, _ = pip([*wheels, "--no-index", *editable])
        if code == 0:
            return 0
        print("Not all packages are among them: the others are fetched.", flush=True)
    elif options.wheels != Path("wheels"):
        print(f"There is no folder {options.wheels}: name one with wheels in it (make setup WHEELS=FOLDER)", file=sys.stderr)
        return 2
    else:
        wheels = []
    code, said = pip([*wheels, *editable])
    if code:
        print("".join(said[-KEPT:]), end="", file=sys.stderr)
        print("pip could not install the packages: see above; with no network, put the wheels into a folder and say make setup WHEELS=FOLDER", file=sys.stderr)
    return code


def pip(arguments):
    """Run pip install; (its exit code, all lines it said)."""
    command = [sys.executable, "-m", "pip", "install", "--disable-pip-version-check", "--progress-bar", "off", *arguments]
    show = Shower(sys.stdout)
    said = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace") as process:
        for line in process.stdout:
            said.append(line)
            show.line(line)
    show.end()
    return process.returncode, said


class Shower:
    """Shows pip's steps: on a terminal in one line that changes, elsewhere every tenth."""

    def __init__(self, out):
        self._out = out
        self._terminal = out.isatty()
        self._steps = 0
        self._wide = 0

    def line(self, text):
        """A line of pip's."""
        found = STEP.match(text)
        if not found:
            return
        self._steps += 1
        what = found[2].split(" (from")[0].split("/")[-1] if found[1] == "Processing" else found[2].split(" (from")[0].split(" in ./")[0]
        shown = f"  {self._steps:3d}  {WORDS.get(found[1], found[1].lower())} {what}"[:100]
        last = found[1] == "Installing" and "collected" in text
        if last:
            shown = f"  {self._steps:3d}  unpacking {text.count(',') + 1} packages: this takes a while"
        if self._terminal:
            self._out.write("\r" + shown.ljust(self._wide))
            self._wide = len(shown)
        elif last or self._steps % 10 == 1:
            self._out.write(shown + "\n")
        self._out.flush()

    def end(self):
        """Leave the line."""
        if self._terminal and self._wide:
            self._out.write("\n")
            self._out.flush()


if __name__ == "__main__":
    sys.exit(main())
