"""docs/planner.md: its drawings are made by the command it names, and its stage diagram is the code's."""

import math
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from host import drawings
from host.drawings import stages

LARGEST = 150_000  # bytes of one drawing
SHOWN = re.compile(r"!\[([^\]]+)\]\(([^)\s]+)\)")

DECISION = """
from micropython import const
FIRST = const(0)
_SECOND = const(1)

class Decision:
    def _one(self, odometry):
        if odometry:
            return FIRST
        return _SECOND if self.done else FIRST

    def _two(self, odometry):
        return FIRST

    STAGES = (_one, _two)
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    pytest.importorskip("matplotlib")
    return drawings.draw(tmp_path_factory.mktemp("drawings"))


def test_the_page_shows_every_drawing_and_says_what_is_on_it():
    shown = {target: words for words, target in SHOWN.findall(drawings.PAGE.read_text())}
    assert set(shown) == {f"planner/{name}.svg" for name in drawings.NAMES}
    assert all(len(words) > 40 for words in shown.values())


def test_the_command_makes_every_drawing(made):
    assert [path.stem for path in made] == list(drawings.NAMES)
    for path in made:
        root = ElementTree.parse(path).getroot()
        assert root.tag.endswith("svg") and len(list(root.iter())) > 100, f"{path.name} is empty"
        assert path.stat().st_size < LARGEST, f"{path.name} has {path.stat().st_size} bytes"


def test_each_drawing_of_the_page_is_there_and_small():
    there = {path.name: path.stat().st_size for path in Path(drawings.FOLDER).iterdir()}
    assert set(there) == {f"{name}.svg" for name in drawings.NAMES}
    assert max(there.values()) < LARGEST


def test_drawn_twice_it_is_the_same(made, tmp_path):
    from host.drawings import conventions, robot

    for name in ("steering", "windows"):
        getattr(conventions, name)(robot.robot(), tmp_path / f"{name}.svg")
        assert (tmp_path / f"{name}.svg").read_bytes() == next(path for path in made if path.stem == name).read_bytes()


def test_what_is_drawn_is_what_the_firmware_found(made):
    """How far the laptop finds the steering free that was taken is how far the firmware found it, on its board."""
    from host.drawings import moments, robot

    one = robot.robot()
    taken = [(moment, *moment.taken) for run in moments.runs() for moment in run if isinstance(moment, moments.Moment)]
    assert taken
    for moment, mirroring, candidate, free in taken:
        assert one.free(moment, mirroring, candidate)[0] == free


def test_links_into_the_page_meet_a_heading():
    headings = {re.sub(r"[^\w -]", "", line.lstrip("# ")).lower().replace(" ", "-") for line in drawings.PAGE.read_text().splitlines() if line.startswith("#")}
    root = drawings.PAGE.parents[1]
    wanted = {
        anchor for page in (*root.glob("*.md"), *root.glob("docs/*.md")) for anchor in re.findall(r"\]\((?:docs/)?planner\.md#([^)]*)\)", page.read_text())
    }
    wanted.update(re.findall(r"\]\(#([^)]*)\)", drawings.PAGE.read_text()))
    assert wanted and wanted <= headings


@pytest.mark.parametrize("page", ("architecture", "monitor", "twin", "results"))
def test_a_page_that_speaks_of_af_and_ar_links_to_what_they_are(page):
    text = (drawings.PAGE.parent / f"{page}.md").read_text()
    assert "AF" in text and "](planner.md#the-words)" in text


def test_a_cost_is_never_less_than_its_lower_bound_and_the_best_was_checked(made):
    """What the page says of candidates that are checked best first, looked at in real decisions."""
    from host.drawings import moments

    decisions = [one for run in moments.runs() for one in run if isinstance(one, moments.BestFirst)]
    assert len(decisions) > 10
    for one in decisions:
        assert (one.costs >= one.bounds).all()
        assert one.checked[one.costs.argmin()]
        assert one.costs[one.checked].min() <= one.bounds[~one.checked].min(initial=math.inf)


def test_stages_are_read_from_the_table():
    assert stages.stages(DECISION) == {"one": ("one", "two"), "two": ("one",)}


def test_a_stage_that_gives_back_something_else_is_refused():
    with pytest.raises(ValueError, match="name of a stage"):
        stages.stages(DECISION.replace("return FIRST\n\n    STAGES", "return 0\n\n    STAGES"))


def test_the_diagram_of_the_page_is_that_of_the_code():
    page = drawings.PAGE.read_text()
    assert stages.renew(page) == page, "say make drawings"


def test_every_arrow_between_two_stages_says_when():
    words = stages.arrows(drawings.PAGE.read_text())
    assert all(words[arrow] for arrow in words if arrow[0] != "[*]")


def test_every_stage_is_spoken_of():
    text = drawings.PAGE.read_text().split("```")[-1]
    for name in stages.stages():
        assert name in text, f"docs/planner.md says nothing of the stage {name}"
