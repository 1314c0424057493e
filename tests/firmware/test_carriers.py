"""carriers.py: the serial line in portions its FIFO has room for, Ctrl-C, datagrams signed and filled."""

import struct
import sys

import micropython

from link import telemetry
from link.frames import decode, frame
from link.radio import Datagrams
from link.serial_line import SerialLine
from link.telemetry import Encoder
from link.wifi import start_radio

MICROPYTHON = sys.implementation.name == "micropython"


class Sink:
    """Standard output that remembers how much it was given at once."""

    def __init__(self):
        self.buffer = self
        self.data = bytearray(20_000)
        self.used = 0
        self.most = 0

    def write(self, data):
        i = 0
        while i < len(data):
            self.data[self.used + i] = data[i]
            i += 1
        self.used += i
        self.most = max(self.most, i)

    def text(self):
        return bytes(self.data[: self.used])


class Source:
    """Standard input, and the poller that watches it."""

    def __init__(self):
        self.buffer = self
        self.data = b""
        self.closed = False

    def give(self, data):
        self.data += data

    def ready(self, timeout):
        return (self,) if self.data or self.closed else ()

    def readinto(self, buffer):
        assert len(buffer) == 1
        if not self.data:
            return 0
        buffer[0] = self.data[0]
        self.data = self.data[1:]
        return 1


def make(rate=11520):
    source, sink = Source(), Sink()
    line = SerialLine(sys.stdin if MICROPYTHON else _Stdin(), sink, rate)
    line.close()
    line._source = source
    line._ready = source.ready
    return line, source, sink


class _Stdin:
    """What select can watch under pytest, which takes standard input away."""

    def __init__(self):
        import os

        self.buffer = os.fdopen(os.pipe()[0], "rb", 0)

    def fileno(self):
        return self.buffer.fileno()


def sealed(encoder, length=100):
    return encoder.seal(telemetry.LOG, length)


def test_output_keeps_to_the_rate_of_the_line():
    line, _, sink = make()
    encoder = Encoder()
    now = 0
    accepted = 0
    while now < 1_000_000:
        accepted += line.send(encoder, sealed(encoder), now)
        line.update(now)
        now += 5000
    assert 10_000 < sink.used <= 11_520 + 120 and sink.most <= 64
    assert 90 < accepted < 140  # of 200: the others are dropped, whole
    assert len(decode(sink.text())) >= accepted - 25


def test_a_pause_of_the_loop_gives_no_burst():
    line, _, sink = make()
    encoder = Encoder()
    for _ in range(10):
        line.send(encoder, sealed(encoder), 0)
    line.update(0)
    first = sink.used
    line.update(900_000)
    assert first <= 120 and sink.used - first <= 120


def test_frames_come_out_whole_whatever_their_length():
    line, _, sink = make()
    encoder = Encoder()
    now = 0
    for length in range(60):
        size = encoder.seal(telemetry.LOG, length)
        assert line.send(encoder, size, now)
        for _ in range(4):
            now += 5000
            line.update(now)
    assert [len(payload) for _, _, payload in decode(sink.text())] == list(range(60))


def test_commands_come_in_piece_by_piece():
    line, source, _ = make()
    data = frame(telemetry.GREET, b"\1\0\0\0\1") + frame(telemetry.LIST, b"\3\0\0\0")
    found = []
    for byte in data:
        source.give(bytes([byte]))
        while line.take(0):
            found.append(line.decoder.kind)
    assert found == [telemetry.GREET, telemetry.LIST]


def test_ctrl_c_counts_outside_frames_only():
    line, source, _ = make()
    source.give(frame(telemetry.LIST, b"\3\0\0\0"))
    assert line.take(0)
    source.give(b"\r\x03")
    try:
        line.take(0)
    except KeyboardInterrupt:
        pass
    else:
        raise AssertionError("Ctrl-C was not heard")


def test_a_broken_frame_is_no_ctrl_c():
    line, source, _ = make()
    broken = bytearray(frame(telemetry.LIST, b"\3\3\3\3"))
    broken[-1] ^= 1
    source.give(bytes(broken))
    assert not line.take(0)
    source.give(frame(telemetry.LIST, b"\3\3\3\3")[:10])
    assert not line.take(1000)
    assert not line.take(500_000)  # given up
    source.give(frame(telemetry.KEEP, b"\4\0\0\0"))
    assert line.take(501_000) and line.decoder.kind == telemetry.KEEP


def test_a_closed_line_is_left_alone():
    line, source, _ = make()
    source.closed = True
    assert not line.take(0) and not line.take(1000)


def test_a_flood_does_not_hold_the_loop():
    line, source, _ = make()
    source.give(b"x" * 500)
    assert not line.take(0)
    assert len(source.data) == 500 - 64


def test_the_line_allocates_nothing():
    line, source, sink = make()
    encoder = Encoder()
    line._ready = _nothing
    line.send(encoder, sealed(encoder), 0)
    line.update(0)
    micropython.heap_lock()
    try:
        now = 0
        while now < 300_000:
            line.send(encoder, sealed(encoder), now)
            line.update(now)
            line.take(now)
            now += 5000
    finally:
        micropython.heap_unlock()
    assert sink.used > 2000


