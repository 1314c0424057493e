"""USB serial ports that look like a board's."""

import os
from pathlib import Path

from serial.tools import list_ports

# USB chips found on ESP32 boards (vendor, product): Silicon Labs CP210x, WCH CH340, CH343 and CH9102, FTDI, Prolific, Espressif's own
BRIDGES = {
    (0x10C4, 0xEA60), (0x10C4, 0xEA70), (0x1A86, 0x7523), (0x1A86, 0x55D3), (0x1A86, 0x55D4), (0x0403, 0x6001), (0x0403, 0x6010), (0x0403, 0x6014),
    (0x0403, 0x6015), (0x067B, 0x2303), (0x067B, 0x23A3), (0x303A, 0x1001),
}  # fmt: skip
DEVICES = Path("/sys/bus/usb/devices")
_WITHOUT_PORT = (
    "On Ubuntu and Debian the Braille driver brltty takes it for its own: sudo apt remove brltty, then plug the board in again. "
    "Elsewhere the kernel's driver is missing (cp210x, ch341, ftdi_sio)"
)
_MAKERS = {vendor for vendor, _ in BRIDGES}


def candidates() -> list:
    """USB serial ports, those with a chip that ESP32 boards carry first (`serial.tools.list_ports_common.ListPortInfo`)."""
    usb = [port for port in list_ports.comports() if port.vid is not None]
    known = [port for port in usb if port.vid in _MAKERS]
    return sorted(known or usb, key=lambda port: port.device)


def obstacle(devices: Path | None = None) -> str:
    """Why a board that is plugged in may have no port, or none that may be opened, with the cure; "" where nothing is known to be in the way.

    devices: Linux' folder of USB devices.
    """
    devices = devices or DEVICES
    for device in sorted(devices.glob("*")) if devices.is_dir() else ():
        try:
            number = tuple(int((device / name).read_text(), 16) for name in ("idVendor", "idProduct"))
        except (OSError, ValueError):
            continue
        if number in BRIDGES and not _has_port(device):
            return f"a board's USB chip ({number[0]:04x}:{number[1]:04x}) is plugged in, but has no port. {_WITHOUT_PORT}"
    shut = [port.device for port in candidates() if not os.access(port.device, os.R_OK | os.W_OK)]
    if shut:
        return f"you may not use {shut[0]}: sudo usermod -aG dialout $USER (uucp on Arch), then log out and in again"
    return ""


def _has_port(device: Path) -> bool:
    """Whether one of a device's interfaces is a tty."""
    return any(True for pattern in ("*/tty*", "*/tty/tty*") for _ in device.glob(pattern))
