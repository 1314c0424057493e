"""The error of host/boards and host/flash."""


class FlashError(Exception):
    """A step failed. The text names what failed and, on its last line, what to do about it."""

    def __init__(self, what: str, remedy: str):
        super().__init__(f"{what}\n  -> {remedy}")
        self.what = what
        self.remedy = remedy
