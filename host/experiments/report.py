"""Writes docs/results.md and its pictures from finished runs."""

from pathlib import Path

from . import figures, plan, tables

COMMAND = "python -m host.experiments"


def write(done, sources, options, folder):
    """Write results.md and results/*.png into the folder. done: {Run: entry}. sources: hash. options: text of the options that were given."""
    folder = Path(folder)
    pictures = folder / "results"
    seeds = sorted({run.seed for run in done if run.course == "Z"})
    made = f"`{COMMAND}{options}`, seeds {seeds[0]} to {seeds[-1]}, sources {sources}"
    found = tables.rates(done)
    shown = {run: entry for run, entry in done.items() if run.shown}
    figures.pass_rate(found, pictures / "pass-rate.png")
    _tracks(shown, pictures)
    together = _together(shown)
    if together:
        figures.side_by_side(together, pictures / "side-by-side.png")
    times = [(f"{run.planner.upper()} {run.width:g}, ESP32", tables.classes(chip)) for run, chip, _, _ in tables.time_rows(done)]
    times += [(f"{run.planner.upper()} {run.width:g}, here", tables.classes(here)) for run, _, here, _ in tables.time_rows(done)]
    figures.decision_times(times, pictures / "decision-times.png")
    (folder / "results.md").write_text(_text(done, found, made, together))


def _tracks(shown, pictures):
    z = []
    for width in plan.PAPER_WIDTHS:
        entries = [entry for run, entry in shown.items() if run.course == "Z" and run.width == width and run.planner in (plan.AWS, plan.NAWS)]
        if entries:
            z.append((f"Z, {width} mm", entries))
    figures.tracks_and_curves(z, pictures / "z.png")
    for name, courses in (("s", ("S", "S-sharp")), ("u", ("U",)), ("random", ("random",))):
        rows = []
        for run, entry in shown.items():
            if run.course in courses:
                size = f"gaps of {run.gap:g} mm, seed {run.seed}" if run.course == "random" else f"{run.width:g} mm"
                rows.append((f"{run.course}, {size}{', from the other end' if run.reverse else ''}", [entry]))
        figures.tracks_and_curves(rows, pictures / f"{name}.png")


def _together(shown):
    """The narrowest width at which all planners were shown, ours first."""
    for width in sorted({run.width for run in shown if run.planner == plan.DISC_NARROW}):
        entries = [
            entry
            for planner in (plan.AWS, plan.RULE24, plan.DISC_NARROW, plan.DISC_ROUND)
            for run, entry in shown.items()
            if run.planner == planner and run.course == "Z" and run.width == width
        ]
        if entries[0]["result"] == "pass":
            return entries
    return None


def _text(done, found, made, together):
    rates = [_RATES, tables.rate_table(found), "(passed without touching / runs)", _picture("pass-rate", "pass rate against the width of the Z passage", made)]
    if together:
        run = together[0]["run"]
        words = f"four planners, one start (seed {run['seed']}), a Z passage {run['width']:g} mm wide"
        rates.append(_picture("side-by-side", words, made))
    times = _TIMES.format(paper=tables.PAPER_UP_TO_20_MS)
    sections = (
        ("Time over the best possible", _BEST, tables.ratio_table(done)),
        ("Narrower than long", *rates),
        (
            "Z: Table 3 and figure 22",
            tables.table_3(done),
            _STARTS,
            tables.last_axle_note(done),
            _picture("z", "tracks of front A and rear B, steering and speed decided, seed 1", made),
        ),
        ("Decision times: figure 23", times, _picture("decision-times", "decision times in the classes of figure 23", made), tables.time_table(done)),
        ("S: figures 24 to 26", tables.run_table(done, ("S", "S-sharp")), _picture("s", "the S courses", made)),
        ("U: figures 27 and 28", tables.run_table(done, ("U",)), _picture("u", "the U courses", made)),
        ("Random: figures 29 to 33", tables.run_table(done, ("random",)), _picture("random", "the random courses", made)),
        ("Points: figure 11", tables.point_table(done), _POINTS),
        ("The planners compared", _PLANNERS),
    )
    return "\n\n".join([_HEAD.format(made=made), *("\n\n".join(("## " + section[0], *section[1:])) for section in sections)]) + "\n"


def _picture(name, words, made):
    return f"![{words}](results/{name}.png)\n*{words[0].upper() + words[1:]}. Made by {made}.*"


_HEAD = """# Results

The experiments of the papers, run in the digital twin with the robot's own firmware under MicroPython; all figures and tables below come from
one campaign: {made}. `make experiments` makes them again; `sources` is the hash of the firmware, the planners it is compared with and the twin.
Nothing here was measured on hardware. The two pictures that say most are the first two."""

_BEST = """How long the robot takes from the first turn of a motor to the goal, over the least time that any planner could need which knows the whole map, whose servos take no time
and whose fastest wheel rolls at cruise all the way: Dijkstra's algorithm over places of 25 mm and headings of 7.5 degrees, 2 mm from the walls ([best.py](../host/twin/best.py)).
The robot sees a lidar's revolution at a time and stands while its wheels swing. A reversal is a change between forward and backward; stops, the way of its centre and the
sum of all changes of AF and AR are medians of the runs that passed."""

_RATES = """How often the Z course is passed without touching anything, over its width. *aws* and *naws* are this robot with all wheels steered and with
the last axle straight (see the note at Table 3). The others replace the planner and nothing else; see the end of this page."""

_STARTS = "The paper drove each once, from a start it does not tell. Here every run starts up to 40 mm and 5 degrees off."

_POINTS = "Medians over each run. The memory holds more than one revolution shows: it keeps what the lidar is too near to see."

_TIMES = """The paper's decisions, on a laptop, took at most 20 ms in {paper:g} % of the cases or more. A decision here is all its slices together, the way
out and the look-ahead included; going on with a plan that still holds is not counted as one. *Here* is MicroPython on the computer that ran
this campaign, *ESP32* is modelled from the instructions executed (`make bench`). The robot goes on between slices, so what a lidar frame waits for is the longest slice, not the decision."""

_PLANNERS = """- **rule24**: [paper A](planner.md#sources) as written: windows and zones of one revolution, gaps between neighbouring points, [AF and AR](planner.md#the-words) by one degree until rule (24) holds,
  with a compensation of 35 mm (the paper gives no value), the emergency moves of its section 6, and section 4.3 where no gap is found. What the paper leaves
  open is the mirror image of what it says.
- **disc-round**, **disc-narrow**: follow the gap (Sezer and Gokasan 2012) with the body taken for a disc: the one round the body, 325 mm in
  radius, which is safe but too wide, and the one as wide as the body, 125 mm, which fits but forgets the corners. They steer AF = -AR, up to 38 degrees."""
