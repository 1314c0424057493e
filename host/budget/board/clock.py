"""The board's clock while its memory is measured: it stands but for sleeps, and for a little at each look at it."""

import sys

now = 0
on_turn = None  # called at each sleep of the loop


class _Time:
    """Stands for the module time: on this machine that is built in, and a file of its name is not looked for."""

    @staticmethod
    def ticks_us():
        global now
        now = (now + 3) & 0x3FFFFFFF
        return now

    @staticmethod
    def ticks_ms():
        return now // 1000

    ticks_cpu = ticks_us

    @staticmethod
    def ticks_add(a, b):
        return (a + b) & 0x3FFFFFFF

    @staticmethod
    def ticks_diff(a, b):
        return ((a - b + 0x20000000) & 0x3FFFFFFF) - 0x20000000

    @staticmethod
    def sleep_us(duration):
        global now
        now = (now + duration) & 0x3FFFFFFF

    @staticmethod
    def sleep_ms(duration):
        global now
        now = (now + 1000 * duration) & 0x3FFFFFFF
        if on_turn:
            on_turn()

    @staticmethod
    def sleep(duration):
        _Time.sleep_ms(int(duration * 1000))


sys.modules["time"] = _Time
