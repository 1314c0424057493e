"""Modules that are needed now and then, or once at the start: let go again, they leave their room in the heap to the robot."""

import gc
import sys


def forget(*names):
    """Drop modules ("package.module"), on the board only: elsewhere memory is plenty, and others may hold on to the same modules.

    The next collection gives their room back.
    """
    if sys.implementation.name == "micropython":
        for name in names:
            sys.modules.pop(name, None)
            package, _, module = name.rpartition(".")
            if package in sys.modules:
                sys.modules[package].__dict__.pop(module, None)


def unload(*names):
    """Drop modules and collect, which takes some milliseconds."""
    forget(*names)
    gc.collect()
