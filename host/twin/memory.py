"""How much heap the firmware gets in the twin: what it would have on an ESP32-WROOM.

On the chip, heap and machine code share one memory. Together they had 200 KiB, and 163 with the radio on (measured on the stock image v1.24.0,
heap filled to the last block). So the more machine code, the less heap. What the modules of the emulated board take comes on top: the real
board's are in ROM.

The interpreter's list of names grows by steps, each twice as large as the one before: from 620 names on it has places for 1260, from there on for 2540.
With the emulated board's names the firmware's would take a step of 9 kB that they do not take on the chip. So the bootstrap makes so many names that the list
has room for all, and the firmware pays here for the places that it has on the chip. (host/budget counts its names without any of the twin's.)
"""

import json
import os
import tempfile
import zlib
from pathlib import Path

from host import micropython
from host.micropython import mpy

from . import image, wire

KIB = 1024
HEAP_AND_CODE = 200 * KIB
WITH_RADIO = 163 * KIB

NAMES = 1260 * 7  # bytes of the list for so many
_PROBE = "import gc\ngc.collect()\nprint('board', gc.mem_alloc(), gc.mem_alloc() + gc.mem_free())\n"
_RADIO = "import network, socket\n"
_PROBED = 256 * KIB


def board_heap(firmware, config_text, files=()):
    """Bytes of heap that the firmware in the folder has on the board with that robot.json: gc.mem_alloc() + gc.mem_free() at main.py's first line.

    files: names of those on the board besides: with map.bin it has a goal layer.
    """
    kept = image.compiled(firmware)[1].parent
    code = _remembered(kept / "machine_code.json", lambda: mpy.machine_code_bytes(firmware))
    idle = not_loaded(_screen(config_text), "map.bin" in files, "arm.json" in files)
    return (WITH_RADIO if radio(config_text) else HEAP_AND_CODE) - sum(count for name, count in code.items() if not name.startswith(idle))


def not_loaded(screen, goal, arm):
    """Where the files lie that are not loaded without these options, as a tuple of beginnings of their names."""
    places = ("lib/link/screen", screen), ("lib/goal/", goal), ("lib/arm/", arm)
    return tuple(place for place, wanted in places if not wanted)


def heap_size(port, board, board_bytes, chip=None, radio=False, fault=None):
    """What -X heapsize has to be for so many bytes of the board.

    port: micropython.Port. board: folder of the emulated board's modules, compiled for it. chip, radio, fault: see `taken_by_the_board`.
    """
    taken, whole = taken_by_the_board(port, board, chip, radio, fault)
    return ((board_bytes - NAMES) * port.heap_factor + taken) * _PROBED * port.heap_factor // whole


def taken_by_the_board(port, board, chip=None, radio=False, fault=None):
    """[bytes that the emulated board's modules take, bytes in a heap of -X heapsize=_PROBED: the rest is for its own books].

    chip: text of the chip.json that they find, None = there is none. radio: whether network and socket are among them; the firmware loads those later.
    fault: bytes of their fault.json, None = there is none.
    """
    kept = "board_heap" + ("_chip" if chip else "") + ("_radio" if radio else "") + (f"_{zlib.crc32(fault):08x}" if fault else "")
    return _remembered(board.parent / f"{kept}.json", lambda: _probe(port, board, chip, radio, fault))


def _screen(config_text):
    """Whether that robot.json has a screen."""
    try:
        return json.loads(config_text)["screen"]["kind"] != "none"
    except (ValueError, KeyError, TypeError):
        return False


def radio(config_text):
    """Whether that robot.json switches the radio on."""
    try:
        return bool(json.loads(config_text)["wifi"]["ssid"])
    except (ValueError, KeyError, TypeError):
        return False  # the firmware will say what is wrong with it


def _probe(port, board, chip, radio, fault):
    with tempfile.TemporaryDirectory(prefix="gapseeker-") as folder, open(os.devnull, "wb") as nobody:
        image.lay_out(Path(folder), board)
        if chip:
            (Path(folder) / "chip.json").write_text(chip)
        if fault:
            (Path(folder) / "fault.json").write_bytes(fault)
        (Path(folder) / "main.py").write_text(_RADIO * radio + _PROBE)
        answer, twin = os.pipe()
        try:
            os.write(twin, bytes(wire.SHORT) + wire.FAR.to_bytes(4, "little").ljust(wire.REPLY, b"\0"))  # nothing happens, for long
            words = [*port.command, "-X", f"heapsize={_PROBED * port.heap_factor}", "-m", "bootstrap", str(answer), str(nobody.fileno()), "0", "1"]
            done = micropython.run(words, 60, cwd=folder, pass_fds=(answer, nobody.fileno()), capture_output=True, text=True)
        finally:
            os.close(answer)
            os.close(twin)
    word, *figures = done.stdout.split()
    assert word == "board", done.stdout + done.stderr
    return [int(figure) for figure in figures]


def _remembered(path, make):
    """The JSON in the file, made and put there if there is none."""
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError):
        value = make()
    with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False) as file:
        json.dump(value, file)
    os.replace(file.name, path)
    return value
