"""serial_line.py, radio.py, wifi.py: the serial line in portions its FIFO has room for, Ctrl-C, datagrams signed and filled."""

import struct
import sys

import micropython

from link import protocol
from link.frames import decode, frame
from link.radio import Datagrams
from link.serial_line import SerialLine
from link.telemetry import Encoder

MICROPYTHON = sys.implementation.name == "micropython"


class Sink:
    """Standard output that remembers how much it was given at once."""

    def __init__(self):
        self.buffer = self
        self.data = bytearray(60_000)
        self.used = 0
        self.most = 0

    def write(self, data, at, count):
        i = 0
        while i < count:
            self.data[self.used + i] = data[at + i]
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


class Clock:
    """What the line takes for the time."""

    def __init__(self):
        self.us = 0

    def read(self):
        return self.us


def make():
    source, sink, clock = Source(), Sink(), Clock()
    line = SerialLine(sys.stdin if MICROPYTHON else _Stdin(), sink, clock.read)
    line.close()
    line.source = source
    line.ready = source.ready
    return line, source, sink, clock


class _Stdin:
    """What select can watch under pytest, which takes standard input away."""

    def __init__(self):
        import os

        self.buffer = os.fdopen(os.pipe()[0], "rb", 0)

    def fileno(self):
        return self.buffer.fileno()


def sealed(encoder, length=100):
    encoder.data[3] = protocol.LOG
    encoder.seal(length)
    return encoder


def test_output_keeps_to_the_rate_of_the_line():
    line, _, sink, clock = make()
    encoder = Encoder()
    accepted = 0
    while clock.us < 1_000_000:
        if line.idle():
            accepted += line.send(sealed(encoder))
        line.update(clock.us)
        clock.us += 5000
    assert 10_000 < sink.used <= 11_520 + 120 and sink.most <= 120
    assert len(decode(sink.text())) >= accepted - 1 > 90


def test_the_room_in_the_fifo_is_that_of_the_moment_of_writing():
    line, _, sink, clock = make()
    line.send(sealed(Encoder(), 1000))
    first = sink.used
    assert first == 120
    clock.us = 3000  # the loop began long before: what counts is how much has left the FIFO by now
    line.update(1_000_000)
    assert sink.used - first == 3000 // 87
    line.update(2_000_000)
    assert sink.used - first == 3000 // 87


def test_a_pause_of_the_loop_gives_no_burst():
    line, _, sink, clock = make()
    line.send(sealed(Encoder(), 1000))
    first = sink.used
    clock.us = 900_000
    line.update(900_000)
    assert first <= 120 and sink.used - first <= 120


def test_frames_come_out_whole_whatever_their_length():
    line, _, sink, clock = make()
    encoder = Encoder()
    for length in range(0, 1390, 23):
        assert line.idle() and line.send(sealed(encoder, length))
        while not line.idle():
            clock.us += 5000
            line.update(clock.us)
        clock.us += 5000
    assert [len(payload) for _, _, payload in decode(sink.text())] == list(range(0, 1390, 23))


def test_commands_come_in_piece_by_piece():
    line, source, _, _ = make()
    data = frame(protocol.GREET, b"\1\0\0\0\1") + frame(protocol.LIST, b"\3\0\0\0")
    found = []
    for byte in data:
        source.give(bytes([byte]))
        while line.take(0):
            found.append(line.decoder.kind)
    assert found == [protocol.GREET, protocol.LIST]


def taken(line, now):
    """Whether a frame comes within a few turns of the loop, each of which takes in a few bytes."""
    found = [line.take(now) for _ in range(4)]
    return any(found)


def test_ctrl_c_counts_outside_frames_only():
    line, source, _, _ = make()
    source.give(frame(protocol.LIST, b"\3\0\0\0"))
    assert taken(line, 0)
    source.give(b"\r\x03")
    try:
        taken(line, 0)
    except KeyboardInterrupt:
        pass
    else:
        raise AssertionError("Ctrl-C was not heard")


def test_a_broken_frame_is_no_ctrl_c():
    line, source, _, _ = make()
    broken = bytearray(frame(protocol.LIST, b"\3\3\3\3"))
    broken[-1] ^= 1
    source.give(bytes(broken))
    assert not taken(line, 0)
    source.give(frame(protocol.LIST, b"\3\3\3\3")[:10])
    assert not taken(line, 1000)
    assert not taken(line, 500_000)  # given up
    source.give(frame(protocol.KEEP, b"\4\0\0\0"))
    assert taken(line, 501_000) and line.decoder.kind == protocol.KEEP


