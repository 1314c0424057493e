"""The `micropython` module as CPython sees it: emitters that change no result, and heap controls that do nothing."""

from functools import wraps

from .pointers import pointer_parameters


def const(value):
    """The value itself; MicroPython folds it into the byte code."""
    return value


def native(function):
    """The function itself; MicroPython compiles it to machine code."""
    return function


def viper(function):
    """The function with its ptr parameters turned into unsigned views.

    Integers stay CPython's: they do not wrap at 32 bits, so a sum that overflows on the board shows as a difference between
    the two interpreters.
    """
    pointers = pointer_parameters(function)
    if not pointers:
        return function

    @wraps(function)
    def call(*given):
        arguments = list(given)
        for position, convert in pointers:
            arguments[position] = convert(arguments[position])
        return function(*arguments)

    return call


def heap_lock():
    """No effect: CPython's heap cannot be locked."""
    return 0


def heap_unlock():
    """No effect."""
    return 0


def heap_locked():
    """Always 0."""
    return 0


def alloc_emergency_exception_buf(size):
    """No effect."""


def kbd_intr(character):
    """No effect."""


def mem_info(verbose=False):
    """No effect."""


def opt_level(level=None):
    """Always 0."""
    return 0


def schedule(function, argument):
    """Call at once; MicroPython calls soon."""
    function(argument)
