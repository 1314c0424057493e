"""Writes changed values into robot.json; everything else in it stays as it was, to the character. Loaded when a person asks for it, then let go."""

import os


def keep(path, changed):
    """changed: {key as "avoid.margin": its value as JSON}; a key or group that is not in the file yet is added.

    OSError if the file cannot be written, ValueError if it is not JSON; the old file is whole then.
    """
    # A new file first: a robot switched off in the middle must find the old one or the new one.
    part = path + ".new"
    with open(path) as source:
        with open(part, "w") as target:
            copy = _Copy(source, target.write)
            copy.space(True)
            _members(copy, "", dict(changed))
            target.write("\n")
    os.rename(part, path)


class _Copy:
    """Reads JSON a character at a time, because the board has no room for the whole; `char` is the next one."""

    def __init__(self, source, write):
        self._read = source.read
        self.write = write
        self.char = self._read(1)

    def take(self, wanted=None):
        """The next character. ValueError at the end, or if another one is wanted."""
        char = self.char
        if not char or wanted is not None and char != wanted:
            raise ValueError("robot.json on the board is not JSON any more")
        self.char = self._read(1)
        return char

    def space(self, written=False):
        """White space, as text."""
        text = ""
        while self.char in " \t\r\n" and self.char:
            text += self.take()
        if written:
            self.write(text)
        return text

    def text(self):
        """A string with its quotes."""
        text = self.take('"')
        while self.char != '"':
            text += self.take()
            if text[-1] == "\\":
                text += self.take()
        return text + self.take()

    def value(self, write):
        """Pass over a value, writing what is read."""
        depth = 0
        while True:
            if self.char == '"':
                write(self.text())
            elif depth == 0 and self.char in ",} \t\r\n":
                return
            else:
                char = self.take()
                depth += (char in "[{") - (char in "]}")
                write(char)


def _members(copy, prefix, changed):
    """Copy an object; prefix: "" for the outermost, "avoid." and so on inside."""
    write = copy.write
    write(copy.take("{"))
    lead = between = copy.space()
    empty = True
    while copy.char != "}":
        lead = between
        write(between)
        key = copy.text()
        write(key)
        copy.space(True)
        write(copy.take(":"))
        copy.space(True)
        key = prefix + key[1:-1]
        if key in changed:
            write(changed.pop(key))
            copy.value(len)
        elif copy.char == "{" and not prefix:
            _members(copy, key + ".", changed)
        else:
            copy.value(write)
        empty = False
        between = copy.space()
        if copy.char == ",":
            write(copy.take())
            between = copy.space()
    for key, text in _missing(prefix, changed):
        write("%s%s%s: %s" % ("" if empty else ",", lead or " ", key, text))
        empty = False
    write(between)
    write(copy.take())


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
