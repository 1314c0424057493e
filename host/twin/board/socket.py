"""Stands for the ESP32 port's `socket`, UDP only: the same calls and errors, no wire. Sockets are small objects; what the network stack holds lies
outside the heap there, and is told through network.tell.

For a test: `inbox` holds (data, address) to be received, `sent` counts the datagrams, `last` is (data, address) of the last one if `keeps`,
`busy` is how many of the next sendto raise OSError(ENOMEM), as when the radio has no buffer left.

Source: MicroPython ports/esp32/modsocket.c.
"""

import io

from micropython import const

AF_INET = const(2)
SOCK_STREAM = const(1)
SOCK_DGRAM = const(2)
SOL_SOCKET = const(0xFFF)
SO_REUSEADDR = const(4)
SO_BROADCAST = const(0x20)
IPPROTO_UDP = const(17)

_ENOMEM = const(12)
_ENOTCONN = const(128)
_EAGAIN = const(11)
_POLL = const(3)
_READABLE = const(1)
_WRITABLE = const(4)

inbox = []
sent = 0
last = None
keeps = False
busy = 0


class socket(io.IOBase):
    """A datagram socket."""

    def __init__(self, family=AF_INET, kind=SOCK_STREAM, protocol=0):
        self._open = True

    def bind(self, address):
        """Listen; address as of getaddrinfo."""

    def connect(self, address):
        """Send there from now on."""

    def setsockopt(self, level, option, value):
        """Accepted."""

    def settimeout(self, seconds):
        """Accepted: nothing here waits."""

    def setblocking(self, blocking):
        """Accepted: nothing here waits."""

    def sendto(self, data, address):
        """Send a datagram; returns its length. OSError(ENOMEM) while `busy`."""
        global sent, last, busy
        if not self._open:
            raise OSError(_ENOTCONN)
        if busy > 0:
            busy -= 1
            raise OSError(_ENOMEM)
        sent += 1
        if keeps:
            last = bytes(data), address
        return len(data)

    def recvfrom(self, count):
        """(data, address) of the next datagram, both new objects, as on the port."""
        if not inbox:
            raise OSError(_EAGAIN)
        data, address = inbox.pop(0)
        return bytes(data[:count]), (address[0], address[1])

    def ioctl(self, request, argument):
        """For select.poll."""
        if request == _POLL:
            return argument & ((_READABLE if inbox else 0) | _WRITABLE)
        return -22

    def close(self):
        """Give the port back."""
        self._open = False


def getaddrinfo(host, port, family=0, kind=0, protocol=0, flags=0):
    """[(family, kind, protocol, name, (host, port))]; names are not looked up."""
    return [(AF_INET, SOCK_STREAM, 0, "", (host, port))]
