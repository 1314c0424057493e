"""Telemetry frames over WiFi. Loaded only where robot.json names a network; see serial_line.py for what a carrier has."""

import select
from time import ticks_diff, ticks_us

from micropython import const

from link.telemetry import Decoder, copy

_COMMAND = const(200)  # longest payload of a command
_DATAGRAM = const(256)
_LISTENS_US = const(3_000_000)
_JOIN_US = const(500_000)
_DEAF_US = const(50_000)
_BUSY_US = const(4500)
_FILLING = const(128)  # datagrams come in multiples of this size, so that the views of the encoder's buffer can be made beforehand


class Datagrams:
    """UDP over WiFi. Frames go to whoever sent the last valid command, for 3 s after it; hellos go to everyone.

    wlan: a started network.WLAN, or anything with `isconnected()`; sockets: the socket module; port: where the robot listens;
    encoder: the one whose frames will be sent.
    """

    signed = True

    def __init__(self, wlan, sockets, port, encoder, clock=ticks_us):
        self._clock = clock
        self._wlan = wlan
        self._sockets = sockets
        self._port = port
        self._views = [memoryview(encoder.data)[:end] for end in range(0, len(encoder.data) + 1, _FILLING)]
        self._zeros = bytes(_FILLING)
        self._socket = self._ready = self._everyone = self._from = self._peer = self._asked_us = self._deaf_us = None
        self._peer_us = 0
        self.decoder = Decoder(_COMMAND)

    def update(self, now_us):
        """Open the socket once the network is there."""
        if self._socket is None:
            if self._asked_us is None or ticks_diff(now_us, self._asked_us) > _JOIN_US:
                self._asked_us = now_us
                if self._wlan.isconnected():
                    self._bind()
        elif self._peer is not None and ticks_diff(now_us, self._peer_us) > _LISTENS_US:
            self._peer = None

    def take(self, now_us):
        """Read one datagram; True when it holds a frame. A frame never spans two."""
        if self._socket is None or self._deaf_us is not None and 0 <= ticks_diff(now_us, self._deaf_us) < _DEAF_US:
            return False
        if ticks_diff(self._clock(), now_us) > _BUSY_US:
            return False  # this turn of the loop has no time for a tag any more
        for _ in self._ready(0):
            try:
                data, self._from = self._socket.recvfrom(_DATAGRAM)
            except (OSError, MemoryError):
                continue
            if self.decoder.load(data, len(data)):
                return True
        if self.decoder.take():
            return True
        self.decoder.clear()
        return False

    def heard(self, now_us):
        """Whoever sent the last datagram is the one to send to."""
        self._peer = self._from
        self._peer_us = now_us

    def shun(self, now_us):
        """What was received last was no valid command: for a moment nothing is heard, so that a flood of such takes little of the loop's time."""
        self._deaf_us = now_us
        self.decoder.load(b"", 0)  # what else was in the datagram is forgotten with it

    def idle(self):
        """Nothing is queued here."""
        return True

    def send(self, encoder):
        """False when the radio had no buffer left, as happens when it is busy or the other end sleeps."""
        return self._peer is None or self._send(encoder, self._peer)

    def answer(self, encoder):
        """Send a frame to whoever sent the last datagram."""
        return self._send(encoder, self._from)

    def announce(self, encoder):
        """Send a frame to everyone in the network."""
        return self._socket is None or self._send(encoder, self._everyone)

    def close(self):
        """Close the socket; the radio stays as it is."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, encoder, address):
        size = encoder.size
        blocks = (size + _FILLING - 1) // _FILLING
        copy(self._zeros, 0, blocks * _FILLING - size, encoder.data, size)
        try:
            self._socket.sendto(self._views[blocks], address)
        except OSError:  # ENOMEM, ETIMEDOUT, or the network is gone for now: all pass
            return False
        return True

    def _bind(self):
        sockets = self._sockets
        bound = None
        try:
            bound = sockets.socket(sockets.AF_INET, sockets.SOCK_DGRAM)
            bound.setsockopt(sockets.SOL_SOCKET, getattr(sockets, "SO_BROADCAST", 0x20), 1)
            bound.bind(sockets.getaddrinfo("0.0.0.0", self._port)[0][-1])
            bound.setblocking(False)
            self._everyone = sockets.getaddrinfo("255.255.255.255", self._port + 1)[0][-1]
        except OSError:
            if bound is not None:
                bound.close()
            return  # no memory for it yet; the next try comes soon
        poller = select.poll()
        poller.register(bound, select.POLLIN)
        self._ready = getattr(poller, "ipoll", poller.poll)
        self._socket = bound
