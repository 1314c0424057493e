"""Telemetry frames over WiFi. Loaded only where robot.json names a network; see carriers.py for what a carrier has."""

import select
from time import ticks_diff

from micropython import const

from link.telemetry import MAX_FRAME, Decoder

_COMMAND = const(200)  # longest payload of a command
_LISTENS_US = const(3_000_000)
_JOIN_US = const(500_000)


class Datagrams:
    """UDP over WiFi. Frames go to whoever sent the last valid command, for 3 s after it; hellos go to everyone.

    wlan: a started network.WLAN, or anything with `isconnected()`; sockets: the socket module; port: where the robot listens.
    """

    signed = True

    def __init__(self, wlan, sockets, port):
        self._wlan = wlan
        self._sockets = sockets
        self._port = port
        self._socket = None
        self._ready = None
        self._everyone = None
        self._from = None
        self._peer = None
        self._peer_us = 0
        self._asked_us = None
        self.busy = False
        self.decoder = Decoder(_COMMAND, ahead=64)

    def update(self, now_us):
        """Open the socket once the network is there."""
        if self._socket is None:
            if self._asked_us is None or ticks_diff(now_us, self._asked_us) > _JOIN_US:
                self._asked_us = now_us
                if self._wlan.isconnected():
                    self._bind()
            return
        if self.busy and ticks_diff(now_us, self._peer_us) > _LISTENS_US:
            self.busy = False

    def take(self, now_us):
        """Read one datagram; True when it holds a frame. A frame never spans two."""
        if self._socket is None:
            return False
        decoder = self.decoder
        for _ in self._ready(0):
            try:
                data, self._from = self._socket.recvfrom(256)
            except OSError:
                continue
            decoder.clear()
            decoder.feed(data, 0, min(len(data), decoder.room()))
        return decoder.take()

    def heard(self, now_us):
        """Whoever sent the last datagram is the one to send to."""
        self._peer = self._from
        self._peer_us = now_us
        self.busy = True

    def send(self, encoder, size, now_us):
        """Send a frame; False when the radio had no buffer left, as happens when it is busy or the other end sleeps."""
        return not self.busy or self._send(encoder, size, self._peer)

    def room(self):
        """Nothing is queued here."""
        return MAX_FRAME

    def answer(self, encoder, size):
        """Send a frame to whoever sent the last datagram."""
        return self._send(encoder, size, self._from)

    def announce(self, encoder, size):
        """Send a frame to everyone in the network."""
        return self._socket is None or self._send(encoder, size, self._everyone)

    def close(self):
        """Close the socket; the radio stays as it is."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _send(self, encoder, size, address):
        try:
            self._socket.sendto(encoder.datagram(size), address)
        except OSError:  # ENOMEM, ETIMEDOUT, or the network is gone for now: all pass
            return False
        return True

    def _bind(self):
        sockets = self._sockets
        try:
            bound = sockets.socket(sockets.AF_INET, sockets.SOCK_DGRAM)
            bound.setsockopt(sockets.SOL_SOCKET, getattr(sockets, "SO_BROADCAST", 0x20), 1)
            bound.bind(sockets.getaddrinfo("0.0.0.0", self._port)[0][-1])
            bound.setblocking(False)
            self._everyone = sockets.getaddrinfo("255.255.255.255", self._port + 1)[0][-1]
        except OSError:
            return  # no memory for it yet; the next try comes soon
        poller = select.poll()
        poller.register(bound, select.POLLIN)
        self._ready = getattr(poller, "ipoll", poller.poll)
        self._socket = bound
