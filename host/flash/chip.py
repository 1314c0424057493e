"""What kind of ESP32 is on the board, and whether robot.json asks for pins that it does not have."""

import json
from dataclasses import dataclass

from host.boards.errors import FlashError

# By the package number in the eFuses (ESP32 Technical Reference Manual, EFUSE_BLK0_RDATA3; esptool's names)
PACKAGES = {
    0: "ESP32-D0WDQ6",
    1: "ESP32-D0WD",
    2: "ESP32-D2WD",
    4: "ESP32-U4WDH",
    5: "ESP32-PICO-D4",
    6: "ESP32-PICO-V3-02",
    7: "ESP32-D0WDR2-V3",
}
_FLASH_INSIDE = ("D2WD", "U4WDH", "PICO")
_PSRAM_INSIDE = ("D0WDR2",)
_INNER_PINS = (16, 17)
_LARGE_HEAP = 1 << 20  # a heap as large as this lies in PSRAM
_PINS = {  # groups and keys of robot.json that name a GPIO
    "lidar": ("rx", "motor_pin"),
    "i2c": ("scl", "sda"),
    "pins": ("output_enable", "stop_button", "battery"),
    "screen": ("tx", "rx"),
}
_INSTEAD = {"rx": "34 or 36 (they only receive, which is enough)", "stop_button": "23", "battery": "34, 35, 36 or 39"}


@dataclass(frozen=True)
class Chip:
    """name: as esptool calls it. calibrated: whether the ADC is; None: not known. heap: bytes that MicroPython has; 0: not known yet."""

    name: str
    calibrated: bool | None = None
    heap: int = 0

    @property
    def has_large_heap(self) -> bool:
        """MicroPython uses PSRAM: a heap of megabytes."""
        return self.heap >= _LARGE_HEAP

    @property
    def inner_use(self) -> str:
        """What GPIO 16 and 17 are for on this chip; empty if they are free."""
        if any(part in self.name for part in _FLASH_INSIDE):
            return "its flash memory"
        if any(part in self.name for part in _PSRAM_INSIDE) or self.has_large_heap:
            return "its PSRAM"
        return ""


def check_pins(chip: Chip, settings: bytes) -> None:
    """Raise FlashError if robot.json uses a GPIO that this chip needs for itself. Settings that cannot be read are somebody else's to tell."""
    try:
        config = json.loads(settings)
        wrong = _wrong_pins(config) if chip.inner_use else []
    except (ValueError, AttributeError):
        return
    if wrong:
        raise FlashError(
            f"{chip.name} needs GPIO 16 and 17 for {chip.inner_use}, and robot.json has " + ", ".join(f"{key} = {pin}" for key, pin in wrong),
            "wire and set "
            + "; ".join(f"{key} to {_INSTEAD.get(key.partition('.')[2], 'a free GPIO such as 4, 13 or 14')}" for key, _ in wrong)
            + "; a board that has none can be told beforehand: put such a robot.json into firmware/",
        )


def remarks(chip: Chip, settings: bytes) -> list[str]:
    """What a person should know of this chip, though it works."""
    try:
        battery = json.loads(settings).get("pins", {}).get("battery")
    except (ValueError, AttributeError):
        battery = None
    if chip.calibrated is False and battery is not None:
        return ["its ADC was not calibrated at the factory: the battery's voltage is an estimate, to a tenth or so"]
    return []


def _wrong_pins(config: dict) -> list[tuple[str, int]]:
    screen = config.get("screen", {}).get("kind", "none") != "none"
    return [
        (f"{group}.{key}", config[group][key])
        for group, keys in _PINS.items()
        if group in config and (group != "screen" or screen)
        for key in keys
        if config[group].get(key) in _INNER_PINS
    ]
