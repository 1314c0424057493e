"""A recording as one message: the whole track and every decision, so that a page shows all of it at once and need not wait until it has been played."""

from host import recording
from host.link.playback import story

NEAR_MM, NEAR_DEG = 8.0, 1.0  # places nearer than that to the last are left out
MOST = 20_000  # decisions told; of more, those that differ from the last
_TOLD = ("af", "ar", "v", "mode", "window", "zone", "free", "why", "state", "took")


def whole(entries: list[tuple[float, dict]]) -> dict:
    """entries: [(s, message)] in order of time. {type "run", track: [{at, x, y, heading}], frame: "true" or "believed", decisions: [{at, ...}]}."""
    places: dict[str, list[dict]] = {"truth": [], "pose": []}
    decisions = []
    for moment, message in entries:
        kind = message["type"]
        if kind in places:
            _add(places[kind], moment, message)
        elif kind == "decision":
            decisions.append({"at": round(moment, 3), **{name: message[name] for name in _TOLD}})
    true = bool(places["truth"])
    return {"type": "run", "track": places["truth" if true else "pose"], "frame": "true" if true else "believed", "decisions": _thinned(decisions)}


def other(path: str) -> dict:
    """Another recording, to be shown beside the one that is open: as `whole`, of type "other". Raises RecordingError."""
    found = whole(sorted(story(recording.Reader(path)), key=lambda entry: entry[0]))
    return {**found, "type": "other", "name": path, "text": ""}


def again(path: str, changes: dict) -> dict:
    """The recording run through the firmware once more with other settings, {"section.key": value}: as `other`, without a track, because the lidar sees
    what it saw then. text: what differs. Raises RecordingError, ValueError."""
    from host.replay import compare, rerun, table, tape  # they need numpy

    reader = recording.Reader(path)
    then = tape.Tape(reader)
    robot = rerun.settings(reader.header.robot, changes)
    now = rerun.rerun(then, robot, chip=float(reader.header.notes.get("chip", "inf")))
    found = compare.decisions_by_time(then.then, now.log)
    decisions = [{"at": round(time / 1e6, 3), **_conduct(one)} for time, one in now.log.decisions]
    name = ", ".join(f"{key} {value}" for key, value in changes.items()) or "the same settings"
    text = table.summary("decisions", found) + (f"; it ended early: {now.stopped}" if now.stopped else "")
    return {"type": "other", "name": name, "text": text, "track": [], "frame": "", "decisions": _thinned(decisions)}


def _conduct(decision: recording.Decision) -> dict:
    return {
        "af": decision.af / 10, "ar": decision.ar / 10, "v": decision.v, "mode": decision.mode, "window": decision.window,
        "zone": None if decision.zone == 255 else decision.zone, "free": decision.free, "why": decision.why, "state": "", "took": 0.0,
    }  # fmt: skip


def _add(track: list[dict], moment: float, place: dict) -> None:
    if track:
        last = track[-1]
        if abs(place["x"] - last["x"]) + abs(place["y"] - last["y"]) < NEAR_MM and abs(place["heading"] - last["heading"]) < NEAR_DEG:
            return
    track.append({"at": round(moment, 2), "x": round(place["x"], 1), "y": round(place["y"], 1), "heading": round(place["heading"], 1)})


def _thinned(decisions: list[dict]) -> list[dict]:
    if len(decisions) <= MOST:
        return decisions
    names = ("af", "ar", "v", "why", "state")
    return [one for k, one in enumerate(decisions) if not k or any(one[name] != decisions[k - 1][name] for name in names)][:MOST]
