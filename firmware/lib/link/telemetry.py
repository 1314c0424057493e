"""The wire format between robot and laptop: one binary frame both ways, the same over USB serial and UDP.

Frame, all fields little-endian

    offset  size
    0       2      0xF7 0xF6; neither byte can occur in UTF-8, so text printed between frames never looks like one
    2       1      version, 1
    3       1      type
    4       2      sequence number, counts the frames sent; a gap tells what was lost on the way
    6       2      length n of the payload, at most 1390: a frame fits one datagram of 1400 bytes
    8       n      payload
    8 + n   2      CRC-16 (Modbus) over bytes 2 .. 8+n-1

A datagram holds one frame; zero bytes after it are filling. Angles are 0.1 deg, clockwise positive, lengths mm in the body frame
(x right, y forward) unless said otherwise; a time is the robot's ticks_us modulo 2**30. u and i: unsigned, signed; the number: bits.

Robot to laptop

    01 HELLO       session (8 bytes), counter u32 (of the last command), then JSON: firmware (version), robot (name), board (unique id in hex),
                   boot (reason), width, length, track, spacings
    02 DECISION    number u32, time u32, state u8 (STOPPED, AUTO, MANUAL), mode u8, AF i16, AR i16, V u8, window u8, zone u8 (255 none), free i16,
                   block x i16, block y i16 (32767 none), why u8, took u32 (us of computing)
    03 WHEELS      time u32, AF i16, AR i16, (V-90)*256 i16 as the wheels stand now, folded u32 (bit k: wheel k reversed), count u8,
                   then count angles i16, then count speed shares i16 (16384 = the fastest wheel)
    04 POINTS      time u32, count u16, then count x i16, count y i16, count windows u8 (0 none 1 green 2 red 3 blue 4 yellow)
    05 SCAN        lidar frames until the end: time u32 (of the last point), first and last bearing u16, count u8, count distances u16
                   (quarter mm, 0 none); up to one revolution
    06 HEALTH      uptime ms u32, heap free u32 (bytes), worst loop us u32, battery mV u16 (0 unknown), lidar speed u8 (0.05 r/s), flags u8 (bit 0
                   lidar trusted, 1 chips answer, 2 radio on), fault u8, lidar frames u32, check errors u32, speed faults u32, frames of
                   telemetry dropped u32, commands refused u32
    07 PARAMETER   JSON: key, value, low, high, number (0 ..), of (how many there are); what it means is in schema.py
    08 LOG         level u8 (0 information, 1 warning, 2 error), UTF-8 text
    09 POSE        time u32, x i32, y i32 (1/256 mm since boot), heading u32 (0.001 deg)
    0A CANDIDATES  time u32, variant u8, chosen u8 (255 none), count u8, then count AF i16, count AR i16, count free lengths u16 (65535: not
                   looked at, as others promised more). AF and AR are those of a right turn ahead; bit 0 of variant: both change their sign
                   (left), bit 1: they are exchanged with their sign changed (backward)
    0B REPLY       counter u32 and type u8 of the command, status u8 (OK, REFUSED), UTF-8 text
    0C NAMES       JSON: reasons, faults (the texts that numbers point into)

Laptop to robot; each payload begins with a counter u32

    41 DRIVE       what u8 (STOPPED, AUTO, MANUAL), AF i16, AR i16, V u8. MANUAL must be repeated: 300 ms without one and the robot stops
    42 TUNE        UTF-8 text key=value, value as in JSON; takes effect at once, until the robot restarts
    43 KEEP        write what was tuned to robot.json on the board
    44 WATCH       flags u8: bit 0 send SCAN, bit 1 send CANDIDATES
    45 LIST        send every PARAMETER
    46 POINT       wheel u8 (2(i-1)+(j-1)), angle i16: turn this wheel alone while the robot stands; its trim is the parameter servos.trims.WHEEL
    47 GREET       what u8: bit 0 send HELLO and NAMES. Over UDP the robot sends to whom it last heard a valid command from, for 3 s;
                   a GREET without a right tag is answered with a HELLO, which tells the session a tag needs

Commands over UDP end with a tag of 8 bytes: the first 8 bytes of HMAC-SHA256 under the robot's key, see `auth`. Over USB there is none:
whoever holds the cable can also press reset.

Everything here runs on MicroPython and CPython alike. Sending allocates nothing.
"""

import micropython
from micropython import const

from core.crc16 import crc16

VERSION = 1
SYNC = b"\xf7\xf6"
HEADER = const(8)
_CHECK = const(2)
MAX_PAYLOAD = const(1390)
MAX_FRAME = const(1400)
_FILLING = const(32)  # datagrams come in multiples of this size, so that the views of the buffer can be made beforehand

HELLO = const(0x01)
DECISION = const(0x02)
WHEELS = const(0x03)
POINTS = const(0x04)
SCAN = const(0x05)
HEALTH = const(0x06)
PARAMETER = const(0x07)
LOG = const(0x08)
POSE = const(0x09)
CANDIDATES = const(0x0A)
REPLY = const(0x0B)
NAMES = const(0x0C)

DRIVE = const(0x41)
TUNE = const(0x42)
KEEP = const(0x43)
WATCH = const(0x44)
LIST = const(0x45)
POINT = const(0x46)
GREET = const(0x47)

