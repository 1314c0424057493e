"""Tells a firmware that computes for ever from one that a busy machine keeps waiting: by its own processor time, not by the wall clock."""

import os
import time

LIMIT_S = 20.0
WATCHED_S = 2.0  # where a watchdog is on guard; what takes so long here would take minutes on the chip


class Silence:
    """The time since the firmware's process was last heard of.

    pid: of the process. watched: whether the board's watchdog would reset it. look_ms: how long to wait for it before asking for `trouble` again.
    computing: after `trouble`, whether it computes (else it waits).
    """

    def __init__(self, pid, watched=False):
        self._pid = pid
        self._limit = WATCHED_S if watched else LIMIT_S
        self.computing = False
        self._began = None  # looking costs a file; most requests come at once
        self.look_ms = min(LIMIT_S / 4, 1.0) * 1000

    def trouble(self):
        """Why nothing more will come, or an empty text as long as something may."""
        state, used = _process(self._pid)
        if self._began is None or state != "S":
            self._waiting_since = time.monotonic()
        if self._began is None:
            self._began = used
        if used - self._began > self._limit:
            self.computing = True
            return f"the firmware computed for {LIMIT_S:g} s without letting time pass: an endless loop?"
        if time.monotonic() - self._waiting_since > LIMIT_S:
            return f"the firmware has waited for {LIMIT_S:g} s, without letting time pass, for something that nobody sends"
        return ""


def _process(pid):
    """(state as in proc(5), processor seconds used) of a process. Where there is no /proc, as if it had had a processor to itself."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            words = file.read().rpartition(")")[2].split()
    except OSError:
        return "R", time.monotonic()
    return words[0], (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")
