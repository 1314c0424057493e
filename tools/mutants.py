"""Changes the firmware in one place at a time and looks whether a test notices: make mutants.

    python tools/mutants.py                     all that may stop the robot, and who may command it
    python tools/mutants.py safety/safety.py    one file; :NAME after it for one function
    python tools/mutants.py --list              what there is

mutmut and cosmic-ray start pytest anew for each change, which for these tests takes longer than the tests; here each is a fork that runs plain functions, under
CPython. A change that no test notices is printed: either a test is missing, or the change means nothing. Exit code 1 if there is one.
"""

import argparse
import ast
import copy
import importlib
import os
import signal
import sys
import tempfile
import types
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIB = ROOT / "firmware" / "lib"
TESTS = ROOT / "tests" / "firmware"
LIMIT_S = 60
STOPS = "command stop halt off beyond _beyond _accelerate _doubt update"  # the way of a stop through the drive,
OFF = "begin write motors_off off _check _fail _set_enabled"  # and through the outputs
# file: its tests, the functions that count ("": all)
TARGETS = {
    "safety/safety.py": ("test_safety", ""),
    "safety/stop_button.py": ("test_safety", ""),
    "safety/health.py": ("test_health test_safety", ""),
    "safety/watchdog.py": ("test_safety", ""),
    "safety/survive.py": ("test_safety", ""),
    "safety/first.py": ("test_first", ""),
    "safety/remember.py": ("test_first", ""),
    "link/auth.py": ("test_auth test_link", ""),
    "link/commands.py": ("test_link", ""),
    "link/radio.py": ("test_carriers", ""),
    "perception/scan_trust.py": ("test_scan_trust test_motion_check", ""),
    "actuation/drive.py": ("test_drive", STOPS),
    "actuation/outputs.py": ("test_drive", OFF),
}
SWAPS = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
    ast.And: ast.Or, ast.Or: ast.And, ast.Add: ast.Sub, ast.Sub: ast.Add, ast.RShift: ast.LShift, ast.LShift: ast.RShift,
}  # fmt: skip


def changes(tree, functions):
    """(line, what, tree) of each change, in the functions named or, if none are, everywhere."""
    names = set(functions.split())
    skipped = set()
    for node in ast.walk(tree):
        if names and isinstance(node, ast.FunctionDef) and node.name not in names:
            skipped |= {id(child) for child in ast.walk(node)}
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):  # a docstring
            skipped |= {id(node), id(node.value)}
    inside = {id(child) for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) for child in ast.walk(node)}
    for number, node in enumerate(ast.walk(tree)):
        if id(node) in skipped or names and id(node) not in inside:
            continue
        for what, change in _of(node):
            other = copy.deepcopy(tree)
            place = list(ast.walk(other))[number]
            before = ast.unparse(place)
            change(place)
            yield place.lineno, f"{before}  ->  {what or ast.unparse(place)}", ast.fix_missing_locations(other)


def _of(node):
    """[(how it is told, what does it)] for one node."""
    found = []
    if isinstance(node, ast.Compare) and type(node.ops[0]) in SWAPS:
        found.append(("", lambda n: n.ops.__setitem__(0, SWAPS[type(n.ops[0])]())))
    elif isinstance(node, ast.BoolOp) or isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
        found.append(("", lambda n: setattr(n, "op", SWAPS[type(n.op)]())))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        found.append(("", lambda n: (setattr(n, "op", ast.UAdd()), setattr(n, "operand", ast.Call(ast.Name("bool", ast.Load()), [n.operand], [])))))
    elif isinstance(node, ast.Constant) and type(node.value) is bool:
        found.append(("", lambda n: setattr(n, "value", not n.value)))
    elif isinstance(node, ast.Constant) and type(node.value) is int:
        found.append(("", lambda n: setattr(n, "value", n.value * 2 if abs(n.value) > 99 else n.value + 1)))
    elif (
        isinstance(node, ast.Expr)
        or isinstance(node, (ast.Assign, ast.AugAssign))
        and isinstance(node.targets[0] if isinstance(node, ast.Assign) else node.target, ast.Attribute)
    ):
        found.append(("left out", _leave_out))
    elif isinstance(node, ast.Return) and node.value is not None and not isinstance(node.value, ast.Constant):
        found.append(("", lambda n: setattr(n, "value", ast.Constant(None))))
    return found


def _leave_out(node):
    """Whatever statement it is does nothing any more."""
    line = node.lineno
    node.__class__ = ast.Pass
    node.__dict__.clear()
    node.lineno = node.end_lineno = line
    node.col_offset = node.end_col_offset = 0


def noticed(name, code, tests):
    """Run the tests with the module in a process of its own: True if one fails."""
    child = os.fork()
    if child:
        return os.waitpid(child, 0)[1] != 0
    failed = 1
    try:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            os.dup2(1, 2)
            signal.signal(signal.SIGALRM, signal.SIG_DFL)
            signal.alarm(LIMIT_S)
            _run(name, code, tests)
            failed = 0
            os.chdir("/")
    except BaseException:
        pass
    finally:
        os._exit(failed)


def _look(name, tests, change):
    return noticed(name, compile(change[2], name, "exec"), tests)


def _run(name, code, tests):
    sys.modules["machine"] = sys  # what first.py imports; its tests put their own in its place
    package, _, last = name.rpartition(".")
    module = types.ModuleType(name)
    sys.modules[name] = module
    if package:
        setattr(importlib.import_module(package), last, module)
    exec(code, module.__dict__)
    for test in tests.split():
        found = importlib.import_module(test)
        for one in list(vars(found)):
            if one.startswith("test_") and "allocat" not in one:
                getattr(found, one)()


def main():
    """Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", metavar="FILE[:FUNCTION]", help="of firmware/lib (default: all that are listed)")
    parser.add_argument("--list", action="store_true", help="print the files, and how many changes there are")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N")
    options = parser.parse_args()
    sys.path[:0] = [str(ROOT), str(LIB), str(TESTS)]
    from host import compat

    compat.install()
    survived = total = 0
    for asked in options.files or TARGETS:
        file, _, function = asked.partition(":")
        if file not in TARGETS:
            parser.error(f"{file} is not listed; --list shows what is")
        tests, functions = TARGETS[file]
        tree = ast.parse((LIB / file).read_text())
        name = file.removesuffix(".py").replace("/", ".")
        found = list(changes(tree, function or functions))
        total += len(found)
        print(f"{file}: {len(found)} changes", flush=True)
        if options.list:
            continue
        if noticed(name, compile(tree, file, "exec"), tests):
            print(f"{file}: its tests fail as it is", file=sys.stderr)
            return 1
        with ThreadPoolExecutor(options.jobs) as pool:
            for (line, what, _), seen in zip(found, pool.map(partial(_look, name, tests), found)):
                if not seen:
                    survived += 1
                    print(f"  {file}:{line}: {what}", flush=True)
    print(f"{survived} of {total} changes were noticed by no test" if not options.list else f"{total} changes")
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
