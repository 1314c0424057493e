"""Gets a file out of a board whose MicroPython does not answer: from the raw bytes of its file system."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from host.boards.errors import FlashError

from . import rom, tools

_MARK = b"littlefs"  # in the superblock of every littlefs

# Run by the MicroPython of this machine: it mounts the partition as the board would, and prints the file
_EXTRACT = """
import sys, vfs

class Partition:
    def __init__(self, path):
        self.file = open(path, 'rb')
        self.blocks = self.file.seek(0, 2) // 4096

    def readblocks(self, block, buffer, offset=0):
        self.file.seek(block * 4096 + offset)
        self.file.readinto(buffer)

    def writeblocks(self, block, buffer, offset=0):
        raise OSError(30)  # read only

    def ioctl(self, request, argument):
        return {4: self.blocks, 5: 4096}.get(request, 0)

try:
    vfs.mount(vfs.VfsLfs2(Partition(sys.argv[1])), '/board')
    with open('/board/' + sys.argv[2], 'rb') as file:
        sys.stdout.buffer.write(file.read())
except OSError as error:
    sys.exit(2 if error.errno == 2 else 1)
"""


def extract(partition: Path, name: str) -> bytes | None:
    """One file of a littlefs image; None if the file system holds no such file. Raises FlashError if it cannot be read."""
    beside = Path(sys.executable).with_name("micropython")
    interpreter = str(beside) if beside.exists() else shutil.which("micropython")
    if interpreter is None:
        raise FlashError("the MicroPython interpreter of this machine is missing", "install what this needs: make setup")
    with tempfile.NamedTemporaryFile("w", suffix=".py") as script:
        script.write(_EXTRACT)
        script.flush()
        done = subprocess.run([interpreter, script.name, str(partition), name], capture_output=True)
    if done.returncode == 2:
        return None
    if done.returncode:
        raise FlashError(f"the file system saved in {partition} is damaged: {done.stderr.decode(errors='replace').strip()}",
                         "keep that file if the settings matter; to go on without them: BLANK=1")  # fmt: skip
    return done.stdout


def read_partition(port: str, target: Path, baud: int) -> bool:
    """Read the board's file system into `target`; False, and no file, if the board has none."""
    with tempfile.TemporaryDirectory() as folder:
        head = Path(folder) / "head"
        tools.show(rom.read_command(port, rom.HEAD_SIZE, head, baud))
        if _MARK not in head.read_bytes():
            return False
    target.parent.mkdir(parents=True, exist_ok=True)
    tools.show(rom.read_command(port, rom.FILES_SIZE, target, baud))
    return True
