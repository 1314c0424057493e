"""The messages between the firmware's process and the twin, as bytes; the format is in board/lockstep.py.

The board's clock counts from its start in rounds of 2**30 us. Here all times are us since the run began.
"""

import struct
from dataclasses import dataclass

ADVANCE, READ, FLUSH, RESET = 1, 2, 3, 4
I2C_WRITE, PIN, PWM_DUTY, PWM_FREQUENCY, UART_OUTPUT = 1, 2, 3, 4, 5
REPLY, SHORT, PAYLOAD, CHUNKS = 1024, 256, 128, 4

ROUND = 1 << 30
FAR = 1 << 29  # horizons further off are as good as this one

_REQUEST = struct.Struct("<IBBHIII11iIi9s")
_EVENT = struct.Struct("<IBBH")
_WITH_DATA = (I2C_WRITE, UART_OUTPUT)


@dataclass
class Request:
    """One message of the firmware. events: [(time, kind, where, value, data)].

    now: when it was sent; target: up to when time shall pass, `now` unless kind is ADVANCE. address: of a RESET, why it resets.
    watchdog: us from `target` until the watchdog resets the board unless it is fed, -1 = there is none. kept: what the RTC's memory holds.
    """

    kind: int
    address: int
    size: int
    now: int
    target: int
    probe: tuple
    overflows: int
    watchdog: int
    kept: bytes
    events: list


def missing(data):
    """True while the bytes are no whole request."""
    return len(data) < _REQUEST.size or len(data) < int.from_bytes(data[:4], "little")


def decode(data, began):
    """The Request in the bytes. began: when the board's clock showed 0."""
    _, kind, address, size, ticks, rounds, duration, *probe, overflows, watchdog, kept = _REQUEST.unpack_from(data)
    now = began + rounds * ROUND + ticks
    return Request(kind, address, size, now, now + duration, tuple(probe), overflows, watchdog, kept, list(_events(data, now, ticks)))


def _events(data, now, ticks):
    at = _REQUEST.size
    while at < len(data):
        when, kind, where, value = _EVENT.unpack_from(data, at)
        at += _EVENT.size
        size = value if kind in _WITH_DATA else 0
        yield now - (ticks - when) % ROUND, kind, where, value, data[at : at + size]
        at += size


def encode(request, began, horizon, levels, addresses, adc, chunks=(), payload=b""):
    """The bytes that answer a request.

    horizon: time before which nothing more arrives. levels: of the input pins, bit = GPIO. addresses: that acknowledge on I2C.
    chunks, to ADVANCE only: [(time of the first byte, bytes, GPIO, baud rate)].
    """
    ahead = min(max(horizon - request.target, 0), FAR)
    words = [ahead, adc, len(chunks), *_bits(levels, 4), *_bits(sum(1 << address for address in addresses), 8)]
    for time, data, gpio, baud in chunks:
        words += ((time - began) % ROUND, len(data), gpio, baud)
        payload += data
    head = struct.pack(f"<{len(words)}i", *words)
    return (head.ljust(PAYLOAD, b"\0") + payload).ljust(REPLY if request.kind == ADVANCE else SHORT, b"\0")


def _bits(mask, words):
    return [mask >> 16 * word & 0xFFFF for word in range(words)]
