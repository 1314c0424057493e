"""Writes changed values into robot.json; everything else in it stays as it was, to the character. Loaded when a person asks for it, then let go."""

import os

from micropython import const

_QUOTE = const(0x22)
_BACKSLASH = const(0x5C)
_COMMA = const(0x2C)
_COLON = const(0x3A)
_OPEN = const(0x7B)
_CLOSE = const(0x7D)


def keep(path, changed):
    """changed: {key as "avoid.margin": its value as JSON}; a key or group that is not in the file yet is added.

    OSError if the file cannot be written, ValueError if it is not JSON; the old file is whole then.
    """
    text = bytearray(os.stat(path)[6])  # read() would take up to twice as much on its way
    with open(path, "rb") as source:
        source.readinto(text)
    edits = []
    try:
        end = _members(text, _space(text, 0), "", dict(changed), edits)
    except (IndexError, ValueError):
        raise ValueError("robot.json on the board is not JSON any more")
    # A new file first: a robot switched off in the middle must find the old one or the new one.
    part = path + ".new"
    view = memoryview(text)
    done = 0
    with open(part, "wb") as target:
        for start, stop, new in edits:
            target.write(view[done:start])
            target.write(new.encode())
            done = stop
        target.write(view[done:end])
        target.write(b"\n")
    os.rename(part, path)


def _members(text, at, prefix, changed, edits):
    """Walk an object from its brace on; prefix: "" for the outermost, "avoid." and so on inside. Returns the place behind it.

    edits: gets (start, end, text to stand there), in the order of the places. `changed` loses what has been dealt with.
    """
    at = _past(text, at, _OPEN)
    lead = last = at  # before the white space of the last member; behind that member
    at = first = _space(text, at)
    empty = text[at] == _CLOSE
    while text[at] != _CLOSE:
        first = at
        end = _string(text, at)
        key = prefix + text[at + 1 : end - 1].decode()
        at = _space(text, _past(text, _space(text, end), _COLON))
        if key in changed:
            last = _value(text, at)
            edits.append((at, last, changed.pop(key)))
        elif text[at] == _OPEN and not prefix:
            last = _members(text, at, key + ".", changed, edits)
        else:
            last = _value(text, at)
        at = _space(text, last)
        if text[at] == _COMMA:
            lead = at + 1
            at = _space(text, lead)
    new = ""
    space = text[lead:first].decode()
    for key, value in _missing(prefix, changed):
        new += "%s%s%s: %s" % ("" if empty else ",", space or " ", key, value)
        empty = False
    if new:
        edits.append((last, last, new))
    return at + 1


def _space(text, at):
    """The place behind white space."""
    while text[at] <= 0x20:
        at += 1
    return at


def _past(text, at, wanted):
    if text[at] != wanted:
        raise ValueError
    return at + 1


def _string(text, at):
    """The place behind a string."""
    at = _past(text, at, _QUOTE)
    while text[at] != _QUOTE:
        at += 2 if text[at] == _BACKSLASH else 1
    return at + 1


def _value(text, at):
    """The place behind a value."""
    depth = 0
    while True:
        char = text[at]
        if char == _QUOTE:
            at = _string(text, at)
            continue
        if depth == 0 and (char <= 0x20 or char == _COMMA or char == _CLOSE):
            return at
        if char == _OPEN or char == 0x5B:
            depth += 1
        elif char == _CLOSE or char == 0x5D:
            depth -= 1
        at += 1


def _missing(prefix, changed):
    """[(key, value)], as JSON, of the changes that belong into this object and have not been found there."""
    names = sorted([key for key in changed if key.startswith(prefix)])
    if prefix:
        return [('"%s"' % key[len(prefix) :], changed.pop(key)) for key in names]
    groups = {}
    for key in names:
        group, name = key.split(".")
        groups[group] = groups.get(group, []) + ['"%s": %s' % (name, changed[key])]
    return [('"%s"' % group, "{%s}" % ", ".join(groups[group])) for group in sorted(groups)]
