"""The examples of robot.json drive, each through the passage that examples/README.md names."""

import json
import re
from pathlib import Path

import pytest

from host.twin import run

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
ROW = re.compile(r"^\| \[([\w-]+\.json)\]\(\1\) \| [^|]+ \| (\d+) x (\d+) \| (\d+) \|$", re.MULTILINE)
ROWS = {name: tuple(map(int, figures)) for name, *figures in ROW.findall((EXAMPLES / "README.md").read_text())}


def test_every_example_has_its_row():
    assert set(ROWS) == {path.name for path in EXAMPLES.glob("*.json")}
    axles = [len(json.loads((EXAMPLES / name).read_text())["axles"]["spacings"]) + 1 for name in ROWS]
    assert sorted(axles) == [2, 3, 4, 4, 6, 8]


@pytest.mark.parametrize("name", ROWS)
def test_an_example_drives_its_passage(name):
    length, width, passage = ROWS[name]
    result = run("Z", width=passage, config=EXAMPLES / name, scale=0.7, seed=1, record=False)
    assert (result.vehicle.length, result.vehicle.width) == (length, width)
    assert (result.result, result.contacts) == ("pass", 0), result.reason
