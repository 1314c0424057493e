"""What the firmware may take of the board's memory and time. KiB = 1024 bytes; live: of the heap, after a collection."""

from dataclasses import dataclass

KIB = 1024
# For what is still to come: (what, bytes of heap, bytes of machine code)
KEPT_FREE = (("safety", 2 * KIB, 0), ("goal layer", 10 * KIB, 2 * KIB), ("arm", 4 * KIB, 0))
COMES_AND_GOES = 8 * KIB


@dataclass(frozen=True)
class Row:
    """A figure and what it has to keep to; value None: not measured."""

    name: str
    value: float | None
    limit: float
    unit: str

    @property
    def missed(self) -> bool:
        return self.value is not None and self.value > self.limit

    def text(self) -> str:
        factor = KIB if self.unit == "KiB" else 1
        shown = "not measured" if self.value is None else f"{self.value / factor:.1f}"
        verdict = "" if self.value is None else f"misses by {(self.value - self.limit) / factor:.1f}" if self.missed else "kept"
        return f"{self.name:44} {shown:>12} {self.limit / factor:8.1f} {self.unit:4} {verdict}"


def rows(figures: dict) -> list[Row]:
    """The rows of the table, for the figures of report.measure."""
    live = figures["live_bytes"]
    return [
        Row("live, USB", live["usb"], 100 * KIB, "KiB"),
        Row("more with WiFi connected, telemetry flowing", _difference(live, "wifi", "usb"), 5 * KIB, "KiB"),
        Row("more with a screen besides", _difference(live, "screen", "wifi"), 4 * KIB, "KiB"),
        Row("highest ever over live", figures["peak_bytes"], COMES_AND_GOES, "KiB"),
        Row("machine code", figures["native_bytes"], 36 * KIB, "KiB"),
        Row("machine code with a screen, besides", figures["native_screen_bytes"], 10 * KIB, "KiB"),
        Row("machine code with a map, besides", figures["native_goal_bytes"], 2 * KIB, "KiB"),
        Row("start, main.py to the first decision", figures["start_ms_esp32"], 4000, "ms"),
        Row("worst turn of the loop", figures["turn_worst_ms_esp32"], 9.5, "ms"),
        Row("link.update, worst", figures["link_worst_ms_esp32"], 1.5, "ms"),
        Row("screen.update, worst", figures["screen_worst_ms_esp32"], 1.5, "ms"),
        Row("to the screen, of what 115200 baud carry", figures["screen_bytes_s"], 11520, "B/s"),
    ]


def _difference(live: dict, more: str, less: str) -> int | None:
    return None if live[more] is None or live[less] is None else live[more] - live[less]
