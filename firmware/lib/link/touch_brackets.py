"""Hears the buttons of a screen that tells a touch as [BN:n]."""

from micropython import const

_BEGIN = b"[BN:"
_NUMBER = const(4)  # all of it has been matched; the number so far counts in sixteens above
_PRESSED = const(4096)


def hear(state, byte):
    """The state after a byte, 0 at first; 4096 + n: button n was pressed. Whether an end of line follows is not documented, so the brackets count."""
    if byte == _BEGIN[0]:
        return 1
    if 0 < state < _NUMBER and byte == _BEGIN[state]:
        return state + 1
    if state & 15 == _NUMBER:
        if byte == 0x5D:
            return _PRESSED + (state >> 4)
        if 0x30 <= byte <= 0x39 and state < 16 * 10:
            return _NUMBER + ((state >> 4) * 10 + byte - 0x30 << 4)
    return 0
