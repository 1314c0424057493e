"""Rules that all sources keep: functions of one screen, and nobody reaches into another's private state."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = sorted(path for folder in ("firmware", "host", "tests") for path in (ROOT / folder).rglob("*.py"))
LINES = 80
KERNEL_LINES = 120  # of a viper function, unless its docstring says why it is one function
NAMED_TUPLES = {"_asdict", "_make", "_replace", "_fields"}


def _name(path):
    return path.relative_to(ROOT).as_posix()


def too_long(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            kernel = any("viper" in ast.unparse(decorator) for decorator in node.decorator_list)
            lines = node.end_lineno - node.lineno + 1
            if lines > (KERNEL_LINES if kernel else LINES) and not (kernel and "All in one function" in (ast.get_docstring(node) or "")):
                yield f"{node.name}: {lines} lines"


def reached_into(tree):
    """Attributes with a leading underscore of anything but self, cls, super() and the file's own classes."""
    own = {node.name for node in ast.walk(tree) if isinstance(node, ast.ClassDef)} | {"self", "cls", "super()"}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and node.attr.startswith("_") and not node.attr.startswith("__") and node.attr not in NAMED_TUPLES:
            if ast.unparse(node.value) not in own:
                yield f"line {node.lineno}: {ast.unparse(node)}"


@pytest.mark.parametrize("path", FILES, ids=_name)
def test_rules(path):
    tree = ast.parse(path.read_text())
    assert not [*too_long(tree), *reached_into(tree)]


def test_the_rules_see_what_they_are_for():
    body = "\n    pass" * 125
    assert list(too_long(ast.parse(f"def long():{body}"))) == ["long: 126 lines"]
    assert list(too_long(ast.parse(f"@micropython.viper\ndef kernel():{body}"))) == ["kernel: 126 lines"]
    assert not list(too_long(ast.parse(f"@micropython.viper\ndef kernel():\n    '''All in one function: a call costs.'''{body}")))
    assert list(reached_into(ast.parse("self._mine = other._state"))) == ["line 1: other._state"]
