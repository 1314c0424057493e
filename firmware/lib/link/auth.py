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


def hmac_sha256(key, message):
    """HMAC of RFC 2104; MicroPython has the hash, but no hmac module."""
    if len(key) > _BLOCK:
        key = sha256(key).digest()
    key = key + bytes(_BLOCK - len(key))
    inner = sha256(bytes([byte ^ 0x36 for byte in key]))
    inner.update(message)
    outer = sha256(bytes([byte ^ 0x5C for byte in key]))
    outer.update(inner.digest())
    return outer.digest()


def tag(key, session, signed):
    """The tag of a command; signed: bytes of its frame from the version to the end of the payload, the tag left out."""
    return hmac_sha256(key, bytes(session) + bytes(signed))[:TAG]


def same(left, right):
    """True when equal, taking the same time wherever they differ."""
    if len(left) != len(right):
        return False
    different = 0
    for i in range(len(left)):
        different |= left[i] ^ right[i]
    return different == 0
