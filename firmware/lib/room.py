"""A piece of the heap kept in one piece, for what a person asks for now and then: the code for it is loaded then, and let go again."""

import gc
import sys

from micropython import const

from once import forget

BOARD_SIZE = const(2048)
SIZE = 2 * BOARD_SIZE if sys.maxsize >> 31 else BOARD_SIZE  # with words of 64 bits code takes twice as much
LEAST = const(1536)
_STEP = const(256)


class Room:
    """buffer: bytearray of LEAST to SIZE bytes, for whoever can do without what is in it: another one, or None, after each loan, so look it
    up at each use. loans: how many there have been.

        with room.lend("module"):
            from module import ...      # in a heap that has SIZE bytes more; at the end the modules are let go
    """

    def __init__(self):
        self.buffer = bytearray(SIZE)
        self.loans = 0
        self._modules = ()

    def lend(self, *modules):
        """The context in which the buffer is heap, and the modules may be loaded."""
        self._modules = modules
        return self

    def __enter__(self):
        self.buffer = None
        self.loans += 1
        gc.collect()

    def __exit__(self, *error):
        forget(*self._modules)
        gc.collect()
        # Something small may have settled there for a while.
        size = SIZE
        while self.buffer is None and size >= LEAST:
            try:
                self.buffer = bytearray(size)
            except MemoryError:
                size -= _STEP
