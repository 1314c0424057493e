"""One case, wherever it is driven: what goes in and out can be pickled and is small."""

import json
import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np

from host.experiments import plan as planned
from host.experiments import planners
from host.link import messages
from host.twin import Observer, image, run
from host.twin.boxes import scatter
from link import frames, protocol

from . import plan

CONTACT, AFTER_FAULT, HANG = "contact", "contact after the fault", "hang"
FOLDER = image.ROOT / "out" / "soak"  # of the recordings
_HEALTH = protocol.SYNC + bytes((protocol.VERSION, protocol.HEALTH))
_LOG = protocol.SYNC + bytes((protocol.VERSION, protocol.LOG))
_WDT_RESET = 3
_SCAN = 12  # of safety/faults.py: this and the later ones are for lidar and motion
_SETTLED_S = 2.0  # of uptime: trust in the scan has been earned by then
_COLLECTED_S = 11.0  # the heap is looked at every 10 s, while the robot stands
_START_S = 4.0  # and so long before the loop begins at the most
_FAILED = (7, 9, 10)  # memory, an exception, the watchdog
_WANTED = ("hang", "exception", "memory", "heap", "slow")  # faults that may end in one of those
_BAY = 800.0  # mm of a room in which no box lies
_LONGEST = 200  # of the texts that are kept


class Watch(Observer):
    """What a run shows besides its result. heap, worst, faults: [(s, value)] of the health messages."""

    def __init__(self):
        self.resets, self.said = [], bytearray()

    def step(self, simulation):
        self.simulation = simulation

    def reset(self, time, cause):
        self.resets.append((time / 1e6, cause))

    def serial(self, data):
        self.said += data

    def told(self):
        """(health messages, lines of the log)"""
        health = [messages.decode(protocol.HEALTH, payload) for payload in _cut(self.said, _HEALTH)]
        logs = [messages.decode(protocol.LOG, payload) for payload in _cut(self.said, _LOG)]
        return [one for one in health if one], [one["text"][:_LONGEST] for one in logs if one]


def _cut(said, head):
    """Payloads of the whole frames that begin with these bytes."""
    at = said.find(head)
    while at >= 0:
        end = at + protocol.HEADER + int.from_bytes(said[at + 6 : at + 8], "little") + protocol.CHECK
        for _, _, payload in frames.decode(bytes(said[at:end])):
            yield payload
        at = said.find(head, at + 1)


_HANDLED = ("pushed", "turned")
_HANDLED_S = 1.5  # that somebody pushes takes a second


def execute(case, sources):
    """Drive a plan.Case with the sources of that hash; returns a dict that JSON can hold. Called on workers too."""
    firmware = planners.firmware(planned.AWS, sources)
    watch = Watch()
    FOLDER.mkdir(parents=True, exist_ok=True)
    recording = FOLDER / f"{sources}-{case.key(sources)}.rec"
    recording.unlink(missing_ok=True)  # of the same case, driven before: this run is the same
    settings = dict(seed=case.seed, mode=case.mode, mirror=case.mirror, reverse=case.reverse, fault=case.fault)
    settings |= dict(config=firmware / "robot.json", firmware=firmware, watch=watch, record=recording)
    if case.course == plan.ROOM:
        with tempfile.TemporaryDirectory() as folder:
            room = Path(folder) / "room.json"
            room.write_text(json.dumps(room_of(case)))
            done = run(str(room), **(settings | dict(mirror=False, limit_s=plan.ROOM_S)))
    else:
        done = run(case.course, case.width if case.course != "random" else None, case.gap, **settings)
    out = {"key": case.key(sources), "sources": sources, "case": asdict(case)} | _figures(case, done, watch)
    if out["bad"]:
        out["recording"] = str(recording)
    else:
        recording.unlink(missing_ok=True)
    return out


def room_of(case):
    """A closed room, as a world of the twin: the robot stands with its back to a wall, boxes lie about."""
    size = case.width
    boxes = scatter((size, size), case.gap, np.random.default_rng([case.seed, 7]))
    corners = [(0.0, -_BAY), (size, -_BAY), (size, size), (0.0, size)]
    shapes = [corners, *boxes.tolist()]
    walls = [[*shape[k - 1], *shape[k]] for shape in shapes for k in range(len(shape))]
    return {"segments": walls, "start": [size / 2, -_BAY / 2, 0.0]}


def _by_hand(name, began, touches):
    """Contacts that whoever pushes or turns the robot brings about, not the robot. touches: as of a Result."""
    if began is None or not name.startswith(_HANDLED):
        return 0
    return sum(bool(began <= touch[0] <= began + _HANDLED_S) for touch in touches)


def _figures(case, done, watch):
    health, logs = watch.told()
    fault = done.fault
    began = None if fault is None else fault.fault_at_s
    touched = fault.touched_after if fault else 0
    clean = [one for one in health if began is None or one["uptime"] + _START_S < began]
    heaps = [one["heap"] for one in health if one["uptime"] > _COLLECTED_S]
    name = case.fault or ""
    numbers = {one["fault"] for one in health if one["uptime"] > _SETTLED_S}
    bites = sum(cause == _WDT_RESET for _, cause in watch.resets)
    bad = []
    by_hand = _by_hand(name, began, done.touches)
    if touched > by_hand:
        bad.append(AFTER_FAULT)
    if done.contacts > touched:
        bad.append(CONTACT)
    if not name.startswith(_WANTED):
        if bites:
            bad.append(HANG)
        if numbers & set(_FAILED):
            bad.append("failed: " + ", ".join(logs[-2:]))
    if done.reason.startswith("the firmware") and name.partition("@")[0] != "oe-open-json":
        bad.append(done.reason[:_LONGEST])
    away = np.diff(done.track[:, 1:3], axis=0)
    return {
        "result": done.result,
        "time_s": round(done.time_s, 2),
        "distance_m": round(float(np.hypot(away[:, 0], away[:, 1]).sum()) / 1000, 3),
        "contacts": done.contacts - touched,
        "contacts_after_fault": touched - by_hand,
        "fault_at_s": began,
        "still_ms": fault.still_ms if fault else None,
        "stops": sum(not on for _, on in watch.simulation.electronics.switched),
        "restarts": len(watch.resets),
        "heap": [min(heaps), heaps[0], heaps[-1]] if heaps else None,
        "worst_ms": max((one["worst"] for one in clean), default=None),
        "false_faults": sorted(n for n in numbers if n >= _SCAN) if not name else [],
        "wall_s": round(done.wall_s, 2),
        "bad": bad,
    }
