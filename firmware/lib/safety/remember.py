"""With drive.autostart: that the robot stands by somebody's wish outlives its power. Loaded only then.

A file is there while it does. It is written and removed while the motors are off, once for each stop and each start, so the flash does not wear.
"""

import os

from micropython import const

_STOPPED = const(0)  # of safety.py
_FILE = const("stopped")


def stopped():
    """Whether it was told to stand when the power went."""
    try:
        os.stat(_FILE)
    except OSError:
        return False
    return True


class Remember:
    """remember(state) while the motors are off: state of Safety."""

    def __init__(self):
        self._stands = stopped()

    def __call__(self, state):
        stands = state == _STOPPED
        if stands != self._stands:
            self._stands = stands
            try:
                if stands:
                    open(_FILE, "w").close()
                else:
                    os.remove(_FILE)
            except OSError:  # a full flash keeps nobody from standing
                pass
