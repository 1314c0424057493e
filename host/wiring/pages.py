"""The parts of docs/wiring.md that are made: its tables, between marks."""

import re

from . import power, table, wiring

_MADE = re.compile(r"(<!-- made: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def renew(page):
    """The text of the page with its made parts from the default robot.json."""
    wired = wiring()
    made = {"pins": table(wired), "power": power.text(wired)}
    return _MADE.sub(lambda found: f"{found[1]}{made[found[2]]}{found[3]}", page)