_NOTHING = ()


def _nothing(timeout):
    return _NOTHING


class Sockets:
    """The socket module, and the one socket it makes."""

    AF_INET = SOCK_DGRAM = SOL_SOCKET = SO_BROADCAST = 1

    def __init__(self):
        self.sent = []
        self.received = []
        self.fails = False

    def socket(self, *_):
        return self

    def getaddrinfo(self, host, port):
        return [(0, 0, 0, "", (host, port))]

    def setsockopt(self, *_):
        pass

    def bind(self, address):
        self.bound = address

    def setblocking(self, flag):
        assert not flag

    def sendto(self, data, address):
        if self.fails:
            raise OSError(12)
        self.sent.append((bytes(data), address))

    def recvfrom(self, size):
        return self.received.pop(0)

    def ready(self, timeout):
        return (self,) if self.received else ()


class Wlan:
    up = False

    def isconnected(self):
        return self.up


class Radio(Datagrams):
    """With the poller replaced by that of the socket, which select cannot watch."""

    def _bind(self):
        self._socket = self._sockets
        self._socket.bind(("0.0.0.0", self._port))
        self._everyone = ("255.255.255.255", self._port + 1)
        self._ready = self._sockets.ready


def test_datagrams_go_to_who_was_heard_and_no_longer_than_that():
    sockets, wlan = Sockets(), Wlan()
    radio = Radio(wlan, sockets, 9750)
    encoder = Encoder(datagrams=True)
    radio.update(0)
    assert radio.send(encoder, sealed(encoder), 0) and not radio.take(0) and sockets.sent == []
    wlan.up = True
    radio.update(600_000)
    assert sockets.bound == ("0.0.0.0", 9750)
    size = sealed(encoder, 33)
    radio.announce(encoder, size)
    data, address = sockets.sent.pop()
    assert address == ("255.255.255.255", 9751) and len(data) % 32 == 0 and decode(data)[0][0] == telemetry.LOG
    assert radio.send(encoder, size, 0) and sockets.sent == []  # nobody listens
    sockets.received.append((frame(telemetry.GREET, b"\1\0\0\0\1"), ("10.0.0.7", 4321)))
    assert radio.take(700_000) and not radio.take(700_000)
    radio.heard(700_000)
    assert radio.busy and radio.send(encoder, size, 700_000) and sockets.sent.pop()[1] == ("10.0.0.7", 4321)
    radio.update(4_000_000)
    assert not radio.busy and radio.send(encoder, size, 4_000_000) and sockets.sent == []


def test_a_radio_without_buffers_drops():
    sockets, wlan = Sockets(), Wlan()
    wlan.up = True
    radio = Radio(wlan, sockets, 9750)
    radio.update(0)
    sockets.received.append((frame(telemetry.GREET, b"\1\0\0\0\1"), ("10.0.0.7", 4321)))
    radio.take(0)
    radio.heard(0)
    sockets.fails = True
    encoder = Encoder(datagrams=True)
    assert not radio.send(encoder, sealed(encoder), 0)


def test_half_a_frame_in_a_datagram_is_forgotten():
    sockets, wlan = Sockets(), Wlan()
    wlan.up = True
    radio = Radio(wlan, sockets, 9750)
    radio.update(0)
    whole = frame(telemetry.GREET, struct.pack("<IB", 1, 1))
    for data in (whole[:9], b"", whole[9:], b"\xf7" * 256, whole):
        sockets.received.append((data, ("10.0.0.7", 1)))
    assert [radio.take(0) for _ in range(5)] == [False, False, False, False, True]


class Network:
    """The network module, writing down what is asked of it."""

    STA_IF, AP_IF, AUTH_WPA2_PSK = 0, 1, 3

    def __init__(self):
        self.asked = []
        network = self

        class WLAN:
            PM_NONE = 0

            def __init__(self, interface):
                network.asked.append(("interface", interface))

            def active(self, flag):
                network.asked.append(("active", flag))

            def connect(self, ssid, password):
                network.asked.append(("connect", ssid, password))

            def config(self, **settings):
                network.asked.append(("config", settings))

        self.WLAN = WLAN

    def hostname(self, name):
        self.asked.append(("hostname", name))


class Wifi:
    wifi_ssid = "home"
    wifi_password = "secret12"
    wifi_access_point = False


def test_the_radio_joins_a_network_without_power_saving():
    network = Network()
    start_radio(Wifi, network)
    assert network.asked == [
        ("hostname", "robot"), ("interface", 0), ("active", True), ("connect", "home", "secret12"), ("config", {"pm": 0}),
    ]  # fmt: skip


def test_the_radio_is_a_network():
    class Open(Wifi):
        wifi_access_point = True
        wifi_password = ""

    class Closed(Wifi):
        wifi_access_point = True

    network = Network()
    start_radio(Open, network)
    assert ("interface", 1) in network.asked and ("config", {"ssid": "home"}) in network.asked
    network = Network()
    start_radio(Closed, network)
    assert ("config", {"ssid": "home", "key": "secret12", "security": 3}) in network.asked
