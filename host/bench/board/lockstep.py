"""The simulated board's clock and wires, fed from a tape instead of the twin: the same functions as `host/twin/board/lockstep.py`.

A tape, little-endian:

    i64 levels of the input pins | i64 I2C addresses that acknowledge, 0..59 | i64 the same, 60..119 | i64 ADC reading | i64 GPIO of the
    lidar's line | i64 its baud rate
    then for each batch of lidar bytes: i64 time at which the first has arrived, us | i64 number of bytes | the bytes

`on_step(time)` is called whenever time passes, `on_write(address, bytes)` for each I2C write, `on_end()` when the tape is over. Registers
read back as they were written last.
"""

import struct
from array import array

from common import I2C_WRITE, PIN, PWM_DUTY, PWM_FREQUENCY, UART_OUTPUT, copy, later, load, since, store  # noqa: F401
from micropython import const

_HEADER = const(48)

now = 0  # us since the tape began; no tape reaches the clock's round of 2**30
now_ms = 0
rounds = 0
cause = 1
watchdog_us = -1
overflows = 0
written = 0  # I2C writes so far
write_us = 0  # time of the last one's end
last_byte_us = 0  # arrival of the last byte of the batch handed over last
kept = bytearray(9)  # what the RTC's memory holds: number of bytes, and they
on_step = None
on_write = None
on_end = None

_tape = b""
_inputs = (0,) * 6
_at = 0
_batch = array("i", (0, 0, 0, 0))  # time, number of bytes, bytes handed over, where they begin
_receiver = None
_chips = {}
_pointer = {}


def connect(path):
    """Open the tape."""
    global _tape, _inputs, _at
    with open(path, "rb") as file:
        _tape = file.read()
    _inputs = struct.unpack_from("<6q", _tape, 0)
    _at = _HEADER
    _load()


def attach(gpio, receiver):
    """The UART on the lidar's line gets its bytes."""
    global _receiver
    if gpio == _inputs[4]:
        _receiver = receiver


def advance(duration):
    """Let time pass, us."""
    global now, now_ms
    now += duration
    now_ms = now // 1000
    if on_step is not None:
        on_step(now)
    if _batch[0] < 0:
        on_end()


def deliver():
    """Hand over the bytes that have arrived by now."""
    global last_byte_us
    while _batch[0] >= 0 and now >= _batch[0]:
        elapsed = now - _batch[0]
        arrived = (elapsed // 1000 * _inputs[5] + elapsed % 1000 * _inputs[5] // 1000) // 10000 + 1
        if arrived > _batch[1]:
            arrived = _batch[1]
        fresh = arrived - _batch[2]
        if fresh and _receiver is not None:
            _receiver.put(_tape, _batch[3] + _batch[2], fresh)
        _batch[2] = arrived
        if arrived < _batch[1]:
            return
        last_byte_us = _batch[0] + (_batch[1] - 1) * 100000 // (_inputs[5] // 100)
        _load()


def note(kind, where, value, data, count):
    """A register write is kept; the rest has no consequences here."""
    global written, write_us
    if kind != I2C_WRITE:
        return
    written += 1
    write_us = now
    if on_write is not None:
        on_write(where, bytes(memoryview(data)[:count]))
    if where not in _chips:
        _chips[where] = bytearray(256)
    _pointer[where] = data[0]
    if count > 1 and data[0] + count - 1 <= 256:
        copy(_chips[where], data[0], data, 1, count - 1)


def read(address, buffer, count):
    """Registers as they were written."""
    copy(buffer, 0, _chips[address], _pointer[address], count)


def acknowledges(address):
    """True when a device answers at the I2C address."""
    if address < 60:
        return _bit(8, address)
    return _bit(16, address - 60)


def level(gpio):
    """Level of an input pin. The loop asks for the stop button's in every turn."""
    return _bit(0, gpio)


def adc():
    """Reading of the battery divider."""
    return _inputs[3]


def reset(why):
    """The firmware resets the board: the run is over."""
    on_end()


def _load():
    """Go on to the next batch."""
    global _at
    if _at >= len(_tape):
        _batch[0] = -1
        return
    at = _at
    _batch[0] = _word(at)
    _batch[1] = _word(at + 8)
    _batch[2] = 0
    _batch[3] = at + 16
    _at = at + 16 + _batch[1]


def _bit(at, number):
    """A bit of the 64-bit word of the tape, without the long integer that the word would be."""
    return _tape[at + (number >> 3)] >> (number & 7) & 1


def _word(at):
    """A 64-bit word of the tape that is no larger than a small integer, without the tuple that struct makes."""
    value = 0
    for i in range(3, -1, -1):
        value = value << 8 | _tape[at + i]
    return value