def test_a_closed_line_is_left_alone():
    line, source, _, _ = make()
    source.closed = True
    assert not line.take(0) and not line.take(1000)


def test_a_flood_does_not_hold_the_loop():
    line, source, _, _ = make()
    source.give(b"x" * 500)
    assert not line.take(0)
    assert len(source.data) == 500 - 8


def test_the_line_allocates_nothing():
    line, _, sink, clock = make()
    encoder = Encoder()
    line.ready = _nothing
    line.send(sealed(encoder))
    micropython.heap_lock()
    try:
        while clock.us < 300_000:
            if line.idle():
                line.send(sealed(encoder))
            line.update(clock.us)
            line.take(clock.us)
            clock.us += 5000
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
    """With the poller replaced by that of the socket, which select cannot watch, and a turn of the loop that has just begun."""

    late = 0

    def __init__(self, *settings):
        super().__init__(*settings, clock=lambda: (self.now + self.late) % 2**30)

    def take(self, now_us):
        self.now = now_us
        return super().take(now_us)

    def _bind(self):
        self._socket = self._sockets
        self._socket.bind(("0.0.0.0", self._port))
        self._everyone = ("255.255.255.255", self._port + 1)
        self._ready = self._sockets.ready


def test_datagrams_go_to_who_was_heard_and_no_longer_than_that():
    sockets, wlan, encoder = Sockets(), Wlan(), Encoder()
    radio = Radio(wlan, sockets, 9750, encoder)
    radio.update(0)
    assert radio.send(sealed(encoder)) and not radio.take(0) and sockets.sent == []
    wlan.up = True
    radio.update(600_000)
    assert sockets.bound == ("0.0.0.0", 9750)
    sealed(encoder, 1000)
    sealed(encoder, 33)
    radio.announce(encoder)
    data, address = sockets.sent.pop()
    assert address == ("255.255.255.255", 9751) and len(data) == 128 and decode(data)[0][0] == protocol.LOG
    assert not any(data[43:])  # nothing of the longer frame before is left
    assert radio.send(encoder) and sockets.sent == []  # nobody listens
    sockets.received.append((frame(protocol.GREET, b"\1\0\0\0\1"), ("10.0.0.7", 4321)))
    assert radio.take(700_000) and not radio.take(700_000)
    radio.heard(700_000)
    assert radio.send(encoder) and sockets.sent.pop()[1] == ("10.0.0.7", 4321)
    radio.update(4_000_000)
    assert radio.send(encoder) and sockets.sent == []


def test_who_sends_rubbish_is_not_heard_for_a_moment():
    sockets, wlan = Sockets(), Wlan()
    wlan.up = True
    radio = Radio(wlan, sockets, 9750, Encoder())
    for start in (0, 2**30 - 30_000):
        radio.update(start)
        sockets.received.extend([(frame(protocol.GREET, b"\1\0\0\0\1") * 2, ("10.0.0.7", 4321))] * 3)
        assert radio.take(start)
        radio.shun(start)
        assert not any(radio.take((start + later) % 2**30) for later in (0, 5000, 49_999)) and len(sockets.received) == 2
        assert radio.take((start + 50_000) % 2**30)
        sockets.received.clear()
        radio.shun((start + 50_000) % 2**30)
        assert not radio.take((start + 100_000) % 2**30) and not radio.decoder.waiting()  # and nothing of it is left


def test_a_turn_that_has_been_long_leaves_datagrams_to_the_next():
    sockets, wlan = Sockets(), Wlan()
    wlan.up = True
    radio = Radio(wlan, sockets, 9750, Encoder())
    for start in (0, 2**30 - 2000):
        radio.update(start)
        sockets.received.append((frame(protocol.GREET, b"\1\0\0\0\1"), ("10.0.0.7", 4321)))
        radio.late = 4501
        assert not radio.take(start)
        radio.late = 4500
        assert radio.take(start) and not sockets.received


def test_the_longest_frame_fits_its_view():
    sockets, encoder = Sockets(), Encoder()
    wlan = Wlan()
    wlan.up = True
    radio = Radio(wlan, sockets, 9750, encoder)
    radio.update(0)
    assert radio.announce(sealed(encoder, 1390))
    assert len(decode(sockets.sent.pop()[0])[0][2]) == 1390


