"""The simulated board's clock and its wires to the twin. Runs on either interpreter, beside the firmware.

Time stands still while the firmware computes; it moves in `advance` only. What the firmware does to the outside (I2C writes, pins,
PWM, UART output) is noted here with its time and handed over when time passes the horizon: the moment up to which the twin has already
told what will arrive. Nothing here allocates once the firmware's loop runs, so it may run with the heap locked: no number leaves the
31 bits of the board's small integers. Hence the clock of 2**30 us (18 minutes), whose rounds are counted beside it.

A request (firmware to twin, little-endian):

    u32 length | u8 kind | u8 address | u16 size | u32 ticks | u32 rounds | u32 duration | 11 i32 probe | u32 overflows | i32 watchdog | 9 u8 kept | events

    kind ADVANCE    `duration` us pass
         READ       `size` bytes from the I2C device at `address`; the events before it have happened
         FLUSH      only the events
         RESET      the board resets itself, `address` says why (as `machine.reset_cause` gives it later); the last request
    ticks, rounds   now: rounds * 2**30 + ticks, us
    probe           the firmware's latest decision, see `_probe`; its first word is 0 while there is none
    overflows       bytes lost because a UART's buffer was full
    watchdog        us from the end of the duration until the watchdog resets the board, -1 = there is none
    kept            what the RTC's memory holds: number of bytes, up to 8, and they. After a reset the twin leaves it in the file rtc.bin
    event           u32 ticks | u8 kind | u8 where | u16 value | data
                    I2C write: address, number of data bytes; pin: GPIO, level; PWM duty: GPIO, 0..65535; PWM frequency: GPIO, Hz (up to
                    65535); UART output: GPIO of tx, number of data bytes

The answer is REPLY bytes to ADVANCE, SHORT bytes to the others, always:

    words of 32 bits    0 us from the end of the duration to the horizon; 1 ADC reading 0..65535; 2 number of chunks, up to 4;
                        3..6 levels of the input pins and 7..14 I2C addresses that acknowledge, 16 a word, the lowest first;
                        15.. chunks of four: ticks at which the first byte has arrived, number of bytes, GPIO of rx, baud rate of the sender
    from byte PAYLOAD   bytes of the chunks one after another (of a READ: the bytes read)
"""

import struct
import sys
from array import array

from common import I2C_WRITE, MASK, PIN, PWM_DUTY, PWM_FREQUENCY, UART_OUTPUT, copy, later, load, since, store  # noqa: F401
from micropython import const

_ADVANCE = const(1)
_READ = const(2)
_FLUSH = const(3)
_RESET = const(4)

_WDT_RESET = const(3)

_REPLY = const(1024)
_SHORT = const(256)
_PAYLOAD = const(128)

_HEADER = const(81)
_PROBE = const(20)
_OVERFLOWS = const(64)
_WATCHDOG = const(68)
_KEPT = const(72)
_KEPT_SIZE = const(9)
_EVENT = const(8)
_REQUEST = const(1024)  # what does not fit goes ahead of its time
_AHEAD = const(0)
_ADC = const(1)
_COUNT = const(2)
_LEVELS = const(3)
_ADDRESSES = const(7)
_FIRST_CHUNK = const(15)
_CHUNKS = const(4)
_CHUNK = const(4)
_BITS = const(10)  # of a byte on the wire

now = 0  # us since the board started, modulo 2**30
now_ms = 0  # ms since the board started, modulo 2**30
rounds = 0  # times that `now` has begun again at 0
cause = 1  # why the board started, as machine.reset_cause() gives it
watchdog_us = -1  # until the watchdog bites; -1 = there is none
overflows = 0

