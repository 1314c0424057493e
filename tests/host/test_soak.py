"""The soak: which cases there are, what is told of one, and that a campaign goes on where it was left."""

import json
from concurrent.futures import Future
from contextlib import contextmanager
from types import SimpleNamespace

import numpy as np
import pytest

from host.experiments import planners
from host.link import messages
from host.soak import cli, execute, plan, report
from host.twin import courses, faults
from host.twin.faults import KINDS, Outcome
from link import frames, protocol


def test_a_case_is_the_same_each_time_and_everything_is_among_them():
    cases = [plan.case(1, number) for number in range(1500)]
    assert cases[:20] == [plan.case(1, number) for number in range(20)] != [plan.case(2, number) for number in range(20)]
    assert {case.course for case in cases} == {*plan.CORRIDORS, "random", plan.ROOM} and {case.mode for case in cases} == {"aws", "naws"}
    assert {case.fault.partition("@")[0] for case in cases if case.fault} == set(KINDS)
    assert 0.4 < sum(case.fault is None for case in cases) / 1500 < 0.6


def test_every_case_can_be_driven():
    for number in range(300):
        case = plan.case(3, number)
        faults.make(case.fault)
        if case.course == plan.ROOM:
            world = execute.room_of(case)
            x, y, _ = world["start"]
            walls = np.array(world["segments"])[4:].reshape(-1, 2, 2)
            assert not len(walls) or np.hypot(*(walls - (x, y)).reshape(-1, 2).T).min() > 330  # the body stands free
        else:
            courses.make(case.course, case.width if case.course != "random" else None, case.gap, case.seed, case.mirror, case.reverse)


def a_case(**more):
    settings = dict(campaign=9, number=1, course="Z", width=600.0, gap=400.0, seed=3, mode="aws", mirror=False, reverse=False, fault=None)
    return plan.Case(**settings | more)


@pytest.fixture
def kept(tmp_path, monkeypatch):
    monkeypatch.setattr(execute, "FOLDER", tmp_path)
    return tmp_path


@pytest.mark.parametrize("fault, restarts", [("hang@6", 1), ("button-short@6", 0)])
def test_what_is_told_of_a_case(kept, fault, restarts):
    told = execute.execute(a_case(fault=fault), planners.snapshot()[1])
    assert told["fault_at_s"] == pytest.approx(6, abs=0.1) and told["still_ms"] < 1500 and told["restarts"] == restarts
    assert told["stops"] >= 1 and 0.1 < told["distance_m"] < 4 and 1 < told["worst_ms"] < 100 and told["heap"][0] > 10000
    assert told["bad"] == [] and not list(kept.iterdir()) and json.loads(json.dumps(told)) == told


def health(fault=0, uptime_s=5.0, heap=60000, worst_us=7000):
    fields = (round(uptime_s * 1000), heap, worst_us, 7400, 132, 3, fault, 0, 0, 0, 0, 0)
    return frames.frame(protocol.HEALTH, messages.struct.pack(protocol.HEALTH_FORMAT, *fields))


def pretend(monkeypatch, said=b"", resets=(), **more):
    """The next case has such a run."""

    def run(*settings, watch, record, fault=None, **others):
        record.write_bytes(b"recording")
        watch.simulation = SimpleNamespace(electronics=SimpleNamespace(switched=[(1.0, True), (2.0, False)]))
        watch.serial(said)
        for reset in resets:
            watch.reset(*reset)
        outcome = Outcome(fault, 4.0, 20.0, more.get("touched", 0), 1.0) if fault else None
        track = np.array([[0.0, 0, 0, 0], [1, 300, 400, 0]])
        found = dict(result="pass", reason="", contacts=0, time_s=20.0, wall_s=1.0, track=track, fault=outcome, touches=[])
        return SimpleNamespace(**found | {key: value for key, value in more.items() if key != "touched"})

    monkeypatch.setattr(execute, "run", run)


