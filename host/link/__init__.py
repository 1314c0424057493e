"""Links to a robot, named by an address; robot, twin and recording differ in nothing else.

    serial:/dev/ttyUSB0               a robot on USB
    udp:robot.local, udp:192.168.4.1:9750    a robot on the network
    twin:z?width=550&seed=3           the twin, see `host.link.twin`
    file:drive.rec                    a recording, see `host.link.playback`

    with connect("twin:z?width=550") as link:
        link.drive("auto")
        while message := link.get(timeout=1):
            print(message["type"])

Messages are dicts; `host.link.messages` lists them.

    address     addresses taken apart
    base        what all links share: decoding, commands, taps
    messages    payloads of the wire format <-> dicts
    wire, radio, twin, playback    one kind of link each
    discover    which robots there are
"""

from .address import AddressError, parse
from .base import Link, LinkError

__all__ = ["AddressError", "Link", "LinkError", "connect"]


def connect(text: str, begin: bool = True) -> Link:
    """Open the link that an address names. Raises AddressError or LinkError.

    begin: False for a twin that is to wait for `Link.begin`; a robot waits for nobody.
    """
    address = parse(text)
    # Imported when needed: the twin needs numpy, the serial line pyserial.
    if address.scheme == "serial":
        from .wire import WireLink

        return WireLink(text, address.place)
    if address.scheme == "udp":
        from .radio import RadioLink

        return RadioLink(text, address.place)
    if address.scheme == "twin":
        from .twin import TwinLink

        return TwinLink(text, address.place, address.options, begin)
    from .playback import PlaybackLink

    return PlaybackLink(text, address.place)
