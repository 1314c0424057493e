"""Writes changed values into robot.json; everything else in it stays as it was, to the character. Loaded when a person asks for it, then let go.

The file is never in memory as a whole: it goes through a small block into a new file beside it, which then takes its place.
"""

import json
import os

from micropython import const

_BLOCK = const(64)
_END = const(0)  # what stands for a character behind the last
_QUOTE = const(0x22)
_BACKSLASH = const(0x5C)
_COMMA = const(0x2C)
_COLON = const(0x3A)
_OPEN = const(0x7B)
_CLOSE = const(0x7D)


def keep(path, changed, trims=()):
    """changed: {key as "avoid.margin": its value}; a key or group that is not in the file yet is added. trims: of all wheels (0.1 deg), written out if one was changed.

    OSError if the file cannot be written, ValueError if it is not JSON; the old file is whole then.
    """
    # A new file first: a robot switched off in the middle must find the old one or the new one.
    part = path + ".new"
    try:
        with open(path, "rb") as source, open(part, "wb") as target:
            text = _Text(source, target)
            text.write(text.space())
            _members(text, "", _as_json(changed, trims))
            text.write("\n")
    except ValueError:
        os.remove(part)
        raise ValueError("robot.json on the board is not JSON any more")
    os.rename(part, path)


def _as_json(changed, trims):
    """{key: its value as JSON}."""
    found = {}
    for key, value in changed.items():
        if key.startswith("servos.trims."):
            # A single trim may stand for all wheels; written out, each can have its own.
            key, value = "servos.trims", [trim / 10 if trim % 10 else trim // 10 for trim in trims]
        found[key] = json.dumps(value)
    return found


class _Text:
    """The file on its way through: char is where it is read; what is passed goes into the new file, unless `left_out`."""

    def __init__(self, source, target):
        self._source = source
        self._target = target
        self._block = memoryview(bytearray(_BLOCK))
        self._begin = self._at = self._count = 0  # block[begin:at] has been passed and not been written yet
        self.char = None
        self.left_out = False
        self.go_on()

    def go_on(self):
        """To the next character. ValueError if there was none."""
        if self.char == _END:
            raise ValueError
        self._at += 1
        if self._at >= self._count:
            self._at = self._count
            self.write("")
            self._begin = self._at = 0
            self._count = self._source.readinto(self._block)
        self.char = self._block[self._at] if self._count else _END

    def write(self, new):
        """Put a text into the new file, behind what has been passed."""
        if not self.left_out:
            self._target.write(self._block[self._begin : self._at])
        self._begin = self._at
        self._target.write(new.encode())

    def space(self):
        """Pass white space, which is returned instead of being written."""
        self.write("")
        self.left_out = True
        found = ""
        while _END < self.char <= 0x20:
            found += chr(self.char)
            self.go_on()
        self._begin = self._at
        self.left_out = False
        return found

    def past(self, wanted):
        """Pass one certain character."""
        if self.char != wanted:
            raise ValueError
        self.go_on()

    def string(self):
        """Pass a string; what stands between the quotes."""
        found = bytearray()
        self.past(_QUOTE)
        while self.char != _QUOTE:
            if self.char == _BACKSLASH:
                found.append(_BACKSLASH)
                self.go_on()
            found.append(self.char)
            self.go_on()
        self.go_on()
        return found.decode()

    def value(self):
        """Pass a value."""
        depth = 0
        while depth or self.char > 0x20 and self.char != _COMMA and self.char != _CLOSE:
            char = self.char
            if char == _QUOTE:
                self.string()
                continue
            if char == _OPEN or char == 0x5B:
                depth += 1
            elif char == _CLOSE or char == 0x5D:
                depth -= 1
            self.go_on()


def _members(text, prefix, changed):
    """Pass an object, with its changes; prefix: "" for the outermost, "avoid." and so on inside. `changed` loses what has been dealt with."""
    text.past(_OPEN)
    before = after = text.space()  # the last member's white space
    empty = text.char == _CLOSE
    more = not empty
    while more:
        text.write(before)
        key = prefix + text.string()
        text.write(text.space())
        text.past(_COLON)
        text.write(text.space())
        if key in changed:
            text.write("")
            text.left_out = True
            text.value()
            text.write(changed.pop(key))
            text.left_out = False
        elif text.char == _OPEN and not prefix:
            _members(text, key + ".", changed)
        else:
            text.value()
        after = text.space()
        more = text.char == _COMMA
        if more:
            text.write(after)
            text.go_on()
            before = text.space()
    for key, value in _missing(prefix, changed):
        text.write("%s%s%s: %s" % ("" if empty else ",", before or " ", key, value))
        empty = False
    text.write(after)
    text.past(_CLOSE)


def _missing(prefix, changed):
    """[(key, value)], as JSON, of the changes that belong into this object and have not been found there."""
    names = sorted([key for key in changed if key.startswith(prefix)])
    if prefix:
        return [('"%s"' % key[len(prefix) :], changed.pop(key)) for key in names]
    groups = {}
    for key in names:
        group, _, name = key.partition(".")
        groups[group] = groups.get(group, []) + ['"%s": %s' % (name, changed[key]) if name else changed[key]]
    return [('"%s"' % group, ", ".join(groups[group]) if group in changed else "{%s}" % ", ".join(groups[group])) for group in sorted(groups)]
