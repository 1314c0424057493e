"""viper's pointer types for CPython: unsigned views of a buffer's memory."""

from array import array

_SHORT = 64  # longer ones are tables, and would take too long to look through
_SIZES = {"B": 1, "H": 2, "I": 4}


def _view(buffer, code):
    if isinstance(buffer, memoryview) and buffer.format == code:
        return buffer
    view = memoryview(buffer).cast("B")
    return view if code == "B" else view[: len(view) // _SIZES[code] * _SIZES[code]].cast(code)


def ptr8(buffer):
    """Bytes of a buffer, 0..255 each."""
    return _view(buffer, "B")


def ptr16(buffer):
    """Half words of a buffer, 0..65535 each: two's complement is not undone, exactly as in viper."""
    return _view(buffer, "H")


def ptr32(buffer):
    """Words of a buffer, 0..2**32 - 1 each. ValueError if a short list of signed words holds a negative one.

    Such a word is negative in viper on the ESP32, but not where pointers have 64 bits.
    """
    if isinstance(buffer, array) and buffer.typecode == "i" and len(buffer) <= _SHORT and min(buffer) < 0:
        raise ValueError(f"word {buffer.index(min(buffer))} handed to viper is {min(buffer)}: add a bias to it, or take it modulo a turn")
    return _view(buffer, "I")


def uint(value):
    """An integer as an unsigned machine word of 32 bits."""
    return int(value) & 0xFFFFFFFF


def pointer_parameters(function):
    """[(position, conversion)] of the parameters annotated ptr8, ptr16 or ptr32."""
    conversions = {ptr8: ptr8, ptr16: ptr16, ptr32: ptr32, "ptr8": ptr8, "ptr16": ptr16, "ptr32": ptr32}
    annotations = function.__annotations__
    names = function.__code__.co_varnames[: function.__code__.co_argcount]
    return [(i, conversions[annotations[n]]) for i, n in enumerate(names) if annotations.get(n) in conversions]
