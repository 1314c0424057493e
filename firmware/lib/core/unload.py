"""Modules that are needed once, at the start: let go again, they leave their room in the heap to the robot."""

import gc
import sys


def unload(*names):
    """Drop modules ("package.module"), on the board only: elsewhere memory is plenty, and others may hold on to the same modules."""
    if sys.implementation.name == "micropython":
        for name in names:
            sys.modules.pop(name, None)
            package, _, module = name.rpartition(".")
            if package and hasattr(sys.modules.get(package), module):
                delattr(sys.modules[package], module)
        gc.collect()
