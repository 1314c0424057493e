"""planner/reasons.py: the firmware's modules have the numbers of the reasons as consts of their own."""

import re

from host.twin.image import FIRMWARE
from planner import reasons


def test_reasons_have_the_same_number_everywhere():
    found = set()
    for path in sorted((FIRMWARE / "lib").rglob("*.py")):
        for number, name in re.findall(r"= const\((\d+)\)  # reasons\.(\w+)$", path.read_text(), re.MULTILINE):
            assert getattr(reasons, name) == int(number), (path.name, name)
            found.add(name)
    assert found == {name for name in vars(reasons) if name.isupper()}, "a reason that nobody gives"
