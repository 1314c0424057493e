"""Runs the tests of one file under MicroPython: micropython runner.py <module> <test>...

Before each test a line "## start <test>", after it "## passed <test>", or its traceback and "## failed <test>". tests/conftest.py reads them.
"""

import gc
import sys


def main(module, names):
    tests = __import__(module)
    for name in names:
        print("## start", name)
        gc.collect()
        try:
            getattr(tests, name)()
        except BaseException as error:
            sys.print_exception(error, sys.stdout)
            print("## failed", name)
        else:
            print("## passed", name)


main(sys.argv[1], sys.argv[2:])
