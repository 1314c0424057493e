"""What carries the telemetry frames: here the USB serial line, in radio.py UDP. Neither ever makes the loop wait.

A carrier has
    decoder                         the frames it receives
    signed                          True when commands must carry a tag
    busy                            True when someone listens (always, on the cable)
    update(now_us)                  give out what can be without waiting
    take(now_us)                    True when a frame has come and is in the decoder; call it until it is False
    send(encoder, size, now_us)     True when the frame was taken or nobody listens; False when it had to be dropped
    room()                          bytes that `send` takes now
    heard(now_us)                   what was received last was a valid command
"""

import select
import sys
from time import ticks_diff

import micropython
from micropython import const

from link.telemetry import Decoder, copy

_COMMAND = const(200)  # longest payload of a command

_CTRL_C = const(3)
_STALE_US = const(200_000)  # a frame from USB that is not whole by then never will be
_RING = const(2048)
_BLOCK = const(64)
_UNIT = const(8)
_FIFO = const(120)


class SerialLine:
    """The USB serial line of the board: standard input and output.

    source, sink: objects with `buffer`, as sys.stdin and sys.stdout, the default.
    rate: bytes a second the line takes. Output goes out in portions the line's FIFO has room for by now, because a write to a full FIFO
    waits.

    Ctrl-C is a byte like any other inside a frame, so it is taken out of the interpreter's hands; outside frames it still raises
    KeyboardInterrupt, from `take`.
    """

    signed = False
    busy = True

    def __init__(self, source=None, sink=None, rate=11520):
        source = source or sys.stdin
        # CPython's buffered reader would take bytes that select then no longer sees.
        self._source = getattr(source.buffer, "raw", source.buffer)
        self._sink = (sink or sys.stdout).buffer
        self._flush = getattr(self._sink, "flush", None)
        self._rate = rate
        poller = select.poll()
        poller.register(source, select.POLLIN)
        self._ready = getattr(poller, "ipoll", poller.poll)  # poll makes a list at each call
        self._open = True
        self._one = bytearray(1)
        self.decoder = Decoder(_COMMAND, ahead=0)
        self._begun_us = 0

        self._ring = bytearray(_RING)
        self._block = bytearray(_BLOCK)
        # Views of all lengths up to one unit, then of whole units: a slice made when it is needed would allocate.
        self._short = [memoryview(self._block)[:count] for count in range(_UNIT)]
        self._long = [memoryview(self._block)[:count] for count in range(0, _BLOCK + 1, _UNIT)]
        self._head = 0
        self._used = 0
        self._credit = _FIFO
        self._last_us = 0
        micropython.kbd_intr(-1)

    def close(self):
        """Give Ctrl-C back to the interpreter."""
        micropython.kbd_intr(_CTRL_C)

    def send(self, encoder, size, now_us):
        """Queue a frame; False when there is no room for all of it."""
        if size > _RING - self._used:
            return False
        at = (self._head + self._used) % _RING
        first = min(size, _RING - at)
        copy(encoder.data, 0, first, self._ring, at)
        copy(encoder.data, first, size - first, self._ring, 0)
        self._used += size
        return True

    def room(self):
        """Bytes free in the queue."""
        return _RING - self._used

    def heard(self, now_us):
        """Nothing to do: the cable has one end."""

    def update(self, now_us):
        """Write what the line has room for."""
        if self._used:
            self._write(now_us)

    def take(self, now_us):
        """Read until a frame is whole, or all that came, or a portion of it, has been read. KeyboardInterrupt after a Ctrl-C."""
        decoder = self.decoder
        if not decoder.waiting():
            self._begun_us = now_us
        elif ticks_diff(now_us, self._begun_us) > _STALE_US:
            decoder.clear()
        count = _BLOCK if self._open else 0
        while count:
            count -= 1
            ready = False
            for _ in self._ready(0):
                ready = True
            if not ready:
                return False
            # One byte at a time: on the board a longer read would wait until all of it has come.
            if not self._source.readinto(self._one):
                self._open = False  # the other end is closed for good
                return False
            if self._one[0] == _CTRL_C and not decoder.waiting():
                raise KeyboardInterrupt
            decoder.room()
            decoder.feed(self._one, 0, 1)
            if decoder.take():
                return True
        return False

    def _write(self, now_us):
        elapsed = min(max(ticks_diff(now_us, self._last_us), 0), 50_000)
        gained = elapsed * (self._rate // 10) // 100_000
        if gained:
            self._last_us = now_us
            self._credit = min(self._credit + gained, _FIFO)
        while self._used and self._credit:
            count = min(self._used, self._credit, _BLOCK, _RING - self._head)
            if count >= _UNIT:
                count -= count % _UNIT
                view = self._long[count // _UNIT]
            else:
                view = self._short[count]
            copy(self._ring, self._head, count, self._block, 0)
            self._sink.write(view)
            self._head = (self._head + count) % _RING
            self._used -= count
            self._credit -= count
        if self._flush is not None:
            self._flush()
