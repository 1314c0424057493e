"""A robot on the network: UDP, with signed commands."""

import secrets
import socket
import struct
import threading
import time
from collections import deque

from host.boards import places
from link import auth, frames, protocol

from . import messages
from .base import Link, LinkError

PORT = 9750
_GREET_S = 1.0
_PATIENCE_S = 10.0
_NONCES = 8  # greetings whose answer may still be on its way


def host_and_port(place: str) -> tuple[str, int]:
    """robot.local:9750 -> (robot.local, 9750). Raises LinkError."""
    host, colon, port = place.partition(":")
    if colon and not (port.isdigit() and 0 < int(port) < 65536):
        raise LinkError(f"udp:{place}: the port must be a number from 1 to 65535")
    return host, int(port) if colon else PORT


class RadioLink(Link):
    """udp:HOST[:PORT]. Raises LinkError if the name is not known.

    The robot is greeted once a second, each time with a new nonce; its HELLO in answer tells its session, its counter and its board, and proves
    with a tag over the nonce that it is no other's and no old one. The key is the one kept when that board was flashed
    (`host.boards.places.key_path`). Until such a hello has come, commands are not sent; without the key they never are. The counter is the
    session's: in a new one it starts again. A stop that was the last order of a session is given again in the next.

    key: overrides the one that was kept. forged: hellos that prove nothing, though there is a key for their board.
    """

    def __init__(self, address: str, place: str, key: bytes | None = None):
        super().__init__(address)
        host, port = host_and_port(place)
        try:
            self._peer = socket.getaddrinfo(host, port, socket.AF_INET, socket.SOCK_DGRAM)[0][4]
        except OSError:
            raise LinkError(f"no robot called {host} in this network: is it on, and in the same network? Try its IP address") from None
        self.forged = 0
        self._given_key = key
        self._key: bytes | None = None
        self._session = b""
        self._nonces: deque[bytes] = deque(maxlen=_NONCES)
        self._complained: set[str] = set()  # boards whose key was missing or wrong
        self._stop_wanted = False
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

    def drive(self, what: str, af: float = 0, ar: float = 0, v: float = 90) -> None:
        self._stop_wanted = what == "stop"
        super().drive(what, af, ar, v)

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
        return bool(self._session)

    def _nonce(self) -> bytes:
        nonce = secrets.token_bytes(auth.TAG)
        self._nonces.append(nonce)
        return nonce

    def _is_proven(self, hello: dict, payload: bytes) -> bool:
        key, trouble = (self._given_key, "") if self._given_key else kept_key(hello["board"])
        if key is None:
            if not self._session and hello["board"] not in self._complained:
                self._complained.add(hello["board"])
                self._put({"type": "text", "text": f"{trouble} for {hello['robot']} (board {hello['board']}) on this computer: it can be watched "
                           f"only by cable. Run make deploy with the robot on USB, or copy the key to {places.key_path(hello['board'])}"})  # fmt: skip
            return not self._session  # it can be looked at, as long as there is none to command
        tag = payload[struct.calcsize(protocol.HELLO_FORMAT) - auth.TAG :][: auth.TAG]
        for nonce in list(self._nonces):
            if secrets.compare_digest(messages.hello_tag(key, nonce, payload), tag):
                while self._nonces and self._nonces.popleft() != nonce:
                    pass  # nobody shall come with an older one
                self._key = key
                return True
        if any(tag):
            self.forged += 1
        elif not self._session and hello["board"] not in self._complained:
            self._complained.add(hello["board"])
            self._put(
                {"type": "text", "text": f"{hello['robot']} is there and asked to prove itself; if nothing follows, its firmware is too old: make deploy"}
            )
        return False

    def _greeted(self, hello: dict) -> None:
        super()._greeted(hello)
        if self._key is None:
            return
        session = bytes.fromhex(hello["session"])
        with self._lock:
            if session == self._session:
                self._counter = max(self._counter, hello["counter"])
                return
            self._session = session
            self._counter = hello["counter"]
        threading.Thread(target=self._begin_session, daemon=True).start()

    def _begin_session(self) -> None:
        if self._stop_wanted:
            self.drive("stop")  # it may never have heard it
        self.greet()

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


def kept_key(board: str) -> tuple[bytes | None, str]:
    """(key, "") of a board, or (None, what is wrong). board: hex digits."""
    path = places.key_path(board)
    try:
        key = path.read_bytes()
    except OSError:
        return None, "no key"
    return (key, "") if len(key) == places.KEY_SIZE else (None, f"no key of {places.KEY_SIZE} bytes, but one of {len(key)},")
