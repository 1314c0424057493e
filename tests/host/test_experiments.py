"""The experiments: what is run, what is kept, what is written, and that a cluster gives the same as this machine."""

import json
import signal
import subprocess
import sys
import time
from concurrent.futures import Future
from pathlib import Path

import pytest

from host.experiments import campaign, cli, execute, plan, planners, report, store, tables
from host.twin import process

ROOT = Path(__file__).resolve().parents[2]


def entry(run, result="pass", **more):
    """What `execute` would give."""
    out = {"key": run.key("abc"), "sources": "abc", "result": result, "reason": "", "time_s": 12.5, "contacts": 0, "clearance_mm": 20.0}
    out |= {"best_s": 10.0, "time_over_best": 1.25 if result == "pass" else None, "stops": 3, "reversals": 0, "path_mm": 2900, "steering_deg": 400}
    track = [[i / 10, 300.0, -50.0 + 20 * i, 0.0] for i in range(100)]
    if run.shown:
        out |= {"track": track, "log": [[0.5, 0, 0, 108, 4, 1], [3.0, 20, -30, 104, 4, 2]], "touches": []}
    if run.timed:
        out |= {"chip_ms": [4.0, 12.0, 30.0, 5.0], "here_ms": [0.2] * 4, "slice_ms": 6.0, "measured": 604, "points": [[90, 80], [100, 82]]}
    from dataclasses import asdict

    return json.loads(json.dumps(out | {"run": asdict(run)} | more))


class Instantly:
    """An executor that needs no time."""

    def __init__(self, give):
        self.give = give
        self.runs = []

    def submit(self, function, run, sources):
        self.runs.append(run)
        future = Future()
        try:
            future.set_result(self.give(run))
        except Exception as error:
            future.set_exception(error)
        return future


def test_the_plan_has_every_section_once():
    runs = plan.plan()
    assert len(runs) == len(set(runs))
    for planner, widths in plan.RATE_WIDTHS.items():
        for width in widths:
            seeds = [run.seed for run in runs if (run.planner, run.course, run.width, run.timed) == (planner, "Z", width, False)]
            assert sorted(seeds) == list(range(1, cli.SEEDS + 1)), (planner, width)
    assert [sum(run.shown and run.course in names for run in runs) for names in (("S", "S-sharp"), ("U",), ("random",))] == [3, 5, 6]
    assert sum(run.timed for run in runs) == 8
    assert {run.planner for run in plan.plan(quick=True)} == set(plan.RATE_WIDTHS)


def test_a_broken_off_campaign_goes_on(tmp_path):
    runs = plan.plan(quick=True)
    path = tmp_path / "runs.jsonl"

    def first(run):
        if run == runs[3]:
            raise OSError("the power went")
        return entry(run)

    with pytest.raises(OSError):
        campaign.complete(runs, "abc", store.Store(path), Instantly(first), quiet=True)
    with open(path, "a") as file:
        file.write('{"key": "cut sh')
    again = Instantly(entry)
    done = campaign.complete(runs, "abc", store.Store(path), again, quiet=True)
    assert again.runs == [runs[3]] and len(done) == len(runs)
    assert len(store.Store(path).done) == len(runs)


def test_other_sources_are_run_anew():
    run = plan.Run(plan.AWS, "Z", 500)
    assert run.key("abc") != run.key("abd")


def test_table_3_counts_what_became_of_the_runs():
    runs = [plan.Run(plan.AWS, "Z", 500, seed=seed) for seed in (1, 2, 3)]
    done = {run: entry(run, result) for run, result in zip(runs, ("pass", "local_collision", "timeout"))}
    assert "1 pass, 1 local collision, 1 no pass" in tables.table_3(done)
    assert tables.rates(done) == {plan.AWS: {500: (1, 3)}}


