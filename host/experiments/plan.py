"""Which runs there are."""

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import Any

PAPER_WIDTHS = (620, 600, 580, 550, 500)
AWS, NAWS, RULE24, DISC_ROUND, DISC_NARROW = "aws", "naws", "rule24", "disc-round", "disc-narrow"
RATE_WIDTHS = {
    AWS: (700, 660, *PAPER_WIDTHS, 475, 450, 430, 415, 400),
    NAWS: (700, 660, *PAPER_WIDTHS, 475, 450, 400),
    RULE24: (900, 800, 700, 620, 550, 500, 450, 400),
    DISC_ROUND: (900, 800, 750, 700, 620, 500, 400),
    DISC_NARROW: (900, 800, 700, 660, 620, 550, 500, 400),
}
# The three, five and six experiments of sections 6.2 to 6.4 of paper A: widths from its ranges, one at least entered from the other end.
S_RUNS: tuple[dict[str, Any], ...] = ({"course": "S", "width": 575}, {"course": "S-sharp", "width": 500}, {"course": "S-sharp", "width": 500, "reverse": True})
U_RUNS: tuple[dict[str, Any], ...] = (
    {"course": "U", "width": 670},
    {"course": "U", "width": 600},
    {"course": "U", "width": 560},
    {"course": "U", "width": 520},
    {"course": "U", "width": 520, "reverse": True},
)
RANDOM_RUNS: tuple[dict[str, Any], ...] = tuple(
    {"course": "random", "gap": gap, "seed": seed} for gap, seed in ((450, 1), (450, 2), (400, 3), (400, 4), (340, 5), (340, 6))
)
# What is driven with every seed for the time over the best possible, besides the Z passages.
RATIO_RUNS: tuple[dict[str, Any], ...] = (
    {"course": "U", "width": 520},
    {"course": "S", "width": 575},
    {"course": "S-sharp", "width": 500},
    *({"course": "random", "gap": gap} for gap in (450, 400, 340, 300)),
)
TIMED: tuple[dict[str, Any], ...] = tuple({"course": "Z", "width": width, "mode": mode} for width in (620, 600, 580, 550) for mode in (AWS, NAWS))  # figure 23


@dataclass(frozen=True)
class Run:
    """One run. planner: one of the names above; the first two are the firmware's own. shown: its track and decisions are kept.

    timed: it is played back on the bench, and gives decision times and numbers of points.
    """

    planner: str
    course: str
    width: float | None = None
    gap: float = 500
    seed: int = 1
    reverse: bool = False
    shown: bool = False
    timed: bool = False

    @property
    def mode(self):
        """Steering mode of the firmware."""
        return NAWS if self.planner == NAWS else AWS

    def key(self, sources):
        """Under which it is stored. sources: hash of the firmware and of all else that decides how it ends."""
        return hashlib.sha256(json.dumps([asdict(self), sources], sort_keys=True).encode()).hexdigest()[:20]


def plan(quick=False, seeds=5):
    """All runs: those first that are shown. quick: a taste of each section."""
    shown: dict = {}
    for run in _shown(quick):
        shown[run] = None
    rates = RATE_WIDTHS if not quick else dict.fromkeys(RATE_WIDTHS, (600, 500))
    for seed in range(1, (2 if quick else seeds) + 1):
        for planner, widths in rates.items():
            for width in widths:
                run = Run(planner, "Z", width, seed=seed)
                if Run(planner, "Z", width, seed=seed, shown=True) not in shown:
                    shown[run] = None
        for course in () if quick else RATIO_RUNS:
            if Run(AWS, **course, seed=seed, shown=True) not in shown:
                shown[Run(AWS, **course, seed=seed)] = None
    return list(shown)


def _shown(quick):
    for width in PAPER_WIDTHS if not quick else (550,):
        for planner in (AWS, NAWS):
            yield Run(planner, "Z", width, shown=True)
    for course in S_RUNS if not quick else S_RUNS[:1]:
        yield Run(AWS, **course, shown=True)
    for course in U_RUNS if not quick else U_RUNS[3:4]:
        yield Run(AWS, **course, shown=True)
    for course in RANDOM_RUNS if not quick else RANDOM_RUNS[:1]:
        yield Run(AWS, **course, shown=True)
    for planner in (AWS, RULE24, DISC_ROUND, DISC_NARROW):
        for width in (500, 450) if not quick else (500,):
            yield Run(planner, "Z", width, shown=True)
    for timed in TIMED if not quick else TIMED[-2:]:
        yield Run(timed["mode"], timed["course"], timed["width"], timed=True)
