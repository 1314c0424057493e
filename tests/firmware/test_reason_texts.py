"""reason_texts.py: a text for each number."""

from link.reason_texts import FAULTS, REASONS
from planner import reasons
from safety import health


def _numbers(module):
    return sorted([value for name, value in module.__dict__.items() if type(value) is int and name[0] != "_"])


def test_each_reason_and_each_fault_has_its_text():
    assert _numbers(reasons) == [number for number, text in enumerate(REASONS) if text]
    assert _numbers(health) == list(range(len(FAULTS)))
