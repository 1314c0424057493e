"""The simulated board's clock and its wires to the twin. Runs on either interpreter, beside the firmware.

Time stands still while the firmware computes; it moves in `advance_to` only. What the firmware does to the outside (I2C writes, pins,
PWM, UART output) is noted here with its time and handed over when time passes the horizon: the moment up to which the twin has already
told what will arrive. Nothing here allocates once the firmware's loop runs, so it may run with the heap locked.

A request (firmware to twin, little-endian):

    u32 length | u8 kind | u8 address | u16 size | i64 now | i64 target | 11 i32 probe | u32 overflows | events

    kind ADVANCE    time passes to `target`
         READ       `size` bytes from the I2C device at `address`; the events before it have happened
         FLUSH      only the events
         RESET      the board resets itself; the last request
    probe           the firmware's latest decision, see `_probe`; its first word is 0 while there is none
    overflows       bytes lost because a UART's buffer was full
    event           i64 time | u8 kind | u8 where | u16 value | data
                    I2C write: address, number of data bytes; pin: GPIO, level; PWM duty: GPIO, 0..65535; PWM frequency: GPIO, Hz (up to
                    65535); UART output: GPIO of tx, number of data bytes

The answer is REPLY bytes to ADVANCE, SHORT bytes to the others, always:

    words of 64 bits    0 horizon; 1 levels of the input pins, bit = GPIO; 2 and 3 I2C addresses that acknowledge (0..59, 60..119);
                        4 ADC reading 0..65535; 5 number of chunks, up to 4; 6.. chunks of four: time at which the first byte has
                        arrived, number of bytes, GPIO of rx, baud rate of the sender
    from byte PAYLOAD   bytes of the chunks one after another (of a READ: the bytes read)
"""

import struct
import sys
from array import array

import micropython
from micropython import const

_ADVANCE = const(1)
_READ = const(2)
_FLUSH = const(3)
_RESET = const(4)

I2C_WRITE = const(1)
PIN = const(2)
PWM_DUTY = const(3)
PWM_FREQUENCY = const(4)
UART_OUTPUT = const(5)

_REPLY = const(1024)
_SHORT = const(256)
_PAYLOAD = const(176)

_HEADER = const(72)
_EVENT = const(12)
_REQUEST = const(1024)  # what does not fit goes ahead of its time
_CHUNKS = const(4)
_FIRST_CHUNK = const(6)
_CHUNK = const(4)
_BITS = const(10)  # of a byte on the wire

now = 0  # us since the board started
watchdog_at = 0  # time at which the watchdog bites; 0 = none
overflows = 0

_horizon = 0
_request = bytearray(_REQUEST)
_view = memoryview(_request)
_used = _HEADER
# "l", not "q": MicroPython makes an object of every "q" it reads.
_reply = array("l", [0] * (_REPLY // 8))
_answer = array("l", [0] * (_SHORT // 8))  # to _READ and _FLUSH: chunks still on the wire stay in _reply
_inputs = _reply
_taken = array("i", [0] * _CHUNKS)
_receivers = {}  # by GPIO
_to_twin = None
_from_twin = None
_seen = -1


@micropython.viper
def copy(target: ptr8, at: int, source: ptr8, start: int, count: int):
    """target[at:at + count] = source[start:start + count], without the objects that slices would make."""
    i = 0
    while i < count:
        target[at + i] = source[start + i]
        i += 1


def connect(source, sink):
    """Open the two pipes to the twin and learn the state of the inputs."""
    global _from_twin, _to_twin
    _from_twin = open(source, "rb")
    _to_twin = open(sink, "wb")
    _exchange(_FLUSH, 0, 0, 0)


def attach(gpio, receiver):
    """`receiver.put(buffer, start, count)` gets the bytes that arrive on the pin at its `baudrate`."""
    deliver()
    _receivers[gpio] = receiver


def advance_to(time):
    """Let time pass."""
    global now
    if watchdog_at and time >= watchdog_at:
        reset()
    while time >= _horizon:
        _deliver_all()
        _exchange(_ADVANCE, 0, 0, time)
    now = time


def deliver():
    """Hand the bytes that have arrived by now to their receivers."""
    words = _reply
    start = _PAYLOAD
    index = 0
    at = _FIRST_CHUNK
    while index < words[5]:
        count = words[at + 1]
        taken = _taken[index]
        if taken < count:
            arrived = 0
            if now >= words[at]:
                arrived = (now - words[at]) * words[at + 3] // (_BITS * 1000000) + 1
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
        _exchange(_FLUSH, 0, 0, now)
    struct.pack_into("<qBBH", _request, _used, now, kind, where, value)
    _used += _EVENT
    if count:
        copy(_request, _used, data, 0, count)
        _used += count


def read(address, buffer, count):
    """Fill buffer[:count] from an I2C device, whose register pointer has been set. ValueError if that is more than an answer holds."""
    if count > _SHORT - _PAYLOAD:
        raise ValueError("at most 80 bytes in one read")
    _exchange(_READ, address, count, now)
    copy(buffer, 0, _answer, _PAYLOAD, count)


def acknowledges(address):
    """True when a device answers at the I2C address."""
    if address < 60:
        return (_inputs[2] >> address) & 1
    return (_inputs[3] >> (address - 60)) & 1


def level(gpio):
    """Level of an input pin."""
    return (_inputs[1] >> gpio) & 1


def adc():
    """Reading of the battery divider, 0..65535."""
    return _inputs[4]


def flush():
    """Hand over what has happened so far."""
    _exchange(_FLUSH, 0, 0, now)


def reset():
    """The board resets: the run is over."""
    _exchange(_RESET, 0, 0, now)
    sys.exit(3)


def _deliver_all():
    """Everything announced arrives before the horizon."""
    start = _PAYLOAD
    index = 0
    at = _FIRST_CHUNK
    while index < _reply[5]:
        count = _reply[at + 1]
        taken = _taken[index]
        if taken < count:
            _hand_over(at, start + taken, count - taken)
        _taken[index] = 0
        start += count
        index += 1
        at += _CHUNK
    _reply[5] = 0


def _hand_over(chunk, start, count):
    receiver = _receivers.get(_reply[chunk + 2])
    if receiver is not None and receiver.baudrate == _reply[chunk + 3]:  # at another speed it is noise, which nobody takes for frames
        receiver.put(_reply, start, count)


def _exchange(kind, address, size, target):
    """Send what has gathered, wait for the answer."""
    global _used, _horizon, _inputs
    struct.pack_into("<IBBHqq", _request, 0, _used, kind, address, size, now, target)
    struct.pack_into("<I", _request, 68, overflows)
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
        _horizon = answer[0]


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
        24,
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

    def store(file, source, start, count):
        """Write source[start:start + count], bytes, to a file."""
        file.write(source, start, count)

    def load(file, buffer, count):
        """Read `count` bytes of a file into the buffer."""
        file.readinto(buffer, count)

else:

    def _send(count):
        _to_twin.write(_view[:count])
        _to_twin.flush()

    def store(file, source, start, count):
        """Write source[start:start + count], bytes, to a file."""
        file.write(memoryview(source).cast("B")[start : start + count])

    def load(file, buffer, count):
        """Read `count` bytes of a file into the buffer."""
        file.readinto(memoryview(buffer)[:count])