STOPPED = const(0)
AUTO = const(1)
MANUAL = const(2)

OK = const(0)
REFUSED = const(1)

# struct formats of the fixed parts, as listed above
DECISION_FORMAT = "<IIBBhhBBBhhhBI"
WHEELS_FORMAT = "<IhhhIB"
POINTS_FORMAT = "<IH"
SCAN_FORMAT = "<IHHB"
HEALTH_FORMAT = "<IIIHBBBIIIII"
HELLO_FORMAT = "<8sI"
POSE_FORMAT = "<IiiI"
CANDIDATES_FORMAT = "<IBBB"
REPLY_FORMAT = "<IBB"
COUNTER_FORMAT = "<I"
DRIVE_FORMAT = "<IBhhB"
WATCH_FORMAT = "<IB"
GREET_FORMAT = "<IB"
POINT_FORMAT = "<IBh"

NO_POINT = const(32767)
TIME_MASK = const(0x3FFFFFFF)


@micropython.viper
def copy(source: ptr8, start: int, count: int, target: ptr8, at: int):
    """target[at:at + count] = source[start:start + count], bytes, without the objects that slices would make."""
    i = 0
    while i < count:
        target[at + i] = source[start + i]
        i += 1


class Encoder:
    """Builds frames in one buffer made once. Fill `data` from HEADER on, then call `seal`; allocates nothing.

    datagrams: whether `datagram` will be wanted.
    """

    def __init__(self, size=MAX_FRAME, datagrams=False):
        self.data = bytearray((size + _FILLING - 1) // _FILLING * _FILLING)
        ends = range(0, len(self.data) + 1, _FILLING) if datagrams else ()
        self._views = [memoryview(self.data)[:end] for end in ends]
        self.data[0] = SYNC[0]
        self.data[1] = SYNC[1]
        self.data[2] = VERSION
        self.room = size - HEADER - _CHECK  # bytes of payload
        self._sequence = 0

    def seal(self, kind, length):
        """Complete the frame whose payload of `length` bytes is in place; returns the size of the whole."""
        self.head(kind, length)
        data = self.data
        end = HEADER + length
        check = crc16(data, 2, end)
        data[end] = check & 255
        data[end + 1] = check >> 8
        return end + _CHECK

    def datagram(self, size):
        """A view of the sealed frame of `size` bytes, filled up with zeros; made beforehand, as a slice would allocate."""
        data = self.data
        blocks = (size + _FILLING - 1) // _FILLING
        for i in range(size, blocks * _FILLING):
            data[i] = 0
        return self._views[blocks]

    def head(self, kind, length):
        """Write the header alone, with the next sequence number (a tag covers the header, so it is needed before)."""
        data = self.data
        sequence = self._sequence
        self._sequence = (sequence + 1) & 0xFFFF
        data[3] = kind
        data[4] = sequence & 255
        data[5] = sequence >> 8
        data[6] = length & 255
        data[7] = length >> 8


class Decoder:
    """Finds the frames in a stream of bytes, whatever lies between them.

    After `take` returned True: `kind`, `sequence`, and the payload is data[start:end] until the next `feed`.
    ahead: bytes taken in beyond the longest frame, for whoever feeds many at a time.
    stray: called with each byte (an int) that belongs to no frame, or None.
    errors: counts frames whose check failed.
    """

    def __init__(self, max_payload=MAX_PAYLOAD, stray=None, ahead=MAX_FRAME):
        self._largest = max_payload
        self.data = bytearray(max_payload + HEADER + _CHECK + ahead)
        self.kind = self.sequence = self.start = self.end = 0
        self.errors = 0
        self._stray = stray
        self._head = self._tail = 0

    def room(self):
        """How many bytes `feed` takes now; never 0 after `take` returned False."""
        if self._head:
            self._tail -= self._head
            copy(self.data, self._head, self._tail, self.data, 0)
            self._head = 0
        return len(self.data) - self._tail

    def feed(self, source, start, count):
        """Take in source[start:start + count]; count at most `room()`."""
        copy(source, start, count, self.data, self._tail)
        self._tail += count

    def clear(self):
        """Forget an unfinished frame; its bytes are stray."""
        while self._head < self._tail:
            self._drop()

    def waiting(self):
        """True while a frame has begun and is not whole."""
        return self._head < self._tail

    def take(self):
        """True when the next frame is whole; False when more bytes are needed."""
        data = self.data
        while self._head < self._tail:
            head = self._head
            have = self._tail - head
            if data[head] != 0xF7 or have > 1 and data[head + 1] != 0xF6 or have > 2 and data[head + 2] != VERSION:
                self._drop()
                continue
            if have < HEADER:
                return False
            length = data[head + 6] | data[head + 7] << 8
            if length > self._largest:
                self._drop()
                continue
            end = head + HEADER + length
            if end + _CHECK > self._tail:
                return False
            if crc16(data, head + 2, end) != data[end] | data[end + 1] << 8:
                self.errors += 1
                self._drop()
                continue
            self.kind = data[head + 3]
            self.sequence = data[head + 4] | data[head + 5] << 8
            self.start = head + HEADER
            self.end = end
            self._head = end + _CHECK
            return True
        return False

    def _drop(self):
        byte = self.data[self._head]
        self._head += 1
        if self._stray is not None:
            self._stray(byte)
