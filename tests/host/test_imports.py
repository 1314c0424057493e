"""Who imports whom: no circles, on the board or on the laptop, and nothing in host/ that others are built on imports one of them."""

import ast
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TREES = {"firmware": ROOT / "firmware" / "lib", "host": ROOT}
# Each may import those to the left of it. What is not listed, the tools, may import any of these, and each other without circles.
ORDER = ("version", "compat", "floorplan", "micropython", "boards", "recording", "twin", "link")


@cache
def _imports(tree):
    """{module: modules of the same tree that it imports, inside functions as well}."""
    root = TREES[tree]
    folder = root if tree == "firmware" else root / "host"
    files = {".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): path for path in sorted(folder.rglob("*.py"))}
    found = {}
    for module, path in files.items():
        package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
        found[module] = set()
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                start = package[: len(package) - node.level + 1] if node.level else []
                source = ".".join([*start, *([node.module] if node.module else [])])
                names = [name if (name := f"{source}.{alias.name}") in files else source for alias in node.names]
            else:
                continue
            found[module].update(name for name in names if name in files and name != module)
    return found


def _circle(graph):
    """One circle of a graph {node: nodes}, as a list whose ends are the same; [] if there is none."""
    done = set()

    def visit(node, path):
        if node in path:
            return [*path[path.index(node) :], node]
        if node in done:
            return []
        done.add(node)
        for following in sorted(graph.get(node, ())):
            if circle := visit(following, [*path, node]):
                return circle
        return []

    return next((circle for node in sorted(graph) if (circle := visit(node, []))), [])


@pytest.mark.parametrize("tree", TREES)
def test_no_circles(tree):
    assert not _circle(_imports(tree))


def test_the_search_finds_a_circle():
    assert _circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c", "b"]
    assert not _circle({"a": {"b", "c"}, "b": {"c"}})


def _packages():
    """The same among the folders of host/."""
    found = {}
    for module, names in _imports("host").items():
        if module != "host":
            mine = module.split(".")[1]
            found.setdefault(mine, set()).update(other for name in names if name != "host" and (other := name.split(".")[1]) != mine)
    return found


def test_no_circles_of_folders():
    assert not _circle(_packages())


def test_nothing_imports_upwards():
    packages = _packages()
    for place, package in enumerate(ORDER):
        assert packages[package] <= set(ORDER[:place]), f"host/{package} may import {ORDER[:place]} only"
