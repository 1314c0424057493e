"""An ESP32 board on a pseudo-terminal: ROM loader, then MicroPython's prompt, over one flash memory.

What is real: the bytes on the line; MicroPython itself (the unix port) with a littlefs on the flash's file partition, so that the commands
mpremote sends really run. What is not: reset over DTR and RTS (a pseudo-terminal has no such lines; here a SLIP frame is taken for a reset
into the loader, and anything else after it for the reset out of it), the rate, and the firmware, whose compiled modules are for another
processor: a board that would start it sends `hello` instead.
"""

import os
import select
import struct
import subprocess
import sys
import threading
import tty
from pathlib import Path

from emulated_rom import ESP32_MAGIC, MAC, Flash, Loader, fuses

_WINDOW = 128  # bytes of raw paste the board takes before it grants more
_RESET = 42  # exit status that stands for machine.reset()
_RAW = b"raw REPL; CTRL-B to exit\r\n>"
_FRIENDLY = b'\r\nMicroPython v1.24.0 on 2024-10-25; Generic ESP32 module with ESP32\r\nType "help()" for more information.\r\n>>> '

# Runs in the MicroPython of the board: snippets come in with their length before them, and leave as the raw REPL puts it
_DRIVER = """
import io, os, sys, vfs

class Partition:
    def __init__(self, path, start, size):
        self.file, self.start, self.size = open(path, 'r+b'), start, size
    def readblocks(self, block, buffer, offset=0):
        self.file.seek(self.start + block * 4096 + offset)
        self.file.readinto(buffer)
    def writeblocks(self, block, buffer, offset=0):
        self.file.seek(self.start + block * 4096 + offset)
        self.file.write(buffer)
        self.file.flush()
    def ioctl(self, request, argument):
        return {4: self.size // 4096, 5: 4096}.get(request, 0)

class Machine:
    mem32 = {0x3FF5A00C: int(sys.argv[4])}
    def unique_id(self):
        return bytes.fromhex(sys.argv[3])
    def reset(self):
        sys.exit(RESET)

class Implementation:
    name, version, _machine = 'micropython', (1, 24, 0, ''), sys.argv[5]
    def __getitem__(self, item):
        return self.version

class Sys:
    implementation = Implementation()

class Gc:
    def collect(self):
        pass
    def mem_alloc(self):
        return 20000
    def mem_free(self):
        return int(sys.argv[6]) - 20000

for name in dir(sys):
    if not hasattr(Sys, name):
        setattr(Sys, name, getattr(sys, name))
partition = Partition(sys.argv[1], 0x200000, int(sys.argv[2]))
sys.modules['machine'] = Machine()
sys.modules['gc'] = Gc()
sys.modules['sys'] = Sys
vfs.umount('/')
try:
    vfs.mount(partition, '/')
except OSError:
    vfs.VfsLfs2.mkfs(partition)
    vfs.mount(partition, '/')
os.chdir('/')
space = {'__name__': '__main__'}
take, give = sys.stdin.buffer.read, sys.stdout.buffer.write
while True:
    code = take(int.from_bytes(take(4), 'little'))
    error = io.StringIO()
    try:
        exec(code, space)
    except SystemExit:
        raise
    except BaseException as problem:
        sys.print_exception(problem, error)
    give(b'\\x04' + error.getvalue().replace('\\n', '\\r\\n').encode() + b'\\x04')
"""


