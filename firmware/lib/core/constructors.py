"""Lets go of what only the start needs of the parts of the robot: the code that made them, some 3 kB. Needed at the start only, too."""

import gc
import sys


def drop(part):
    """Take __init__ from the class of a part, and from those of its attributes, and of theirs: there will be no second one.

    On the board only: elsewhere memory is plenty, and other robots may be made of the same classes.
    """
    if sys.implementation.name != "micropython":
        return
    seen = set()
    todo = [part]
    while todo:
        one = todo.pop()
        if isinstance(one, (list, tuple)):
            todo.extend(one)
        elif hasattr(one, "__dict__") and hasattr(type(one), "__dict__") and id(one) not in seen:
            seen.add(id(one))
            todo.extend(one.__dict__.values())
            if type(one).__module__ != "machine" and "__init__" in type(one).__dict__:
                type(one).__init__ = None  # a dict of MicroPython holds on to the value of a key that is deleted
    gc.collect()