def test_time_over_the_best_by_course_and_size():
    runs = [plan.Run(plan.AWS, "Z", 550, seed=seed) for seed in (1, 2, 3)] + [plan.Run(plan.AWS, "random", gap=300)]
    entries = [entry(runs[0]), entry(runs[1], time_over_best=2.5, reversals=2), entry(runs[2], "timeout"), entry(runs[3], "timeout", best_s=None)]
    rows = tables.ratio_table(dict(zip(runs, entries))).splitlines()[2:]
    assert rows[0].startswith("| Z | 550 | 2/3 | 0 | 10.0 | 1.88 | 2.50 | 1/2 | 3 |")
    assert rows[1].startswith("| random | gaps of 300 | 0/1 | 0 | no way | - | - |")


def test_a_run_brings_its_time_over_the_best():
    run = plan.Run(plan.AWS, "Z", 620)
    found = execute.execute(run, planners.snapshot()[1])
    assert found["result"] == "pass" and 10.5 < found["best_s"] < 11.7
    assert found["time_over_best"] == pytest.approx((found["time_s"] - found["first_motion_s"]) / found["best_s"], abs=2e-3)
    assert 1 < found["time_over_best"] < 3 and 2500 < found["path_mm"] < 4000


def test_decision_times_fall_into_the_papers_classes():
    assert tables.classes([1, 10, 10.1, 20, 20.1]) == pytest.approx((40, 40, 20))


def test_the_report_is_written_with_all_its_pictures(tmp_path):
    done = {run: entry(run) for run in plan.plan(quick=True)}
    report.write(done, "abc", " --quick", tmp_path)
    text = (tmp_path / "results.md").read_text()
    for name in ("pass-rate", "side-by-side", "z", "decision-times", "s", "u", "random"):
        assert f"results/{name}.png" in text
        assert (tmp_path / "results" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert "sources abc" in text and "nan" not in text


@pytest.mark.parametrize("planner", [plan.RULE24, plan.DISC_ROUND, plan.DISC_NARROW])
def test_another_planner_drives_the_same_firmware(planner):
    """In a passage wide enough for all of them."""
    _, sources = planners.snapshot()
    found = execute.execute(plan.Run(planner, "Z", 900, seed=2), sources)
    assert found["decisions"] > 20 and "crashed" not in found["reason"]
    assert found["result"] in ("pass", "local_collision")


def test_a_worker_with_other_sources_says_so():
    with pytest.raises(ValueError, match="same version on every worker"):
        planners.snapshot("000000000000")


def test_a_cluster_gives_the_same_as_this_machine(tmp_path, monkeypatch):
    """Two workers of Dask, through the executor that the campaign uses."""
    monkeypatch.setattr(process, "CHIP", 1.0)  # as in the workers, which know nothing of the tests
    distributed = pytest.importorskip("distributed", reason="dask.distributed is not installed: pip install -e '.[cluster]'")
    _, sources = planners.snapshot()
    runs = [plan.Run(plan.DISC_NARROW, "Z", 450, seed=seed) for seed in (1, 2)]
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=str(tmp_path)) as cluster:
        with campaign.executor(cluster.scheduler_address) as pool:
            there = campaign.complete(runs, sources, store.Store(tmp_path / "there.jsonl"), pool, quiet=True)
    for run, found in there.items():
        here = execute.execute(run, sources)
        assert {**found, "wall_s": 0} == {**here, "wall_s": 0}


def test_no_cluster_is_said_in_words(monkeypatch, capsys, tmp_path):
    pytest.importorskip("distributed", reason="dask.distributed is not installed: pip install -e '.[cluster]'")
    monkeypatch.setattr(campaign, "PATIENCE_S", 1)
    assert cli.main(["--quick", "--cluster", "tcp://127.0.0.1:9", "--store", str(tmp_path / "s.jsonl"), "--out", str(tmp_path)]) == 2
    assert "dask scheduler" in capsys.readouterr().err


def test_ctrl_c_ends_the_runs_that_are_at_work(tmp_path):
    command = [sys.executable, "-m", "host.experiments", "--quick", "--workers", "1", "--store", str(tmp_path / "store"), "--out", str(tmp_path)]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True) as child:
        time.sleep(8)
        child.send_signal(signal.SIGINT)
        began = time.monotonic()
        _, error = child.communicate(timeout=60)
    assert child.returncode == 1 and time.monotonic() - began < 5
    assert "goes on from here" in error and "Traceback" not in error
