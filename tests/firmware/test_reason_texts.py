"""reason_texts.py: a text for each number."""

from link.reason_texts import REASONS
from planner import reasons


def _numbers(module):
    return sorted([value for name, value in module.__dict__.items() if type(value) is int and name[0] != "_"])


def test_each_reason_has_its_text():
    assert _numbers(reasons) == [number for number, text in enumerate(REASONS) if text]
