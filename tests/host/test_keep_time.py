"""How long the robot stands while robot.json is written: counted in executed instructions, as the bench counts them."""

import sys
from types import ModuleType

from host.bench import blocks, costs
from host.twin import image
from params import schema

LIMIT_MS = 300  # of one piece of work while the robot stands: a watchdog of a second has room for it, and for writing the flash memory


def _counted(monkeypatch, module, path):
    """(what the module defines, callable that says the instructions executed in it so far, on the ESP32)."""
    cutter = blocks.Cutter({module: path.read_text()})
    counters = ModuleType(blocks.COUNTERS)
    counters.COUNTERS = [0] * len(cutter.blocks)
    monkeypatch.setitem(sys.modules, blocks.COUNTERS, counters)
    names = {"__name__": module}
    exec(cutter.counted[module], names)
    return names, lambda: sum(count * block.instructions for count, block in zip(counters.COUNTERS, cutter.blocks, strict=True))


def test_keeping_everything_that_can_be_tuned_is_one_short_piece(monkeypatch, tmp_path):
    names, instructions = _counted(monkeypatch, "params.json_patch", image.FIRMWARE / "lib" / "params" / "json_patch.py")
    robot = tmp_path / "robot.json"
    robot.write_bytes((image.FIRMWARE / "robot.json").read_bytes())
    monkeypatch.chdir(tmp_path)
    changed = {row[0]: 12 for row in schema.rows(schema.LIVE)}
    names["keep"]("robot.json", changed)
    took = costs.us(instructions()) / 1000
    print(f"keep: {took:.0f} ms at {costs.CLOCK_MHZ} MHz for {robot.stat().st_size} bytes")
    assert '"margin": 12' in robot.read_text()
    assert 20 < took < LIMIT_MS  # less than 20 would mean that nothing was counted
