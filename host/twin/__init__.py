"""The digital twin: the robot's unmodified firmware in a world made of registers and lidar bytes.

    from host.twin import run
    result = run("Z", width=550, seed=3)

The firmware runs in a process of its own, under MicroPython or CPython, with a `machine` and a `time` whose clock is the twin's: it waits
while the twin computes and the other way round, so a run is the same every time and as fast as this machine allows. The twin knows
nothing of what the firmware means to do; it sees bytes on I2C, pins and serial lines, as the electronics would.
"""

from .run import MODES, Result, load_config, run
from .simulation import Observer

__all__ = ["MODES", "Observer", "Result", "load_config", "run"]
