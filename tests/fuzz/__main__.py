"""python -m tests.fuzz TARGET [SECONDS]: feeds one of the targets with bytes that atheris finds by what of the code they reach.

TARGET is wire, message, recording, robot or all (one after the other). Exit status 0: nothing came out that should not. Else atheris
tells the exception and leaves the bytes in a file crash-..., which `python -m tests.fuzz TARGET FILE` feeds again.
"""

import subprocess
import sys

try:
    import atheris
except ImportError:
    sys.exit("atheris is not installed: .venv/bin/pip install atheris (Linux, and only for some versions of Python)")

with atheris.instrument_imports(include=["host.link", "host.recording", "params", "link"]):
    from tests.fuzz import targets


def _recording(data: bytes) -> None:
    """Records with the right check, else nothing behind the check would ever be reached; odd lengths are the file's own bytes."""
    if len(data) % 2:
        return targets.read_recording(targets.recording.MAGIC + data)
    read = atheris.FuzzedDataProvider(data)
    records = []
    while read.remaining_bytes():
        records.append((read.ConsumeIntInRange(0, 255), read.ConsumeIntInRange(0, 2**40), read.ConsumeBytes(read.ConsumeIntInRange(0, 80))))
    return targets.read_recording(targets.whole_recording(records))


def _message(data: bytes) -> None:
    if data:
        targets.message(data[0], data[1:])


TARGETS = {"wire": lambda data: targets.wire([data]), "message": _message, "recording": _recording, "robot": targets.robot_text}


def main() -> int:
    """Run the command line; returns the exit status."""
    name = sys.argv[1] if len(sys.argv) > 1 else "all"
    how = sys.argv[2] if len(sys.argv) > 2 else "30"
    if name == "all":
        return max(subprocess.call([sys.executable, "-m", "tests.fuzz", each, how]) for each in TARGETS)
    if name not in TARGETS:
        sys.exit(f"{name}: one of {', '.join(TARGETS)} or all is needed")
    atheris.Setup([sys.argv[0], f"-max_total_time={how}" if how.isdigit() else how, "-max_len=2000", "-verbosity=0"], TARGETS[name])
    atheris.Fuzz()
    return 0


if __name__ == "__main__":
    sys.exit(main())
