"""Addresses: scheme, place, options."""

from typing import NamedTuple
from urllib.parse import parse_qsl

FORMS = "serial:/dev/ttyUSB0, udp:robot.local[:PORT], twin:COURSE[?width=550&seed=3], file:drive.rec"


class AddressError(ValueError):
    """An address that names nothing; the text says what can be written."""


class Address(NamedTuple):
    """scheme: serial, udp, twin or file. place: what stands between the colon and the question mark. options: what follows, as texts."""

    scheme: str
    place: str
    options: dict


def parse(text: str) -> Address:
    """Take an address apart. Raises AddressError."""
    scheme, colon, rest = text.partition(":")
    if not colon or scheme not in ("serial", "udp", "twin", "file"):
        raise AddressError(f"{text!r} is no address; write one of: {FORMS}")
    place, _, query = (rest, "", "") if scheme == "file" else rest.partition("?")
    if not place:
        raise AddressError(f"{text!r} names no place after the colon; write one of: {FORMS}")
    pairs = parse_qsl(query, keep_blank_values=True)
    return Address(scheme, place, dict(pairs))
