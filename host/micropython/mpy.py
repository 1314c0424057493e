"""Reads .mpy files, and finds in them what a firmware takes of the ESP32's memory for machine code.

Source: MicroPython py/persistentcode.c (the .mpy file).
"""

import re
import subprocess
import tempfile
from pathlib import Path

from .ports import cross_compiler

_BYTECODE, _NATIVE, _VIPER = 2, 3, 4
_HAS_CODE = re.compile(r"^\s*@micropython\.(viper|native)", re.MULTILINE)


class FormatError(Exception):
    """The .mpy file is not as this reader knows it: mpy-cross has changed, and mpy.py must follow."""


def compile_for_esp32(source):
    """Bytes of the .mpy file of a source text. SyntaxError if it does not compile, ToolMissing without mpy-cross."""
    with tempfile.TemporaryDirectory() as folder:
        path, target = Path(folder) / "m.py", Path(folder) / "m.mpy"
        path.write_text(source)
        done = subprocess.run([cross_compiler(), "-march=xtensawin", "-o", str(target), str(path)], capture_output=True, text=True)
        if done.returncode:
            raise SyntaxError(f"does not compile for the ESP32:\n{done.stderr.strip()}")
        return target.read_bytes()


def viper_functions(data):
    """Machine code of the viper functions of an .mpy file, in order, [bytes]. FormatError if it cannot be read."""
    return [code for kind, code in _functions(data) if kind == _VIPER]


def machine_code_bytes(firmware):
    """{module path relative to the firmware: bytes of machine code on the ESP32} of a folder with main.py and lib/."""
    out = {}
    for path in [firmware / "main.py", *sorted((firmware / "lib").rglob("*.py"))]:
        source = path.read_text()
        if _HAS_CODE.search(source):
            out[path.relative_to(firmware).as_posix()] = sum(len(code) for _, code in _functions(compile_for_esp32(source)))
    return out


def _functions(data):
    """[(kind, machine code)] of the functions in an .mpy file."""
    reader = _Reader(data)
    if reader.take(2) != b"M\x06":
        raise FormatError("not an .mpy file of version 6")
    reader.take(2)
    names, objects = reader.number(), reader.number()
    for _ in range(names):
        length = reader.number()
        if not length & 1:
            reader.take((length >> 1) + 1)
    for _ in range(objects):
        reader.skip_object()
    found: list[tuple[int, bytes]] = []
    reader.code(found)
    return found


class _Reader:
    def __init__(self, data):
        self._data = data
        self._at = 0

    def take(self, count):
        out = self._data[self._at : self._at + count]
        if len(out) < count:
            raise FormatError("the .mpy file ends too early")
        self._at += count
        return out

    def number(self):
        value = 0
        while True:
            (byte,) = self.take(1)
            value = value << 7 | byte & 127
            if byte < 128:
                return value

    def skip_object(self):
        kind = self.take(1)[0]
        if kind <= 4:  # function table, None, False, True, ...
            return
        count = self.number()
        if kind == 10:
            for _ in range(count):
                self.skip_object()
        else:
            self.take(count + (kind in (5, 6)))

    def code(self, found):
        head = self.number()
        kind, length = (head & 3) + _BYTECODE, head >> 3
        data = self.take(length)
        if kind in (_VIPER, _NATIVE):
            self.number()  # flags of the scope; or where the prelude begins
            found.append((kind, data))
        elif kind != _BYTECODE:
            raise FormatError("assembler code in the firmware")
        if head & 4:
            for _ in range(self.number()):
                self.code(found)
