"""Tries the project under each other Python that is at hand: python tools/try_pythons.py [3.12 3.13 ...]

Each gets a virtual environment of its own in build/, the firmware's tests, and one run of the twin. What is not installed is named and left out.
Exit code: 0 all passed, 1 one failed.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VERSIONS = ("3.11", "3.12", "3.13")


def find(version: str) -> str | None:
    """Path of that Python: on the search path, or among those of pyenv."""
    installed = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    candidates = [*sorted(installed.glob(f"{version}.*/bin/python"), reverse=True), shutil.which(f"python{version}")]
    for found in filter(None, candidates):
        if subprocess.run([found, "-c", "import venv, ensurepip"], capture_output=True).returncode == 0:
            return str(found)
    return None


def passes(version: str, python: str) -> bool:
    """Whether all that is tried under it passes."""
    folder = ROOT / "build" / f"python-{version}"
    own = str(folder / "bin" / "python")
    steps = (
        [python, "-m", "venv", "--clear", str(folder)],
        [own, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-e", ".[test]"],
        [own, "-m", "pytest", "-q", "-k", "not micropython", "tests/firmware"],
        [own, "-m", "host.twin", "Z", "--width", "550", "--engine", "cpython", "--chip", "inf"],
    )
    return all(subprocess.run(step, cwd=ROOT).returncode == 0 for step in steps)


def main(versions: list[str]) -> int:
    failed = []
    for version in versions or VERSIONS:
        python = find(version)
        print(f"Python {version}: {'trying' if python else 'not at hand, left out'}", flush=True)
        if python and not passes(version, python):
            failed.append(version)
    print(f"failed under Python {', '.join(failed)}" if failed else "all that are at hand pass")
    return bool(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
