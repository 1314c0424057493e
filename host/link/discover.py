"""Which robots there are: boards on USB, and robots that announce themselves in the network."""

import time

from link import frames

from .messages import decode
from .radio import PORT, listen


def boards() -> list[str]:
    """Addresses of serial ports that look like an ESP32 board."""
    from host.boards import usb

    return [f"serial:{port.device}" for port in usb.candidates()]


def trouble() -> str:
    """What keeps a board that is plugged in from being used, with the cure; "" where nothing does."""
    from host.boards import usb

    return usb.obstacle()


def robots(seconds: float = 1.5, port: int = PORT) -> list[tuple[str, dict]]:
    """[(address, hello)] of the robots heard within `seconds`; each announces itself once a second."""
    found = {}
    with listen(port + 1) as heard:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            heard.settimeout(left)
            try:
                data, sender = heard.recvfrom(2048)
            except (TimeoutError, OSError):
                break
            for kind, _, payload in frames.decode(data):
                hello = decode(kind, payload)
                if hello and hello["type"] == "hello":
                    found[f"udp:{sender[0]}" + (f":{port}" if port != PORT else "")] = hello
    return sorted(found.items(), key=lambda item: item[0])
