"""Hears the buttons of a Nextion screen, which tells a touch as 65 page component event; the event 1 is a press."""

from micropython import const

_COMPONENT = const(3)  # is known; it counts in sixteens above
_PRESSED = const(4096)


def hear(state, byte):
    """The state after a byte, 0 at first; 4096 + n: component n was pressed."""
    if state == 0:
        return 1 if byte == 0x65 else 0
    if state == 1:
        return 2
    if state == 2:
        return _COMPONENT + (byte << 4)
    return _PRESSED + (state >> 4) if byte == 1 else 0
