"""A robot on the network: UDP, with signed commands."""

import socket
import struct
import threading
import time

from host.flash import places
from link import auth, frames, protocol

from .base import Link, LinkError

PORT = 9750
_GREET_S = 1.0
_PATIENCE_S = 10.0


def host_and_port(place: str) -> tuple[str, int]:
    """robot.local:9750 -> (robot.local, 9750). Raises LinkError."""
    host, colon, port = place.partition(":")
    if colon and not (port.isdigit() and 0 < int(port) < 65536):
        raise LinkError(f"udp:{place}: the port must be a number from 1 to 65535")
    return host, int(port) if colon else PORT


class RadioLink(Link):
    """udp:HOST[:PORT]. Raises LinkError if the name is not known.

    The robot's hello, sent to everyone once a second and to whoever greets it, tells its session and its board; the key is the one kept when
    that board was flashed (`host.flash.places.key_path`). Until a hello has come, commands are not sent; without the key they never are.

    key: overrides the one that was kept.
    """

    def __init__(self, address: str, place: str, key: bytes | None = None):
        super().__init__(address)
        host, port = host_and_port(place)
        try:
            self._peer = socket.getaddrinfo(host, port, socket.AF_INET, socket.SOCK_DGRAM)[0][4]
        except OSError:
            raise LinkError(f"no robot called {host} in this network: is it on, and in the same network? Try its IP address") from None
        self._given_key = key
        self._key: bytes | None = None
        self._session = b""
        self._open = True
        self._heard = time.monotonic()
        self._silent = False
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("", 0))
        self._socket.settimeout(0.2)
        self._announcements = listen(port + 1)
        threading.Thread(target=self._read, args=(self._socket,), daemon=True).start()
        threading.Thread(target=self._read, args=(self._announcements,), daemon=True).start()
        threading.Thread(target=self._keep_greeting, daemon=True).start()

    def close(self) -> None:
        self._open = False
        self._socket.close()
        self._announcements.close()

    def _read(self, where: socket.socket) -> None:
        where.settimeout(0.2)
        while self._open:
            try:
                data, sender = where.recvfrom(2048)
            except TimeoutError:
                continue
            except OSError:
                return
            if sender[0] == self._peer[0] and (where is self._socket or not self._is_known(data)):
                self._heard = time.monotonic()
                with self._receiving:
                    self._receive(data)

    _receiving = threading.Lock()

    def _is_known(self, data: bytes) -> bool:
        """Announcements tell nothing new once the robot sends to us."""
        return bool(self._session) and not data[3:4] == bytes([protocol.HELLO])

    def _greeted(self, hello: dict) -> None:
        super()._greeted(hello)
        session = bytes.fromhex(hello["session"])
        if session != self._session:
            self._session = session
            self._key = self._given_key or _kept_key(hello["board"])
            self._counter = hello["counter"]
            if self._key is None:
                self._put({"type": "text", "text": f"no key for {hello['robot']} (board {hello['board']}) on this computer: it can be watched "
                           f"only by cable. Run make deploy with the robot on USB, or copy the key to {places.key_path(hello['board'])}"})  # fmt: skip
            else:
                threading.Thread(target=self.greet, daemon=True).start()
        self._counter = max(self._counter, hello["counter"])

    def _keep_greeting(self) -> None:
        while self._open:
            self.greet(names=False)
            time.sleep(_GREET_S)
            silent = time.monotonic() - self._heard > _PATIENCE_S
            if silent and not self._silent:
                self._put({"type": "text", "text": f"nothing heard from {self._peer[0]} for {_PATIENCE_S:.0f} s: is it on, and in this network?"})
            self._silent = silent

    def _frame(self, kind: int, payload: bytes) -> bytes:
        if self._key is None:
            # Without the session nothing can be signed; a greeting that is not makes the robot tell it.
            return frames.frame(kind, payload) if kind == protocol.GREET and not self._session else b""
        head = struct.pack("<BBHH", protocol.VERSION, kind, self._sequence_out & 0xFFFF, len(payload) + auth.TAG)
        return frames.frame(kind, payload + auth.Signer(self._key).tag(self._session, head + payload), self._sequence_out)

    def _send(self, data: bytes) -> None:
        if not data:
            return
        try:
            self._socket.sendto(data, self._peer)
        except OSError:
            pass  # the network is gone for now; the robot stops by itself


def listen(port: int) -> socket.socket:
    """Socket that hears the announcements of robots; several programs may listen at once."""
    heard = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    heard.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    if hasattr(socket, "SO_REUSEPORT"):
        heard.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    heard.bind(("", port))
    return heard


def _kept_key(board: str) -> bytes | None:
    path = places.key_path(board)
    return path.read_bytes() if path.exists() else None
