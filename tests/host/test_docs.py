"""The pages lead where they say: every link and every file named exists, and the map of the code names what is there."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
SOURCES = sorted(path for folder in ("firmware", "host", "tests") for path in (ROOT / folder).rglob("*.py"))
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)|src=\"([^\"]+)\"")
NAMED = re.compile(r"\b((?:firmware|host|tests|docs)/[\w./-]+\.(?:py|md|json|js|png|svg))\b")
MADE = ("docs/results/",)  # by a command that writes several files


def _name(path):
    return path.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("page", PAGES, ids=_name)
def test_links_lead_somewhere(page):
    text = page.read_text()
    for found in LINK.finditer(text):
        target = (found[1] or found[2]).split("#")[0]
        if target and "://" not in target:
            assert (page.parent / target).exists(), f"{_name(page)} links to {target}, which is not there"


@pytest.mark.parametrize("page", PAGES + SOURCES, ids=_name)
def test_files_named_in_prose_exist(page):
    for name in NAMED.findall(page.read_text()):
        assert name.startswith(MADE) or (ROOT / name).exists(), f"{_name(page)} names {name}, which is not there"


WANTED = (
    "bytes to points", "memory of points", "what is a window", "the candidates", "the swept test", "the cost to go", "choosing", "stopping",
    "wheel angles", "registers", "a message", "a parameter", "a fault",
)  # fmt: skip
ROW = re.compile(r"^\| ([^|]+?) \| \[`([\w.]+)`\]\(([^)]+)\) \|", re.MULTILINE)


def test_a_newcomer_finds_each_thing_at_the_first_look():
    page = ROOT / "docs" / "architecture.md"
    rows = {thing: (symbol, page.parent / target) for thing, symbol, target in ROW.findall(page.read_text())}
    for thing in WANTED:
        assert thing in rows, f"docs/architecture.md does not say where to find: {thing}"
        symbol, path = rows[thing]
        assert _defines(path, symbol), f"docs/architecture.md: {_name(path.resolve())} has no {symbol}"


def _defines(path, symbol):
    body = ast.parse(path.read_text()).body
    for part in symbol.split("."):
        for node in body:
            names = [node.name] if hasattr(node, "name") else [target.id for target in getattr(node, "targets", ()) if isinstance(target, ast.Name)]
            if part in names:
                body = getattr(node, "body", [])
                break
        else:
            return False
    return True


@pytest.mark.parametrize("page", PAGES, ids=_name)
def test_what_is_to_be_typed_works_where_no_python_is_called_python(page):
    """Debian and Ubuntu have python3 only; the project's own is in .venv."""
    assert [line for line in page.read_text().splitlines() if line.startswith("    python ")] == []
