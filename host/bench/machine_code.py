"""Counts instructions in what mpy-cross makes of a viper function for the ESP32 (Xtensa with register windows).

A function's code in an .mpy file begins with a jump over its constants. Instructions are two bytes long when the lower half of their first
byte is 8 or more, else three. A mark (`blocks.MARK`) is the load of its constant (l32r) and the instruction that stores it.

Source: Xtensa Instruction Set Architecture (formats, l32r, callx8).
"""

from host.micropython.mpy import FormatError, compile_for_esp32, viper_functions

from . import blocks, costs


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
