"""A reserve in the heap for what a person asks for now and then: the code for it is loaded then, and let go again."""

import gc

from micropython import const

from core.unload import unload

_BLOCKS = const(4)
_WORDS = const(112)
_LEAST = const(16)
BOARD_SIZE = const(1792)  # bytes: 4 * 112 words of 32 bits; with words of 64 bits it is twice as much, as is the code


class Room:
    """The reserve; empty until take().

        with room.lend("module"):
            from module import ...      # in a heap that has the reserve more; at the end the modules are let go

    Blocks, because a heap that is nearly full has no large piece left to take back. Lists, because one that is cleared gives its words back at
    once: a buffer that is only dropped lives on as long as anything on the stack looks like its address.
    """

    def __init__(self):
        self._kept = [[] for _ in range(_BLOCKS)]
        self._modules = ()

    def lend(self, *modules):
        """The context in which the reserve is heap, and the modules may be loaded."""
        self._modules = modules
        return self

    def __enter__(self):
        for block in self._kept:
            block.clear()
        gc.collect()

    def __exit__(self, *error):
        unload(*self._modules)
        self.take()

    def take(self):
        """Take the reserve, or what can be had of it, out of the heap."""
        gc.collect()
        for i in range(_BLOCKS):
            # Something small may have settled there: half a block is better than none.
            words = _WORDS
            while words >= _LEAST:
                try:
                    self._kept[i] = [None] * words
                    break
                except MemoryError:
                    words //= 2
