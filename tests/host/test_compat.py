"""host.compat: viper's pointers under CPython."""

from array import array

import pytest

from host.compat.pointers import ptr16, ptr32


def test_pointers_have_no_sign():
    assert ptr16(array("h", [-2]))[0] == 65534
    words = ptr32(array("i", [7, 0]))
    assert words[0] == 7
    with pytest.raises(ValueError):
        words[1] = -1
    with pytest.raises(IndexError):
        words[2]


def test_a_negative_word_handed_over_is_named():
    with pytest.raises(ValueError, match="word 1 handed to viper is -3: add a bias"):
        ptr32(array("i", [5, -3, -1]))
    assert len(ptr32(array("i", [-1] * 65))) == 65  # a table, not looked through
