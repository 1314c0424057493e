"""The ESP32's ROM loader and esptool's flasher stub, at their bytes, over a flash memory kept in a file.

SLIP frames (RFC 1055): C0, content with C0 -> DB DC and DB -> DB DD, C0.
Request: 00, command u8, length u16, check u32, data. Response: 01, command, length, value u32, body, status u8, error u8 (the ROM adds two
zero bytes). Source: Espressif, "Serial Protocol", docs.espressif.com/projects/esptool.
"""

import hashlib
import struct
import zlib
from pathlib import Path

FLASH_SIZE = 4 << 20
MAC = bytes.fromhex("a0b7656c1f2d")
ESP32_MAGIC = 0x00F01D83
ESP32_S2_MAGIC = 0x000007C6

_EFUSE = 0x3FF5A000
_FLASH_ID = 0x1640EF  # a 4 MiB Winbond
_SPI_W0 = 0x3FF42080
_UNKNOWN = 5  # error code of the ROM


def efuse_mac() -> dict[int, int]:
    """The two eFuse words a MAC address sits in."""
    return {_EFUSE + 4: int.from_bytes(MAC[2:], "big"), _EFUSE + 8: int.from_bytes(MAC[:2], "big")}


def fuses(package: int) -> int:
    """eFuse word 3, in which the package number sits."""
    return (package & 7) << 9 | package >> 3 << 2


class Flash:
    """4 MiB of NOR flash in a file, so that a MicroPython beside this process can mount its part of it."""

    def __init__(self, path: Path):
        self.path = path
        if not path.exists():
            self.erase()

    def erase(self) -> None:
        self.path.write_bytes(b"\xff" * FLASH_SIZE)

    def read(self, at: int, size: int) -> bytes:
        with open(self.path, "rb") as file:
            file.seek(at)
            return file.read(size)

    def write(self, at: int, data: bytes) -> None:
        with open(self.path, "r+b") as file:
            file.seek(at)
            file.write(data)


class Loader:
    """Takes the bytes esptool sends, through `receive`; answers through `send`.

    `spoil` makes every write store a wrong byte; `magic` is the number by which esptool knows the chip, `package` the number in its eFuses that
    tells what else is in the housing.
    """

    def __init__(self, flash: Flash, send, magic: int = ESP32_MAGIC, spoil: bool = False, package: int = 0):
        self.flash, self.spoil = flash, spoil
        self._send = send
        self._registers = {0x40001000: magic, 0x3FF40014: 347, _SPI_W0: _FLASH_ID, _EFUSE + 12: fuses(package), **efuse_mac()}
        self._partial = b""
        self._stub = False
        self._reading: list[bytes] = []
        self._at = 0
        self.commands: list[int] = []  # every command received, in order

    def receive(self, data: bytes) -> None:
        self._partial += data
        while True:
            start = self._partial.find(b"\xc0")
            end = self._partial.find(b"\xc0", start + 1)
            if start < 0 or end < 0:
                return
            frame = self._partial[start + 1 : end].replace(b"\xdb\xdc", b"\xc0").replace(b"\xdb\xdd", b"\xdb")
            self._partial = self._partial[end + (1 if frame else 0) :]
            if self._reading:
                self._reading.pop()  # an acknowledgement of a block read; all blocks are under way already
            elif len(frame) >= 8:
                self._answer(frame)

    def _answer(self, frame: bytes) -> None:
        _, command, length, _ = struct.unpack_from("<BBHI", frame)
        data = frame[8 : 8 + length]
        self.commands.append(command)
        action = _COMMANDS.get(command)
        if action is None:
            self._respond(command, error=_UNKNOWN)
        else:
            action(self, command, data)

    def _respond(self, command: int, value: int = 0, body: bytes = b"", error: int = 0) -> None:
        status = bytes((1 if error else 0, error)) + (b"" if self._stub else b"\0\0")
        self._frame(struct.pack("<BBHI", 1, command, len(body + status), value) + body + status)

    def _frame(self, content: bytes) -> None:
        self._send(b"\xc0" + content.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc") + b"\xc0")

    def _sync(self, command, data):
        self._stub = False
        for _ in range(8):
            self._respond(command, value=0x20120707)

    def _accept(self, command, data):
        self._respond(command)

    def _run_stub(self, command, data):
        self._respond(command)
        self._stub = True
        self._frame(b"OHAI")

    def _read_register(self, command, data):
        self._respond(command, value=self._registers.get(struct.unpack("<I", data)[0], 0))

    def _begin(self, command, data):
        _, _, _, self._at = struct.unpack_from("<IIII", data)
        self._inflate = zlib.decompressobj()
        self._respond(command)

    def _compressed(self, command, data):
        self._store(self._inflate.decompress(data[16:]))
        self._respond(command)

    def _plain(self, command, data):
        self._store(data[16:])
        self._respond(command)

    def _store(self, content: bytes) -> None:
        if self.spoil and content:
            content = bytes((content[0] ^ 1,)) + content[1:]
        self.flash.write(self._at, content)
        self._at += len(content)

    def _md5(self, command, data):
        at, size = struct.unpack_from("<II", data)
        digest = hashlib.md5(self.flash.read(at, size))
        self._respond(command, body=digest.digest() if self._stub else digest.hexdigest().encode())

    def _erase(self, command, data):
        self.flash.erase()
        self._respond(command)

    def _read_flash(self, command, data):
        at, size, block, _ = struct.unpack("<IIII", data)
        content = self.flash.read(at, size)
        self._respond(command)
        blocks = [content[i : i + block] for i in range(0, size, block)]
        self._reading = blocks[:]
        for part in blocks:
            self._frame(part)
        self._frame(hashlib.md5(content).digest())


_COMMANDS = {
    0x02: Loader._begin,
    0x03: Loader._plain,
    0x04: Loader._accept,
    0x05: Loader._accept,
    0x06: Loader._run_stub,
    0x07: Loader._accept,
    0x08: Loader._sync,
    0x09: Loader._accept,
    0x0A: Loader._read_register,
    0x0B: Loader._accept,
    0x0D: Loader._accept,
    0x0F: Loader._accept,
    0x10: Loader._begin,
    0x11: Loader._compressed,
    0x12: Loader._accept,
    0x13: Loader._md5,
    0xD0: Loader._erase,
    0xD2: Loader._read_flash,
}
