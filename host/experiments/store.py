"""Finished runs, one JSON object a line, so that a campaign goes on where it was broken off."""

import json
from pathlib import Path


class Store:
    """path: of the file. `done`: {key: what execute gave}; a line cut short by a crash is left out."""

    def __init__(self, path):
        self.path = Path(path)
        self.done = {}
        if self.path.exists():
            for line in self.path.read_text().splitlines():
                try:
                    entry = json.loads(line)
                    self.done[entry["key"]] = entry
                except (ValueError, KeyError, TypeError):
                    continue

    def add(self, entry):
        """Keep a finished run; it is on the disk when this returns."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self.done[entry["key"]] = entry
        with open(self.path, "a+b") as file:
            if file.tell():
                file.seek(-1, 2)
                if file.read(1) != b"\n":
                    file.write(b"\n")
            file.write(json.dumps(entry, separators=(",", ":")).encode() + b"\n")
