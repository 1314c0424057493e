"""What is wrong with a map."""


class MapError(ValueError):
    """A map that cannot be read, made or sent; the text names the file and says what to do."""
