"""Ctrl-C on the cable, as every deploy sends it: the robot must not drive on while nobody steers."""

import pytest

from host.twin import Observer, run


class Interrupter(Observer):
    """Presses Ctrl-C once the robot drives."""

    def __init__(self):
        self.simulation = None
        self.drove = False
        self.resets = 0

    def reset(self, time, cause):
        self.resets += 1

    def step(self, simulation):
        self.simulation = simulation
        self.drove |= abs(simulation.body.twist[1]) > 50

    def commands(self):
        return b"\x03" if self.drove and not self.resets else b""


@pytest.mark.parametrize("engine", ["micropython", "cpython"])
def test_ctrl_c_leaves_everything_off(engine):
    watch = Interrupter()
    result = run("Z", 600, engine=engine, watch=watch, limit_s=5, record=False)
    # By way of a reset, or the watchdog would bite at the prompt.
    assert watch.drove and watch.resets == 1 and "came to its end" in result.reason
    electronics = watch.simulation.electronics
    assert not electronics.enabled
    assert all(chip.duty(channel) == 0 for chip in electronics.chips.values() for channel in range(16))
