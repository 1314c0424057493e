"""The firmware's sources cut into basic blocks: each gets a counter, so that a run tells how often every line was executed.

A block begins where a function begins, where a condition leads and where its ways meet again. In one copy of the sources (`counted`) a
statement that counts stands at the beginning of each block; in another (`marked`), made for the ESP32's compiler only, a statement that
can be found again in the machine code, so that the instructions between two of them can be counted.
"""

import ast
from dataclasses import dataclass

from . import costs

MARK = 0x2A5A5A5A  # a constant that no firmware uses
_NEXT = ast.parse("i; i; i + 1; i < n")  # eight operations take a loop over a range to its next turn
COUNTERS = "counters"  # module with the array of counters, beside the firmware


@dataclass
class Block:
    """number: of its counter. function, line: where it begins. loop: it is the body of a loop. inside: number of the
    block that begins the innermost loop round it, its own outside of loops. viper: machine code, else bytecode.

    instructions: of one execution. The parts of a block's machine code may be several: a loop's condition stands behind its body.
    """

    number: int
    module: str
    function: str
    line: int
    loop: bool = False
    inside: int = 0
    viper: bool = False
    instructions: int = 0


def is_viper(node):
    """True for a function that is compiled to machine code by the viper emitter."""
    return any(ast.unparse(decorator).endswith("viper") for decorator in node.decorator_list)


