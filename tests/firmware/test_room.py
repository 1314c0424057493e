"""room.py: the heap's reserve."""

import gc
import sys

from core.heap_reserve import BOARD_SIZE, Room

WORD = 8 if sys.maxsize >> 31 else 4


def _kept(room):
    return sum([len(block) for block in room._kept]) * WORD


def test_the_reserve_is_heap_while_it_is_lent():
    room = Room()
    room.take()
    whole = BOARD_SIZE * WORD // 4
    assert _kept(room) == whole
    looked_up = list(room._kept)  # whoever still has the blocks must not keep their memory from being used
    gc.collect()
    before = gc.mem_alloc() if sys.implementation.name == "micropython" else 0
    with room.lend():
        assert _kept(room) == 0
        if before:
            assert before - gc.mem_alloc() > whole * 3 // 4, (before, gc.mem_alloc())
    assert _kept(room) == whole and len(looked_up[0]) == 0


def test_modules_are_let_go_whatever_happens():
    room = Room()
    room.take()
    try:
        with room.lend("params.json_patch"):
            from params import json_patch

            del json_patch
            raise ValueError
    except ValueError:
        pass
    assert _kept(room)
    if sys.implementation.name == "micropython":
        assert "params.json_patch" not in sys.modules


class _Narrow:
    """Takes back one block, then there is no memory left."""

    def __init__(self, blocks):
        self.blocks = blocks

    def __iter__(self):
        return iter(self.blocks)

    def __setitem__(self, index, block):
        if index:
            raise MemoryError("memory allocation failed")
        self.blocks[index] = block


def test_without_memory_the_reserve_is_smaller_for_now():
    room = Room()
    room.take()
    whole = _kept(room)
    plenty = room._kept
    room._kept = _Narrow(plenty)
    with room.lend():
        pass
    assert 0 < _kept(room) < whole
    room._kept = plenty
    with room.lend():
        pass
    assert _kept(room) == whole
