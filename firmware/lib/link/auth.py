"""Who may command the robot over the network: HMAC-SHA256 over each command, and a counter that never repeats.

    tag = first 8 bytes of HMAC-SHA256(key, session | frame from its version byte to the end of the payload before the tag)

The key (32 bytes, network.key on the board) is made when the robot is flashed. The session is 8 random bytes drawn at each boot and
told in the hello, so a datagram recorded before a restart fails after it; the counter, first in every payload, must grow within the session, so
one recorded since fails as well. Nothing has to be written to flash for this.

8 bytes are enough, though RFC 2104 recommends 10: a guess can only be tried on the robot itself, one datagram a guess, and within one
session. At ten thousand datagrams a second an even chance takes thirty million years.

A stop with a right tag is obeyed even when its counter is old: nobody is harmed by a robot that stands.
"""

from hashlib import sha256

TAG = 8
SESSION = 8
_BLOCK = 64


class Signer:
    """HMAC of RFC 2104 under one key; MicroPython has the hash, but no hmac module. What depends on the key alone is made once."""

    def __init__(self, key):
        if len(key) > _BLOCK:
            key = sha256(key).digest()
        key = key + bytes(_BLOCK - len(key))
        self._inner = bytes([byte ^ 0x36 for byte in key])
        self._outer = bytes([byte ^ 0x5C for byte in key])

    def digest(self, *parts):
        """HMAC-SHA256 of the parts, one after the other."""
        inner = sha256(self._inner)
        for part in parts:
            inner.update(part)
        outer = sha256(self._outer)
        outer.update(inner.digest())
        return outer.digest()

    def tag(self, session, covered):
        """The tag of a command; covered: bytes of its frame from the version to the end of the payload, the tag left out."""
        return self.digest(session, covered)[:TAG]

    def signed(self, session, covered, tag):
        """True when the tag is right; it takes the same time wherever it is wrong."""
        right = self.tag(session, covered)
        different = len(right) ^ len(tag)
        for i in range(min(len(right), len(tag))):
            different |= right[i] ^ tag[i]
        return different == 0
