"""room.py: the heap's reserve."""

import sys

from room import LEAST, SIZE, Room


def test_the_buffer_is_another_one_after_each_loan():
    room = Room()
    room.buffer[SIZE - 1] = 7
    with room.lend():
        assert room.buffer is None
    assert room.loans == 1 and room.buffer[SIZE - 1] == 0


def test_modules_are_let_go_whatever_happens():
    room = Room()
    try:
        with room.lend("keep"):
            import keep

            del keep
            raise ValueError
    except ValueError:
        pass
    assert room.buffer is not None
    if sys.implementation.name == "micropython":
        assert "keep" not in sys.modules


def test_without_memory_there_is_none_for_now():
    import room as module

    room = Room()
    module.bytearray = lambda size: _fail() if size > LEAST else bytearray(size)
    with room.lend():
        pass
    assert len(room.buffer) == LEAST
    module.bytearray = lambda size: _fail()
    try:
        with room.lend():
            pass
    finally:
        del module.bytearray
    assert room.buffer is None
    with room.lend():
        pass
    assert len(room.buffer) == SIZE


def _fail():
    raise MemoryError("memory allocation failed")
