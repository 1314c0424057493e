"""The diagram of the decision's stages, made from the table of stages in planner/decision.py."""

import ast
import re

from host.twin import image

SOURCE = image.FIRMWARE / "lib" / "planner" / "decision.py"
_TABLE = "STAGES"
_ARROW = re.compile(r"^\s*(\S+) --> ([^\s:]+)(?:: (.*))?$")
_BLOCK = re.compile(r"```mermaid\nstateDiagram-v2\n.*?```", re.DOTALL)


def stages(source=None):
    """{stage: (stages that may come next, in order)} of the code, in the order of the table; names without a leading underscore."""
    tree = ast.parse(SOURCE.read_text() if source is None else source)
    numbers = {}
    for name, value in _assignments(tree):
        if isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == "const":
            numbers[name] = ast.literal_eval(value.args[0])
    for kind in (node for node in tree.body if isinstance(node, ast.ClassDef)):
        for name, value in _assignments(kind):
            if name == _TABLE and isinstance(value, ast.Tuple):
                table = [one.id for one in value.elts if isinstance(one, ast.Name)]
                methods = {one.name: one for one in kind.body if isinstance(one, ast.FunctionDef)}
                return {_plain(name): tuple(_plain(table[numbers[one]]) for one in _given_back(methods[name])) for name in table}
    raise ValueError(f"there is no table {_TABLE} in {SOURCE.name}")


def _assignments(node):
    """(name, value) of each simple assignment in a module or class."""
    for one in node.body:
        if isinstance(one, ast.Assign) and isinstance(one.targets[0], ast.Name):
            yield one.targets[0].id, one.value


def _plain(name):
    return name.lstrip("_")


def _given_back(method):
    """Names that a stage may return, each once."""
    out: list[str] = []
    returns = (node for node in ast.walk(method) if isinstance(node, ast.Return))
    for node in sorted(returns, key=lambda node: node.lineno):
        out.extend(name for name in _names(node.value) if name not in out)
    return out


def _names(value):
    if isinstance(value, ast.IfExp):
        return _names(value.body) + _names(value.orelse)
    if not isinstance(value, ast.Name):
        raise ValueError("a stage gives back something other than the name of a stage")
    return [value.id]


def arrows(page):
    """{(from, to): words} of the page's diagram."""
    block = _BLOCK.search(page)
    if not block:
        raise ValueError("the page has no diagram of the stages")
    found = (_ARROW.match(line) for line in block.group().splitlines())
    return {(one[1], one[2]): one[3] or "" for one in found if one}


def diagram(words):
    """The diagram as Mermaid; that a stage comes again, for its next slice, is not drawn. words: {(from, to): what is written on the arrow}."""
    table = stages()
    pairs = [("[*]", next(iter(table))), *((name, to) for name, following in table.items() for to in following if to != name)]
    lines = (f"    {a} --> {b}: {words[a, b]}" if words.get((a, b)) else f"    {a} --> {b}" for a, b in pairs)
    return "\n".join(("```mermaid", "stateDiagram-v2", *lines, "```"))


def renew(page):
    """The page with the diagram as the code is now; the words on its arrows stay."""
    return _BLOCK.sub(lambda _: diagram(arrows(page)), page, count=1)
