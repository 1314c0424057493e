"""All figures of a robot.json, measured, and what the chip's memory has left."""

from pathlib import Path

from host import micropython
from host.bench import figures
from host.bench.measure import BenchError
from host.twin import image

from . import chip_memory, peak, rooms, targets, trace

SCREEN = "link.screen"  # modules that are loaded with a screen only
GOAL = "goal."  # with a map only
OPTIONS = (SCREEN, GOAL, "arm.")


def live(config: dict, firmware: Path = image.FIRMWARE) -> dict[str, int | None]:
    """Bytes of the heap in the steady loop for each of trace.OPTIONS; None where it does not start."""
    found: dict[str, int | None] = {}
    for option, changes in trace.OPTIONS.items():
        with trace.board(trace.merged(config, changes), firmware) as folder:
            found[option] = trace.start(folder).live
    return found


def measure(config: dict, firmware: Path = image.FIRMWARE) -> dict:
    """The figures that `--json` prints. config: a robot.json; its own options are those of "usb"."""
    pieces = trace.native_pieces(firmware)
    lives = live(config, firmware)
    return {
        "live_bytes": lives,
        "peak_bytes": peak.highest(config, firmware) if lives["usb"] else None,
        "native_bytes": sum(sum(sizes) for module, sizes in pieces.items() if not module.startswith(OPTIONS)),
        "native_screen_bytes": sum(sum(sizes) for module, sizes in pieces.items() if module.startswith(SCREEN)),
        "native_goal_bytes": sum(sum(sizes) for module, sizes in pieces.items() if module.startswith(GOAL)),
        **_times(firmware),
        "word_bytes": micropython.find().word_bytes,
    }


def _times(firmware: Path) -> dict[str, float | None]:
    """Milliseconds at 240 MHz, modelled by the bench; None where it cannot."""
    try:
        return figures.times(firmware)
    except BenchError:
        return dict.fromkeys(("start_ms_esp32", "turn_worst_ms_esp32", "link_worst_ms_esp32", "screen_worst_ms_esp32", "screen_bytes_s"))


def chip(config: dict, firmware: Path = image.FIRMWARE) -> dict[str, chip_memory.ChipMemory | chip_memory.NoRoom]:
    """For each of trace.OPTIONS the chip's memory after its start, or what did not fit."""
    pieces = trace.native_pieces(firmware)
    found: dict[str, chip_memory.ChipMemory | chip_memory.NoRoom] = {}
    for option, changes in trace.OPTIONS.items():
        with trace.board(trace.merged(config, changes), firmware) as folder:
            try:
                found[option] = chip_memory.replay(trace.record(folder, pieces))
            except chip_memory.NoRoom as error:
                found[option] = error
    return found


def text(config: dict, figures: dict, firmware: Path = image.FIRMWARE) -> str:
    """The tables that a person reads."""
    lines = [f"{'':44} {'now':>12} {'at most':>8}"]
    lines += [row.text() for row in targets.rows(figures)]
    if figures["word_bytes"] != 4:
        lines += ["", "Measured with words of 64 bits: the board takes about half. `make setup` gets a MicroPython of 32 bits where it can be had."]
    lines += ["", *_rooms(config, firmware), "", *_chip(chip(config, firmware))]
    return "\n".join(lines)


def _rooms(config: dict, firmware: Path) -> list[str]:
    with trace.board(config, firmware) as folder:
        found, whole = rooms.measure(folder, trace.native_pieces(firmware))
    lines = [f"{'bytes of the heap, and of machine code':40} {'arrays':>8} {'code':>8} {'names':>8} {'all':>8} {'machine code':>14}"]
    explained = 0
    for name, room in sorted(found.items(), key=lambda item: -(item[1].arrays + item[1].code + item[1].names)):
        heap = room.arrays + room.code + room.names
        explained += heap
        lines.append(f"  {name:38} {room.arrays:8} {room.code:8} {room.names:8} {heap:8} {room.native:14}")
    lines.append(f"  {'objects, spare names, the interpreter':38} {'':26} {whole - explained:8}")
    lines.append(f"  {'live':38} {'':26} {whole:8} {sum(room.native for room in found.values()):14}")
    return lines


def _chip(found: dict) -> list[str]:
    lines = ["left on a board without PSRAM (model)         heap   machine code"]
    for option, memory in found.items():
        if isinstance(memory, chip_memory.NoRoom):
            lines.append(f"  {option:38} does not start: {memory}")
            continue
        lines.append(f"  {option:38} {memory.heap_left:8} {memory.code_left:14}")
    for what, heap, code in targets.KEPT_FREE:
        lines.append(f"  kept free for: {what:23} {heap:8} {code:14}")
    lines.append(f"  {'kept free for what comes and goes':38} {targets.COMES_AND_GOES:8}")
    return lines