def test_a_radio_without_buffers_drops():
    sockets, wlan, encoder = Sockets(), Wlan(), Encoder()
    wlan.up = True
    radio = Radio(wlan, sockets, 9750, encoder)
    radio.update(0)
    sockets.received.append((frame(protocol.GREET, b"\1\0\0\0\1"), ("10.0.0.7", 4321)))
    radio.take(0)
    radio.heard(0)
    sockets.fails = True
    assert not radio.send(sealed(encoder))


def test_half_a_frame_in_a_datagram_is_forgotten():
    sockets, wlan = Sockets(), Wlan()
    wlan.up = True
    radio = Radio(wlan, sockets, 9750, Encoder())
    radio.update(0)
    whole = frame(protocol.GREET, struct.pack("<IB", 1, 1))
    for data in (whole[:9], b"", whole[9:], b"\xf7" * 256, whole):
        sockets.received.append((data, ("10.0.0.7", 1)))
    assert [radio.take(0) for _ in range(5)] == [False, False, False, False, True]


class Network:
    """The network module, writing down what is asked of it. Faults: how often connect() fails; the network that is joined already; a key refused."""

    STA_IF, AP_IF, AUTH_WPA2_PSK = 0, 1, 3

    def __init__(self, fails=0, joined=None, refuses=False):
        self.asked = asked = []
        state = {"fails": fails, "ssid": joined}

        class WLAN:
            PM_NONE = 0

            def __init__(self, interface):
                asked.append(("interface", interface))

            def active(self, flag):
                asked.append(("active", flag))

            def isconnected(self):
                return state["ssid"] is not None

            def disconnect(self):
                asked.append(("disconnect",))

            def connect(self, ssid, password):
                asked.append(("connect", ssid, password))
                if state["fails"]:
                    state["fails"] -= 1
                    raise OSError("Wifi Internal Error")

            def config(self, what=None, **settings):
                if what:
                    return state[what]
                if refuses and "key" in settings:
                    raise OSError("Wifi Invalid Argument")
                asked.append(("config", settings))

        self.WLAN = WLAN

    def hostname(self, name):
        self.asked.append(("hostname", name))


class Wifi:
    wifi_ssid = "home"
    wifi_password = "secret12"
    wifi_access_point = False


def connect(config, network):
    """What link.wifi.connect() gives with this module in place of the board's."""
    from link import wifi

    before = sys.modules.get("network")
    sys.modules["network"] = network
    try:
        return wifi.connect(config)
    finally:
        if before is None:
            del sys.modules["network"]
        else:
            sys.modules["network"] = before


def test_the_radio_joins_a_network_without_power_saving():
    network = Network()
    wlan, remark = connect(Wifi, network)
    assert wlan is not None and remark is None
    assert network.asked == [
        ("hostname", "robot"), ("interface", 0), ("active", True), ("connect", "home", "secret12"), ("config", {"pm": 0}),
    ]  # fmt: skip


def test_a_radio_that_is_still_joined_after_a_soft_reset_is_left_alone():
    network = Network(fails=9, joined="home")
    wlan, remark = connect(Wifi, network)
    assert wlan.isconnected() and remark is None
    assert [what[0] for what in network.asked] == ["hostname", "interface", "active", "config"]


def test_a_radio_that_is_joined_to_another_network_changes_over():
    network = Network(joined="other")
    connect(Wifi, network)
    assert network.asked[3:5] == [("disconnect",), ("connect", "home", "secret12")]


def test_a_radio_that_is_just_joining_is_asked_twice():
    wlan, remark = connect(Wifi, Network(fails=1))
    assert wlan is not None and remark is None
    wlan, remark = connect(Wifi, Network(fails=2))
    assert wlan is not None and "Internal Error" in remark


def test_the_radio_is_a_network():
    class Open(Wifi):
        wifi_access_point = True
        wifi_password = ""

    class Closed(Wifi):
        wifi_access_point = True

    network = Network()
    connect(Open, network)
    assert ("interface", 1) in network.asked and ("config", {"ssid": "home", "security": 0}) in network.asked
    network = Network()
    connect(Closed, network)
    assert ("config", {"ssid": "home", "key": "secret12", "security": 3}) in network.asked
    network = Network(refuses=True)
    wlan, remark = connect(Closed, network)
    assert wlan is None and "wifi.password" in remark and network.asked[-1] == ("active", False)  # or it would be open to all
