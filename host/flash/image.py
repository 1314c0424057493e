"""The stock MicroPython image: fetched once, and never trusted without its hash."""

import hashlib
import urllib.error
import urllib.request
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from host.boards.errors import FlashError


@dataclass(frozen=True)
class Image:
    """A published image: its address, length in bytes and SHA-256 in hex."""

    url: str
    size: int
    sha256: str

    @property
    def name(self) -> str:
        return self.url.rsplit("/", 1)[1]


PINNED = Image(
    url="https://micropython.org/resources/firmware/ESP32_GENERIC-20241025-v1.24.0.bin",
    size=1_691_408,
    sha256="648e655fdaa8c31ece4e8f2a5c7815b015a7bca1c8db56246287799164ad9bff",
)

_APP_MAGIC = 0xE9  # first byte of every Espressif image
_CHIP_ID = slice(12, 14)  # little-endian chip number in the extended header (ESP-IDF app image format)
_ESP32 = 0


def fetch(image: Image, folder: Path) -> Path:
    """Path of the image in `folder`, downloaded there if it is not there yet. Raises FlashError if it cannot be had intact."""
    path = folder / image.name
    if path.exists() and not _fault(path, image):
        return path
    folder.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    try:
        with urllib.request.urlopen(image.url, timeout=30) as response, open(part, "wb") as file:
            with tqdm.wrapattr(file, "write", total=image.size, desc=image.name, unit_scale=True, leave=False) as out:
                while chunk := response.read(1 << 16):
                    out.write(chunk)
    except (urllib.error.URLError, OSError) as error:
        part.unlink(missing_ok=True)
        reason = getattr(error, "reason", None) or error
        raise FlashError(
            f"cannot download {image.url}: {reason}",
            f"go online, or fetch it elsewhere and name it: FIRMWARE={image.name}",
        ) from None
    if fault := _fault(part, image):
        part.unlink()
        raise FlashError(
            f"the downloaded image is not the one that was published: {fault}",
            "try again; if it stays so, something between here and micropython.org changes it: fetch it over another network",
        )
    return part.replace(path)


def given(path: Path) -> Path:
    """The user's own image, checked to be one for the ESP32. Raises FlashError if it is not."""
    try:
        start = path.read_bytes()[:16]
    except OSError as error:
        raise FlashError(f"cannot read {path}: {error.strerror}", "name an existing file: FIRMWARE=file.bin") from None
    if len(start) < 16 or start[0] != _APP_MAGIC:
        raise FlashError(f"{path} is no ESP32 image", f"use the .bin of micropython.org/download/ESP32_GENERIC, such as {PINNED.name}")
    if (chip := int.from_bytes(start[_CHIP_ID], "little")) != _ESP32:
        raise FlashError(f"{path} is for another chip (number {chip}, the ESP32 is {_ESP32})", "use an ESP32_GENERIC image")
    return path


def uses_psram(path: Path) -> bool:
    """Whether the image is one for modules with PSRAM: its name of the board says so."""
    return b"with SPIRAM" in path.read_bytes()


def _fault(path: Path, image: Image) -> str:
    """What is wrong with the file; empty if nothing is."""
    data = path.read_bytes()
    if len(data) != image.size:
        return f"{len(data)} bytes instead of {image.size}"
    if (digest := hashlib.sha256(data).hexdigest()) != image.sha256:
        return f"SHA-256 {digest} instead of {image.sha256}"
    return ""
