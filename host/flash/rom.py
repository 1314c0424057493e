"""The chip's ROM loader, through esptool: erase, write, and read what is there."""

import re
from pathlib import Path

from host.boards.errors import FlashError

from . import tools
from .chip import Chip

IMAGE_AT = 0x1000  # where the ESP32's ROM looks for the bootloader that begins the image
FILES_AT = 0x200000  # the file system's partition of a stock 4 MiB image
FILES_SIZE = 0x200000
HEAD_SIZE = 0x2000  # the two blocks in which littlefs keeps its superblock


def erase_command(port: str, baud: int) -> list[str]:
    return tools.esptool(port, "erase-flash", baud=baud)


def write_command(port: str, image: Path | str, baud: int) -> list[str]:
    """esptool compares the MD5 of what it wrote by itself and fails if it differs."""
    return tools.esptool(port, "write-flash", hex(IMAGE_AT), str(image), baud=baud)


def read_command(port: str, size: int, target: Path | str, baud: int) -> list[str]:
    """Reads the first `size` bytes of the file system's partition."""
    return tools.esptool(port, "read-flash", hex(FILES_AT), hex(size), str(target), baud=baud)


def identify_command(port: str, baud: int) -> list[str]:
    """esptool names the chip and what it has before it does anything else."""
    return tools.esptool(port, "read-mac", baud=baud)


def identify(port: str, baud: int) -> tuple[str, Chip]:
    """(the chip's factory MAC address in hex, which is also MicroPython's machine.unique_id(), the chip)."""
    said = tools.read(identify_command(port, baud))
    found = re.search(r"MAC:\s*((?:[0-9a-f]{2}:){5}[0-9a-f]{2})", said)
    if not found:
        raise FlashError(f"esptool named no MAC address:\n{said}", "hold the BOOT button while it connects; try another cable")
    name = re.search(r"Chip type:\s*(\S+)", said)
    features = re.search(r"Features:(.*)", said)
    chip = Chip(name[1] if name else "ESP32", "Vref calibration" in features[1] if features else None)
    return found[1].replace(":", ""), chip