@pytest.mark.parametrize(
    "case, run, bad",
    [
        ({}, {}, []),
        ({}, {"contacts": 1}, ["contact"]),
        ({"fault": "slip@4"}, {"contacts": 2, "touched": 1}, ["contact after the fault", "contact"]),
        ({"fault": "pushed@4"}, {"contacts": 1, "touched": 1, "touches": [(4.4, 0, 0, 0)]}, []),
        ({"fault": "pushed@4"}, {"contacts": 1, "touched": 1, "touches": [(6.0, 0, 0, 0)]}, ["contact after the fault"]),
        ({}, {"resets": [(5e6, 3)]}, ["hang"]),
        ({"fault": "reset@4"}, {"resets": [(5e6, 2)]}, []),
        ({"fault": "hang-link@4"}, {"resets": [(5e6, 3)], "said": health(10)}, []),
        ({"fault": "slip@4"}, {"said": health(9)}, ["failed: "]),
        ({}, {"said": health(7)}, ["failed: "]),
        ({}, {"reason": "the firmware stopped: ..."}, ["the firmware stopped: ..."]),
    ],
)
def test_what_went_badly_leaves_a_recording(kept, monkeypatch, case, run, bad):
    pretend(monkeypatch, **run)
    told = execute.execute(a_case(**case), planners.snapshot()[1])
    assert told["bad"] == bad and told["distance_m"] == 0.5 and told["stops"] == 1
    assert bool(list(kept.iterdir())) == bool(bad)


def test_faults_that_are_none_and_the_heap_are_told(kept, monkeypatch):
    said = b"".join(health(fault, at, heap) for fault, at, heap in ((12, 0.5, 70000), (0, 12, 61000), (14, 23, 60000), (0, 34, 60500)))
    pretend(monkeypatch, said=b"noise" + said)
    told = execute.execute(a_case(), planners.snapshot()[1])
    assert told["false_faults"] == [14] and told["heap"] == [60000, 61000, 60500] and told["worst_ms"] == 7


class Instantly:
    def submit(self, function, case, sources):
        future = Future()
        future.set_result(function(case, sources))
        return future


def test_a_campaign_goes_on_where_it_was_left(tmp_path, monkeypatch, capsys):
    numbers = []

    def work(case, sources):
        numbers.append(case.number)
        told = dict(time_s=360.0, distance_m=50.0, contacts=0, contacts_after_fault=case.number == 5, fault_at_s=None, stops=2, restarts=0, heap=[5, 6, 5])
        told |= dict(worst_ms=7.5, false_faults=[], bad=[execute.AFTER_FAULT] if case.number == 5 else [])
        return {"key": case.key(sources), "sources": sources, "case": vars(case)} | told

    @contextmanager
    def executor(cluster, workers):
        yield Instantly()

    monkeypatch.setattr(cli, "execute", work)
    monkeypatch.setattr(cli.campaign, "executor", executor)
    store = ["--store", str(tmp_path / "cases.jsonl"), "--workers", "1", "--check"]
    assert cli.main([*store, "--hours", "0.3"]) == 0 and numbers == [0, 1, 2]
    assert cli.main([*store, "--hours", "0.6"]) == 1 and numbers == [0, 1, 2, 3, 4, 5]
    assert cli.main([*store, "--hours", "0.6"]) == 0 and numbers == [0, 1, 2, 3, 4, 5]
    told = capsys.readouterr().out
    assert "0.60 h in 6 cases" in told and "0.30 km" in told and "case 5 of campaign 1" in told
    assert cli.main([*store, "--hours", "0", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["contacts_after_fault"] == 1


def test_the_report_goes_between_its_marks(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"before\n{report.BEGIN}\nold\n{report.END}\nbehind\n")
    report.write("new", page)
    assert page.read_text() == f"before\n{report.BEGIN}\nnew\n{report.END}\nbehind\n"
    page.write_text("none")
    with pytest.raises(ValueError, match="no place"):
        report.write("new", page)
    assert report.BEGIN in report.PAGE.read_text() and report.END in report.PAGE.read_text()
