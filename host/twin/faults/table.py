"""Every fault once, in the twin, and what the robot did: the table of docs/safety.md."""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from ..run import run
from .base import KINDS, Kind, Outcome

PAGE = Path(__file__).resolve().parents[3] / "docs" / "safety.md"
BEGIN, END = "<!-- begin: python -m host.twin.faults -->", "<!-- end -->"
COURSE, WIDTH, MODE = "Z", 550, "aws"
QUICK = ("hang", "lidar-silent", "lidar-frozen", "button-held", "chip-reset", "brown-out")
ORDER = ("lidar", "button", "chips", "wheels", "board")  # of the modules, and of the rows
TITLES = {"lidar": "Lidar", "button": "Stop button", "chips": "Chips, bus, supply", "wheels": "Wheels and body", "board": "Inside the processor"}


@dataclass(frozen=True)
class Row:
    """A fault and what came of it. result, reason: of the run."""

    kind: Kind
    outcome: Outcome
    result: str
    reason: str

    @property
    def in_time(self):
        """Whether the wheels were still as soon as the robot promises."""
        within, still = self.kind.within_ms, self.outcome.still_ms
        return within is None or still is not None and still <= within

    @property
    def drove_again_s(self):
        """Seconds with motors on after the wheels had been still."""
        if self.outcome.still_ms is None:
            return 0.0
        return max(self.outcome.driven_after_s - self.outcome.still_ms / 1000, 0.0)

    @property
    def then_as_promised(self):
        """Whether it drove on, or stood on, as promised."""
        kind = self.kind
        if kind.within_ms is None:
            return self.outcome.driven_after_s > 1 and (self.result == "pass" or self.outcome.still_ms is None or self.drove_again_s >= 0.1)
        return kind.again_s is None or self.drove_again_s < kind.again_s + 0.1

    @property
    def kept(self):
        """Whether all that is promised for this fault was kept."""
        return self.outcome.fault_at_s is not None and not self.outcome.touched_after and self.in_time and self.then_as_promised


def measure(names=None, jobs=2, course=COURSE, width=WIDTH, mode=MODE, chip=1.0):
    """Yields a Row for each name (None: all), in their order. jobs: processes at a time. chip: see `host.twin.run`."""
    names = sorted(KINDS, key=_place) if names is None else names
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(_one, names, [(course, width, mode, chip)] * len(names))


def _place(name):
    return ORDER.index(KINDS[name].module), name


def _one(name, settings):
    course, width, mode, chip = settings
    result = run(course, width, mode=mode, fault=name, chip=chip, record=False)
    return Row(KINDS[name], result.fault, result.result, result.reason)


def markdown(rows):
    """The table, a part for each kind of fault. What breaks a promise is in bold."""
    kept = sum(row.kept for row in rows)
    lines = [f"{kept} of {len(rows)} faults are met as promised; what is not is in bold."]
    for module in ORDER:
        part = [row for row in rows if row.kind.module == module]
        if part:
            lines += ["", f"### {TITLES[module]}", "", "| fault | what fails | promised | still after | contacts | then |", "|---|---|---|---|---|---|"]
            lines += [_line(row) for row in part]
    return "\n".join(lines)


def _line(row):
    kind, outcome = row.kind, row.outcome
    still = "never" if outcome.still_ms is None else f"{outcome.still_ms:.0f} ms"
    if outcome.fault_at_s is None:
        still = "**the fault never began**"
    elif kind.within_ms is None:
        still = "-"
    elif not row.in_time:
        still = f"**{still}**"
    touched = f"**{outcome.touched_after}**" if outcome.touched_after else "0"
    then = _then(row)
    if not row.then_as_promised:
        then = f"**{then}**"
    return f"| {kind.name} | {kind.text} | {_promise(kind)} | {still} | {touched} | {then} |"


def _promise(kind):
    if kind.within_ms is None:
        return "drives on"
    text = "still at once" if kind.within_ms < 10 else f"still in {kind.within_ms / 1000:g} s"
    if kind.again_s == 0:
        return text + ", stays"
    return text if kind.again_s is None else text + f", then at most {kind.again_s:g} s back"


def _then(row):
    if row.result == "pass":
        return "drives on, through the course"
    if row.outcome.driven_after_s and (row.outcome.still_ms is None or row.drove_again_s >= 0.1):
        text = f"drives on, {row.outcome.driven_after_s:.1f} s"
        return text + (", until a wall holds it" if row.reason.startswith("held") else "")
    return "the firmware has ended" if row.reason.startswith("the firmware") else "stands"


def write(table, page=PAGE):
    """Put the table between its two marks in the page. ValueError if they are not there."""
    text = page.read_text()
    head, begin, rest = text.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"{page} has no place for the table: between {BEGIN} and {END}")
    page.write_text(f"{head}{BEGIN}\n{table}\n{END}{tail}")
