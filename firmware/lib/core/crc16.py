"""CRC-16 (Modbus: initial value 0xFFFF, reflected polynomial 0xA001), used by the lidar and by the telemetry frames."""

from array import array

import micropython

TABLE = array("H", range(16))
for _nibble in range(16):
    _value = _nibble
    for _ in range(4):
        _value = (_value >> 1) ^ 0xA001 if _value & 1 else _value >> 1
    TABLE[_nibble] = _value


@micropython.viper
def crc16(data: ptr8, start: int, end: int) -> int:
    """CRC-16 of data[start:end], 0..65535.

    A table of 16 entries makes it about 60 instructions a byte; bit by bit it would be 200, and with 256 entries 40.
    """
    table = ptr16(TABLE)
    value = 0xFFFF
    while start < end:
        value = value ^ data[start]
        value = (value >> 4) ^ table[value & 15]
        value = (value >> 4) ^ table[value & 15]
        start += 1
    return value
