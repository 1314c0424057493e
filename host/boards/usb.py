"""USB serial ports that look like a board's."""

from serial.tools import list_ports

# USB chips found on ESP32 boards (vendor, product): Silicon Labs CP210x, WCH CH340, CH343 and CH9102, FTDI, Prolific, Espressif's own
BRIDGES = {
    (0x10C4, 0xEA60), (0x10C4, 0xEA70), (0x1A86, 0x7523), (0x1A86, 0x55D3), (0x1A86, 0x55D4), (0x0403, 0x6001), (0x0403, 0x6010), (0x0403, 0x6014),
    (0x0403, 0x6015), (0x067B, 0x2303), (0x067B, 0x23A3), (0x303A, 0x1001),
}  # fmt: skip
_MAKERS = {vendor for vendor, _ in BRIDGES}


def candidates() -> list:
    """USB serial ports, those with a chip that ESP32 boards carry first (`serial.tools.list_ports_common.ListPortInfo`)."""
    usb = [port for port in list_ports.comports() if port.vid is not None]
    known = [port for port in usb if port.vid in _MAKERS]
    return sorted(known or usb, key=lambda port: port.device)
