"""What carries the telemetry frames: here the USB serial line, in radio.py UDP. Neither ever makes the loop wait.

A carrier has
    decoder                 the frames it receives
    signed                  True when commands must carry a tag
    update(now_us)          give out what can be without waiting
    take(now_us)            True when a frame has come and is in the decoder; call it until it is False
    idle()                  True when the frame of the latest `send` has gone out: only then may the encoder be used again
    send(encoder)           send the encoder's frame, if anybody listens; False when it had to be dropped
    heard(now_us)           what was received last was a valid command
"""

import select
import sys
from time import ticks_add, ticks_diff, ticks_us

import micropython
from micropython import const

from link.telemetry import Decoder

_COMMAND = const(200)  # longest payload of a command
_BLOCK = const(8)  # bytes taken in at a time: each costs some 75 us
_CTRL_C = const(3)
_STALE_US = const(200_000)  # a frame from USB that is not whole by then never will be
_FIFO = const(120)  # bytes, of the chip's 128
_BYTE_US = const(87)  # ten bits at 115200


class SerialLine:
    """The USB serial line of the board: standard input and output.

    source, sink: objects with `buffer`, as sys.stdin and sys.stdout, the default; clock: gives the time in us.
    A frame goes out in portions that the line's FIFO has room for at the moment of writing, because a write to a full FIFO sleeps to the next
    tick of 10 ms.

    Ctrl-C is a byte like any other inside a frame, so it is taken out of the interpreter's hands; outside frames it still raises
    KeyboardInterrupt, from `take`.
    """

    signed = False

    def __init__(self, source=None, sink=None, clock=ticks_us):
        source = source or sys.stdin
        # CPython's buffered reader would take bytes that select then no longer sees.
        self.source = getattr(source.buffer, "raw", source.buffer)
        self._sink = (sink or sys.stdout).buffer
        self._clock = clock
        poller = select.poll()
        poller.register(source, select.POLLIN)
        self.ready = getattr(poller, "ipoll", poller.poll)  # poll makes a list at each call
        self._one = bytearray(1)
        self.decoder = Decoder(_COMMAND)
        self._begun_us = 0  # when the frame that is coming in began
        self._data = None  # of the frame that goes out
        self._at = self._end = 0  # what of it has yet to go
        self._empty_us = clock()  # when the FIFO will be empty
        micropython.kbd_intr(-1)

    def close(self):
        """Give Ctrl-C back to the interpreter."""
        micropython.kbd_intr(_CTRL_C)

    def idle(self):
        return self._at == self._end

    def send(self, encoder):
        self._data = encoder.data
        self._at = 0
        self._end = encoder.size
        self.go_on()
        return True

    def heard(self, now_us):
        """Nothing to do: the cable has one end."""

    def update(self, now_us):
        if self._at < self._end:
            self.go_on()

    def take(self, now_us):
        """Read until a frame is whole, or all that came, or a portion of it, has been read. KeyboardInterrupt after a Ctrl-C."""
        decoder = self.decoder
        if decoder.take():
            return True
        if not decoder.waiting():
            self._begun_us = now_us
        elif ticks_diff(now_us, self._begun_us) > _STALE_US:
            decoder.clear()
        one = self._one
        count = _BLOCK
        while count and self.source is not None:
            count -= 1
            ready = False
            for _ in self.ready(0):
                ready = True
            if not ready:
                return False
            # One byte at a time: on the board a longer read would wait until all of it has come.
            if not self.source.readinto(one):
                self.source = None  # the other end is closed for good
                return False
            if one[0] == _CTRL_C and not decoder.waiting():
                raise KeyboardInterrupt
            if decoder.add(one[0]):
                return True
        return False

    def go_on(self):
        """Write as much as the FIFO has room for by now; returns the count of bytes."""
        now = self._clock()
        full_us = max(ticks_diff(self._empty_us, now), 0)
        count = min(_FIFO - (full_us + _BYTE_US - 1) // _BYTE_US, self._end - self._at)
        if count > 0:
            self._sink.write(self._data, self._at, count)
            self._at += count
            self._empty_us = ticks_add(now, full_us + count * _BYTE_US)
        return max(count, 0)
