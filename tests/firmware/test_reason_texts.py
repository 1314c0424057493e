"""reason_texts.py: a text for each number."""

import json

from link.reason_texts import FAULTS, REASONS, names
from planner import reasons


def _numbers(module):
    return sorted([value for name, value in module.__dict__.items() if type(value) is int and name[0] != "_"])


def test_each_reason_has_its_text():
    assert _numbers(reasons) == [number for number, text in enumerate(REASONS) if text]


def test_all_of_them_fit_the_one_frame_they_are_told_in():
    data = bytearray(1408)
    length = names(data)
    told = json.loads(bytes(data[8 : 8 + length]).decode())
    assert length <= 1390 and told == {"reasons": list(REASONS), "faults": list(FAULTS)}
