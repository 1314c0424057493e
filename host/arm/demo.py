"""python -m host.arm demo: the paper's experiment II planned, played by the firmware in the twin, drawn and animated."""

import json
from pathlib import Path

from . import check, model, picture, reach, refuse, rehearse, scenes, search
from .planning import find, words
from .problem import CLEARANCE


def run(folder: str | Path, scene: str = "paper-2", seed: int = 0, as_json: bool = False) -> int:
    """Writes reach.json, reach.csv, arm.png and arm.gif into the folder; the exit code."""
    folder = Path(folder)
    arm, place = model.load("paper-3r"), scenes.scene(scene)
    assert place.start and place.end
    starts = refuse.place(arm, "start", place.start, place.obstacles, CLEARANCE)
    ends = refuse.place(arm, "end", place.end, place.obstacles, CLEARANCE)
    plan = find(arm, place.obstacles, refuse.pairs(arm, starts, ends), search.Options(seed=seed))
    if plan.genes is None or plan.found is None:
        print("no valid trajectory found")
        return 1
    found = reach.of_plan(plan.problem, plan.genes, plan.found, {"seconds": round(plan.seconds, 3), "scene": scene, "seed": seed})
    wrong, _ = check.check(found)
    reach.write(found, folder / "reach.json")
    reach.write_csv(found, folder / "reach.csv")
    played = rehearse.rehearse(found)
    picture.draw(found, folder / "arm.png", played)
    picture.animate(found, folder / "arm.gif", played)
    told = found.told | {"valid": not wrong, "tracking_rms_deg": round(played.rms, 3), "tracking_worst_deg": round(played.worst, 3)}
    if as_json:
        print(json.dumps(told))
    else:
        print(words(told))
        print(f"played by the firmware in the twin: {played.rms:.2f} deg rms off, {played.worst:.2f} at most")
        print("written: " + ", ".join(str(folder / name) for name in ("arm.png", "arm.gif", "reach.json", "reach.csv")))
    return 1 if wrong else 0