_part_us = 0  # of the millisecond that has begun
_ahead_us = 0  # until the horizon
_request = bytearray(_REQUEST)
_view = memoryview(_request)
_used = _HEADER
_reply = array("i", [0] * (_REPLY // 4))
_answer = array("i", [0] * (_SHORT // 4))  # to _READ and _FLUSH: chunks still on the wire stay in _reply
_inputs = _reply
_taken = array("i", [0] * _CHUNKS)
kept = bytearray(_KEPT_SIZE)
_receivers = {}  # by GPIO
_to_twin = None
_from_twin = None
_seen = -1


def connect(source, sink, ticks, started_by):
    """Open the two pipes to the twin and learn the state of the inputs.

    ticks: us that the clock shows already: a soft reset does not set it back. started_by: see `cause`.
    """
    global _from_twin, _to_twin, cause, now, now_ms, rounds, _part_us
    _from_twin = open(source, "rb")
    _to_twin = open(sink, "wb")
    cause = started_by
    try:
        with open("rtc.bin", "rb") as file:
            file.readinto(kept)
    except OSError:
        pass  # the power was off
    now, rounds = ticks & MASK, ticks >> 30
    now_ms, _part_us = ticks // 1000 & MASK, ticks % 1000
    _exchange(_FLUSH, 0, 0, 0)


def attach(gpio, receiver):
    """`receiver.put(buffer, start, count)` gets the bytes that arrive on the pin at its `baudrate`."""
    deliver()
    _receivers[gpio] = receiver


def advance(duration):
    """Let time pass: `duration` us, less than 2**29."""
    global now, now_ms, rounds, watchdog_us, _part_us, _ahead_us
    bites = -1 < watchdog_us <= duration
    if watchdog_us >= 0:
        if bites:
            duration = watchdog_us
        watchdog_us -= duration
    _ahead_us -= duration
    while _ahead_us <= 0:
        _deliver_all()
        _exchange(_ADVANCE, 0, 0, duration)
    before = now
    now = later(now, duration)
    if now < before:
        rounds += 1
    _part_us += duration
    if _part_us >= 1000:
        now_ms = later(now_ms, _part_us // 1000)
        _part_us %= 1000
    if bites:
        reset(_WDT_RESET)


def deliver():
    """Hand the bytes that have arrived by now to their receivers."""
    words = _reply
    start = _PAYLOAD
    index = 0
    at = _FIRST_CHUNK
    while index < words[_COUNT]:
        count = words[at + 1]
        taken = _taken[index]
        if taken < count:
            arrived = 0
            elapsed = since(now, words[at])
            if elapsed >= 0:
                # elapsed * baud / (_BITS * 1000000), in two steps that stay small
                arrived = (elapsed // 1000 * words[at + 3] + elapsed % 1000 * words[at + 3] // 1000) // (_BITS * 1000) + 1
                if arrived > count:
                    arrived = count
            if arrived > taken:
                _hand_over(at, start + taken, arrived - taken)
                _taken[index] = arrived
        start += count
        index += 1
        at += _CHUNK


def note(kind, where, value, data, count):
    """Note an event at this moment; `count` bytes of data (None when there are none)."""
    global _used
    if _used + _EVENT + count > _REQUEST:
        _exchange(_FLUSH, 0, 0, 0)
    struct.pack_into("<IBBH", _request, _used, now, kind, where, value)
    _used += _EVENT
    if count:
        copy(_request, _used, data, 0, count)
        _used += count


def read(address, buffer, count):
    """Fill buffer[:count] from an I2C device, whose register pointer has been set. ValueError if that is more than an answer holds."""
    if count > _SHORT - _PAYLOAD:
        raise ValueError("at most 128 bytes in one read")
    _exchange(_READ, address, count, 0)
    copy(buffer, 0, _answer, _PAYLOAD, count)


def acknowledges(address):
    """True when a device answers at the I2C address."""
    return _inputs[_ADDRESSES + (address >> 4)] >> (address & 15) & 1


def level(gpio):
    """Level of an input pin."""
    return _inputs[_LEVELS + (gpio >> 4)] >> (gpio & 15) & 1


def adc():
    """Reading of the battery divider, 0..65535."""
    return _inputs[_ADC]


def flush():
    """Hand over what has happened so far."""
    _exchange(_FLUSH, 0, 0, 0)


def reset(why):
    """The board resets: the twin ends this process, and may start another."""
    _exchange(_RESET, why, 0, 0)
    sys.exit(3)


def _deliver_all():
    """Everything announced arrives before the horizon."""
    start = _PAYLOAD
    index = 0
    at = _FIRST_CHUNK
    while index < _reply[_COUNT]:
        count = _reply[at + 1]
        taken = _taken[index]
        if taken < count:
            _hand_over(at, start + taken, count - taken)
        _taken[index] = 0
        start += count
        index += 1
        at += _CHUNK
    _reply[_COUNT] = 0


def _hand_over(chunk, start, count):
    receiver = _receivers.get(_reply[chunk + 2])
    if receiver is not None and receiver.baudrate == _reply[chunk + 3]:  # at another speed it is noise, which nobody takes for frames
        receiver.put(_reply, start, count)


def _exchange(kind, address, size, duration):
    """Send what has gathered, wait for the answer."""
    global _used, _ahead_us, _inputs
    struct.pack_into("<IBBHIII", _request, 0, _used, kind, address, size, now, rounds, duration)
    struct.pack_into("<I", _request, _OVERFLOWS, overflows)
    struct.pack_into("<i", _request, _WATCHDOG, watchdog_us)
    copy(_request, _KEPT, kept, 0, _KEPT_SIZE)
    _probe()
    answer = _reply if kind == _ADVANCE else _answer
    try:
        _send(_used)
        got = _from_twin.readinto(answer)
    except OSError:
        got = 0
    if got != (_REPLY if kind == _ADVANCE else _SHORT):
        sys.exit(0)  # the twin has seen enough
    _used = _HEADER
    _inputs = answer
    if kind == _ADVANCE:
        _ahead_us = answer[_AHEAD]


def _probe():
    """Read the latest decision out of the running firmware, as a debugger would; the firmware knows nothing of it."""
    global _seen
    main = sys.modules.get("main")
    avoid = getattr(getattr(main, "robot", None), "avoid", None)
    if avoid is None or avoid.decisions == _seen:
        return
    _seen = avoid.decisions
    struct.pack_into(
        "<11i",
        _request,
        _PROBE,
        _seen,
        avoid.af,
        avoid.ar,
        avoid.v,
        avoid.mode,
        avoid.window,
        avoid.zone,
        avoid.free,
        avoid.block_x,
        avoid.block_y,
        avoid.why,
    )


if sys.implementation.name == "micropython":

    def _send(count):
        _to_twin.write(_request, count)

else:

    def _send(count):
        _to_twin.write(_view[:count])
        _to_twin.flush()
