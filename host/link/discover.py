"""Which robots there are: boards on USB, and robots that announce themselves in the network."""

import time

from link import frames

from .messages import decode
from .radio import PORT, listen

# USB bridges on ESP32 boards: CP210x, CH340/CH9102, FTDI, and the chip's own
_BRIDGES = {(0x10C4, 0xEA60), (0x1A86, 0x7523), (0x1A86, 0x55D4), (0x0403, 0x6001), (0x0403, 0x6015), (0x303A, 0x1001)}


def boards() -> list[str]:
    """Addresses of serial ports that look like an ESP32 board."""
    from serial.tools import list_ports

    return [f"serial:{port.device}" for port in sorted(list_ports.comports()) if (port.vid, port.pid) in _BRIDGES]


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
