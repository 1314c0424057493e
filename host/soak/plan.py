"""Which cases there are: all that is random about them, drawn from their number."""

from dataclasses import dataclass

import numpy as np

from host.twin.faults import KINDS

CORRIDORS = ("Z", "U", "S", "S-sharp", "bend")
WIDTHS = 430, 720  # mm
GAPS = 320, 600
ROOM = "room"  # closed, with boxes in it: nobody gets out, and the run is long
SIZES = 2500, 5000  # of a room
ROOM_S = 180.0
BEGINS = 3.5, 15.0  # s, of a fault


@dataclass(frozen=True)
class Case:
    """One run. fault: as host.twin takes it, None in those in which nothing fails."""

    campaign: int
    number: int
    course: str
    width: float
    gap: float
    seed: int
    mode: str
    mirror: bool
    reverse: bool
    fault: str | None

    def key(self, sources):
        """Under which it is stored: whatever the sources were then, what has been driven has been driven."""
        return f"{self.campaign}-{self.number}"


def case(campaign, number):
    """The Case of that number in a campaign."""
    random = np.random.default_rng([campaign, number, 0x50A])
    kind = random.choice(("corridor", "random", ROOM), p=(0.5, 0.3, 0.2))
    course = str(random.choice(CORRIDORS)) if kind == "corridor" else str(kind)
    width = round(random.uniform(*(SIZES if kind == ROOM else WIDTHS)))
    return Case(
        campaign,
        number,
        course,
        float(width),
        float(round(random.uniform(*GAPS))),
        int(random.integers(1, 1 << 30)),
        "aws" if random.random() < 0.75 else "naws",
        bool(random.random() < 0.5),
        bool(random.random() < 0.5) and kind == "corridor",
        _fault(random) if random.random() < 0.5 else None,
    )


def _fault(random):
    kind = KINDS[str(random.choice(sorted(KINDS)))]
    began = round(random.uniform(*BEGINS), 2)
    return kind.name if getattr(kind.make(**kind.settings), "at_start", False) else f"{kind.name}@{began}"