class Cutter:
    """Cuts modules into blocks.

    sources: {module name: source text}. After construction `blocks` is the list of all blocks, `counted` {module: source with counters},
    `marked` {module: source of its viper functions with marks}, `segments` {module: one list for each of these functions, naming the block to
    which each stretch of code between marks belongs}.
    """

    def __init__(self, sources):
        self.blocks = []
        self.counted = {}
        self.marked = {}
        self.segments = {}
        trees = {module: ast.parse(source) for module, source in sources.items()}
        self._functions = {node.name for tree in trees.values() for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
        for module, tree in trees.items():
            self._module(module, tree)

    def _module(self, module, tree):
        self._name = module
        self._constants = _constants(tree)
        self.segments[module] = []
        kept = [node for node in tree.body if not isinstance(node, (ast.FunctionDef, ast.ClassDef)) or isinstance(node, ast.FunctionDef) and is_viper(node)]
        marked = ast.Module([self._marked(node) if isinstance(node, ast.FunctionDef) else node for node in kept], [])
        first = ast.parse(f"from {COUNTERS} import COUNTERS as _COUNTERS").body
        body = [self._counted(node, "") for node in tree.body]
        at = 1 if body and isinstance(body[0], ast.Expr) else 0
        self.counted[module] = ast.unparse(ast.fix_missing_locations(ast.Module(body[:at] + first + body[at:], [])))
        self.marked[module] = ast.unparse(ast.fix_missing_locations(marked))

    def _counted(self, node, path):
        """The node with counters in every function."""
        if isinstance(node, ast.ClassDef):
            new = ast.ClassDef(**{**vars(node), "body": [self._counted(part, path + node.name + ".") for part in node.body]})
            return new
        if not isinstance(node, ast.FunctionDef):
            return node
        viper = is_viper(node)
        walk = _Walk(self, path + node.name, viper, node.name)
        body = walk.function(node.body)
        if viper:
            body.insert(0, ast.parse("_counters = ptr32(_COUNTERS)").body[0])
        return ast.FunctionDef(**{**vars(node), "body": body})

    def _marked(self, node):
        """The viper function with marks; the counters' numbers follow when the same function is counted."""
        order: list[int] = []
        body = _Marks(order).function(node.body)
        self.segments[self._name].append((node.name, order))
        arguments = ast.arguments(**{**vars(node.args), "args": [*node.args.args, ast.arg("_mark", ast.Name("int"))]})
        return ast.FunctionDef(**{**vars(node), "args": arguments, "body": body})

    def new_block(self, function, line, loop, inside, viper):
        number = len(self.blocks)
        block = Block(number, self._name, function, line, loop, number if loop or inside is None else inside, viper)
        self.blocks.append(block)
        return block

    def charge(self, block, node):
        """Add a statement of bytecode to a block."""
        block.instructions += costs.statement(node, self._functions, self._constants)


class _Shape:
    """Goes through a function's statements in the order of their machine code. What stands at a block's beginning is up to the heirs.

    Each way of a condition is a block, and what follows the condition; a loop's body, and what follows it. The condition of a loop
    stands behind its body in the machine code and is executed as often as that.
    """

    def begin(self, line: int, loop: bool) -> list:
        """Statements at the beginning of a new block."""
        raise NotImplementedError

    def resume(self, outer, node) -> list:
        """Statements behind a condition or loop, where the block round it goes on."""
        raise NotImplementedError

    def tail(self, body) -> list:
        """Statements at the end of a loop's body."""
        raise NotImplementedError

    def current(self):
        """The block that is being filled."""
        raise NotImplementedError

    def charge(self, node) -> None:
        """A statement or condition belongs to it."""
        raise NotImplementedError

    def function(self, body):
        at = self.begin(body[0].lineno, False)
        return [*at, *self.sequence(body)]

    def sequence(self, body):
        out = []
        for node in body:
            out.extend(self.one(node))
        return out

    def one(self, node):
        if isinstance(node, ast.If):
            self.charge(node.test)
            outer = self.current()
            then = [*self.begin(node.body[0].lineno, False), *self.sequence(node.body)]
            otherwise = []
            if node.orelse:
                otherwise = [*self.begin(node.orelse[0].lineno, False), *self.sequence(node.orelse)]
            return [ast.If(node.test, then, otherwise), *self.resume(outer, node)]
        if isinstance(node, (ast.While, ast.For)):
            outer = self.current()
            if isinstance(node, ast.For):
                self.charge(node.iter)
            begin = self.begin(node.body[0].lineno, True)
            body = self.current()
            self.charge(node.test if isinstance(node, ast.While) else _NEXT)
            inner = [*begin, *self.sequence(node.body), *self.tail(body)]
            new = type(node)(**{**vars(node), "body": inner})
            return [new, *self.resume(outer, node)]
        if isinstance(node, ast.Try):
            body = self.sequence(node.body)
            outer = self.current()
            handlers = []
            for handler in node.handlers:
                inner = [*self.begin(handler.body[0].lineno, False), *self.sequence(handler.body)]
                handlers.append(ast.ExceptHandler(handler.type, handler.name, inner))
            final = self.sequence(node.finalbody)
            return [ast.Try(body, handlers, node.orelse, final), *self.resume(outer, node)]
        if isinstance(node, ast.With):
            return [ast.With(node.items, self.sequence(node.body))]
        self.charge(node)
        return [node]


class _Walk(_Shape):
    """Puts counters in and makes the blocks."""

    def __init__(self, cutter, function, viper, entry):
        self._cutter = cutter
        self._function = function
        self._viper = viper
        self._entry = True
        self._loops = [None]
        self._array = "_counters" if viper else "_COUNTERS"

    def begin(self, line, loop):
        self._block = self._cutter.new_block(self._function, line, loop, self._loops[-1], self._viper)
        if loop:
            self._loops.append(self._block.number)
        if self._entry:
            self._entry = False
            self._block.instructions = costs.ENTRY
        at = f"{self._array}[{self._block.number}]"
        return ast.parse(f"{at} = {at} + 1").body

    def resume(self, outer, node):
        return self.begin(node.end_lineno, False)

    def tail(self, body):
        self._loops.pop()
        return []

    def current(self):
        return self._block

    def charge(self, node):
        if not self._viper:
            self._cutter.charge(self._block, node)


class _Marks(_Shape):
    """Puts marks in; `order` names for each stretch of code the block, by its place in the function."""

    def __init__(self, order):
        self._order = order
        self._blocks = 0

    def begin(self, line, loop):
        return self._mark(self._new())

    def resume(self, outer, node):
        return self._mark(self._new())

    def tail(self, body):
        return self._mark(body)

    def current(self):
        return self._block

    def charge(self, node):
        pass

    def _new(self):
        self._block = self._blocks
        self._blocks += 1
        return self._block

    def _mark(self, block):
        self._order.append(block)
        return ast.parse(f"_mark = {MARK}").body


def _constants(tree):
    """Names that the compiler replaces by their values."""
    found: set[str] = set()
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call) and getattr(node.value.func, "id", "") == "const":
            found.update(target.id for target in node.targets if isinstance(target, ast.Name))
    return found