class EmulatedBoard:
    """A board; `port` is the name of its serial port. A context manager.

    hello: what the firmware says at its start. file_space: bytes of the file system (a small one fills up).
    magic, spoil, package: see `emulated_rom.Loader`. name: what MicroPython calls the board; heap: bytes that it has. deaf: MicroPython never answers, as when a program does not let go of the prompt.
    """

    def __init__(self, folder: Path, hello: bytes = b"", file_space: int = 0x200000, magic: int = ESP32_MAGIC, spoil: bool = False, deaf: bool = False,
                 package: int = 0, name: str = "Generic ESP32 module with ESP32", heap: int = 167_000):  # fmt: skip
        self.flash = Flash(folder / "flash.bin")
        self.loader = Loader(self.flash, self._send, magic, spoil, package)
        self.hello, self.file_space, self.deaf = hello, file_space, deaf
        self._board = [str(fuses(package)), name, str(heap)]
        self.power_cycles = 0
        self._driver = folder / "driver.py"
        self._driver.write_text(_DRIVER.replace("RESET", str(_RESET)))
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.port = os.ttyname(self._slave)
        self._python: subprocess.Popen | None = None
        self._state = self._off
        self._wake, self._stop = os.pipe()
        self._thread = threading.Thread(target=self._serve, daemon=True)

    def __enter__(self) -> "EmulatedBoard":
        self._state = self._friendly if self.flash.read(0x1000, 1) == b"\xe9" else self._off
        self._thread.start()
        return self

    def __exit__(self, *_) -> None:
        os.write(self._stop, b"x")
        self._thread.join()
        self._end_python()
        for handle in (self._master, self._slave, self._wake, self._stop):
            os.close(handle)

    # --- what a test puts on the board and finds there

    def install(self, image: bytes = b"\xe9" + bytes(15)) -> None:
        """As if MicroPython had been flashed before."""
        self.flash.write(0x1000, image)
        self._state = self._friendly

    def put(self, files: dict[str, bytes]) -> None:
        """Write files into the board's file system; folders are made."""
        for name, data in files.items():
            folder = name.rpartition("/")[0]
            self._execute(f"import os\ntry:\n os.mkdir({folder!r})\nexcept OSError: pass" if folder else "")
            self._execute(f"open({name!r}, 'wb').close()")
            for start in range(0, len(data), 4096):
                self._execute(f"with open({name!r}, 'ab') as f: f.write({data[start : start + 4096]!r})")
        self._end_python()

    def get(self, name: str) -> bytes | None:
        """Content of a file of the board; None if it is not there."""
        output = self._execute(f"try:\n print(repr(open({name!r}, 'rb').read()))\nexcept OSError: print(None)")
        self._end_python()
        return eval(output)

    # --- the line

    def _send(self, data: bytes) -> None:
        while data:
            _, writable, _ = select.select([], [self._master], [], 5)
            if not writable:
                return  # nobody listens, and the line is full
            data = data[os.write(self._master, data[:1024]) :]

    def _serve(self) -> None:
        while True:
            readable, _, _ = select.select([self._master, self._wake], [], [])
            if self._wake in readable:
                return
            data = os.read(self._master, 4096)
            if self._state != self._raw_code and self._state != self._paste and data.startswith(b"\xc0"):
                self._end_python()
                self._state = self._rom
            while data:
                data = self._state(data)

    def _off(self, data: bytes) -> bytes:
        """Nothing to start: the ROM resets the chip again and again."""
        self._send(b"ets Jul 29 2019 12:21:46\r\n\r\nrst:0x10 (RTCWDT_RTC_RESET),boot:0x13\r\ninvalid header: 0xffffffff\r\n" * 2)
        return b""

    def _rom(self, data: bytes) -> bytes:
        if data.startswith((b"\r", b"\x03")):
            self._boot(b"rst:0x1 (POWERON_RESET)")
            return data
        self.loader.receive(data)
        return b""

    def _boot(self, reason: bytes) -> None:
        self.power_cycles += 1
        self._state = self._friendly
        if self.flash.read(0x1000, 1) != b"\xe9":
            self._state = self._off
            return
        self._send(b"ets Jul 29 2019 12:21:46\r\n\r\n" + reason + b",boot:0x13 (SPI_FAST_FLASH_BOOT)\r\n")
        has_firmware = eval(self._execute("import os; print('main.py' in os.listdir('/'))"))
        self._send(self.hello if has_firmware else _FRIENDLY)

    # --- MicroPython's prompt: friendly, raw, and raw paste

    def _friendly(self, data: bytes) -> bytes:
        first, rest = data[:1], data[1:]
        if self.deaf:
            return b""
        if first == b"\x03":
            self._send(_FRIENDLY)
        elif first == b"\x01":
            self._enter_raw()
        return rest

    def _enter_raw(self) -> None:
        self._send(_RAW)
        self._code = b""
        self._state = self._raw_code

    def _raw_code(self, data: bytes) -> bytes:
        first, rest = data[:1], data[1:]
        if not self._code and data.startswith(b"\x05A\x01"):
            self._send(b"R\x01" + struct.pack("<H", _WINDOW) + b"\x01")
            self._state, self._granted = self._paste, 2 * _WINDOW
            return data[3:]
        if first == b"\x01":
            self._enter_raw()
        elif first == b"\x02":
            self._send(_FRIENDLY)
            self._state = self._friendly
        elif first == b"\x03":
            self._code = b""
        elif first == b"\x04":
            self._run(b"OK") if self._code else self._soft_reset()
        elif self._code or first not in b"\r\n":
            self._code += first
        return rest

    def _paste(self, data: bytes) -> bytes:
        code, end, rest = data.partition(b"\x04")
        before = len(self._code) // _WINDOW
        self._code += code
        assert len(self._code) <= self._granted, "more was sent than the board had granted"
        grants = len(self._code) // _WINDOW - before
        self._granted += grants * _WINDOW
        self._send(b"\x01" * grants)
        if end:
            self._state = self._raw_code
            self._run(b"\x04")
        return rest

    def _soft_reset(self) -> None:
        self._end_python()
        self._send(b"OK\r\nMPY: soft reboot\r\n")
        self._enter_raw()

    def _run(self, acknowledgement: bytes) -> None:
        code, self._code = self._code, b""
        self._send(acknowledgement)
        for part in self._snippet(code):
            self._send(part)
        if self._python.poll() == _RESET:
            self._end_python()
            self._boot(b"rst:0xc (SW_CPU_RESET)")
        else:
            self._send(b">")

    def _execute(self, code: str) -> str:
        return b"".join(self._snippet(code.encode())).partition(b"\x04")[0].decode()

    def _snippet(self, code: bytes):
        """Run code; yields the output as it comes: text, 04, error, 04."""
        if self._python is None:
            interpreter = Path(sys.executable).with_name("micropython")
            command = [str(interpreter), "-X", "heapsize=160k", str(self._driver), str(self.flash.path), str(self.file_space), MAC.hex(), *self._board]
            self._python = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._python.stdin.write(struct.pack("<I", len(code)) + code)
        self._python.stdin.flush()
        ends = 0
        while ends < 2:
            part = os.read(self._python.stdout.fileno(), 4096)
            if not part:
                self._python.wait()
                return
            ends += part.count(b"\x04")
            yield part

    def _end_python(self) -> None:
        if self._python:
            self._python.kill()
            self._python.wait()
            self._python.stdin.close()
            self._python.stdout.close()
            self._python = None
