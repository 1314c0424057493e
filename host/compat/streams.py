"""Standard output as MicroPython has it."""


class Output:
    """A text stream whose `buffer` writes a part of a buffer, as MicroPython's streams do: write(data, at, count)."""

    def __init__(self, stream):
        self._stream = stream
        self.buffer = _Buffer(stream.buffer)

    def write(self, text):
        count = self._stream.write(text)
        self._stream.flush()
        return count

    def flush(self):
        self._stream.flush()


class _Buffer:
    def __init__(self, stream):
        self._stream = stream

    def write(self, data, at, count):
        """Write data[at:at + count]."""
        self._stream.write(memoryview(data)[at : at + count])
        self._stream.flush()
        return count
