"""`python -m host.twin` as a person or a script calls it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from host import recording
from host.twin import cli
from host.twin.console import Progress

ROOT = Path(__file__).resolve().parents[2]
STANDS = "import time\nprint('standing')\nwhile True:\n    time.sleep_ms(50)\n"
# Straight ahead through the registers alone, 400 mm/s; half a second for the servos.
STRAIGHT = """
import machine, time
i2c = machine.I2C(0, scl=machine.Pin(22), sda=machine.Pin(21), freq=400000)
enable = machine.Pin(33, machine.Pin.OUT, value=1)
for address, prescale in ((0x40, 121), (0x41, 5), (0x42, 5)):
    i2c.writeto(address, bytes([0xFE, prescale]))
    i2c.writeto(address, bytes([0x00, 0x21]))
i2c.writeto(0x40, bytes([0x06] + [0, 0, 307 & 255, 307 >> 8] * 10))
enable.value(0)
time.sleep_ms(500)
for address in (0x41, 0x42):
    i2c.writeto(address, bytes([0x06] + [0, 0, 0, 5, 0, 0, 0, 0] * 5))
while True:
    time.sleep_ms(20)
"""
KEYS = {"course", "width_mm", "seed", "mode", "engine", "result", "time_s", "min_clearance_mm", "contacts", "scrub_mm_s", "decisions", "wall_s"}


@pytest.fixture
def twin(tmp_path, capsys):
    """twin(source, *arguments) -> (exit code, standard output, error output)."""

    def call(source, *arguments):
        (tmp_path / "main.py").write_text(source)
        code = cli.main([*arguments, "--firmware", str(tmp_path), "--no-record"])
        return code, *capsys.readouterr()

    return call


def test_json_is_one_object_and_nothing_else(twin):
    code, out, _ = twin(STANDS, "Z", "--width", "580", "--seed", "7", "--mode", "naws", "--json")
    result = json.loads(out)
    assert KEYS <= set(result)
    assert (result["course"], result["width_mm"], result["seed"], result["mode"], result["engine"]) == ("Z", 580, 7, "naws", "micropython")
    assert (result["result"], result["time_s"], result["contacts"], result["decisions"]) == ("timeout", 60, 0, 0)
    assert code == 1


def test_a_run_into_the_wall_is_blocked(twin):
    code, out, _ = twin(STRAIGHT, "Z", "--json")
    result = json.loads(out)
    assert (code, result["result"], result["contacts"]) == (1, "blocked", 1)
    assert -12.1 < result["min_clearance_mm"] < -5
    assert result["time_s"] < 30


def test_through_is_a_pass(twin):
    code, out, _ = twin(STRAIGHT, "random", "--gap", "1500", "--json")  # no box fits with such a gap
    result = json.loads(out)
    assert (code, result["result"], result["contacts"]) == (0, "pass", 0)
    assert result["min_clearance_mm"] > 300


def test_without_json_it_shows_how_it_goes(twin):
    code, out, _ = twin(STRAIGHT + "\n", "Z")
    lines = out.splitlines()
    assert lines[0].split() == ["time", "x", "y", "heading", "clearance", "AF", "AR", "V", "why"] and "mm" in lines[1]
    assert lines[2].split()[:5] == ["0.0", "275", "-50", "0", "150"]
    assert any(line.startswith("Z 550 mm, seed 0, AWS, micropython: blocked") for line in lines)


def test_what_the_firmware_prints_is_shown(twin):
    _, out, _ = twin("import time\nprint('standing')\ntime.sleep_ms(1)\n", "Z")
    assert "firmware: standing" in out


def test_only_text_of_the_firmware_is_shown():
    shown = []
    progress = Progress(shown.append)
    # A binary message may hold the byte that ends a line.
    progress.serial(b"hello\n\xb5\x12\xff\x00\n\xff\n\xe4\xb8")
    progress.serial(b"\n  there\r\n")
    assert [line.strip() for line in shown] == ["firmware: hello", "firmware: there"]


def test_a_crash_shows_its_traceback(twin):
    code, out, _ = twin("import time\ntime.sleep_ms(5)\n1 // 0\n", "Z")
    assert code == 1
    assert "ZeroDivisionError" in out and "blocked" in out
    code, out, _ = twin("1 // 0\n", "Z", "--json")
    assert "ZeroDivisionError" in json.loads(out)["reason"]


def test_a_line_comes_when_the_robot_does_something_else_and_now_and_then():
    from types import SimpleNamespace as Thing

    shown = []
    progress = Progress(shown.append)
    body, contact = Thing(x=0.0, y=0.0, heading=0.0), Thing(clearance=lambda: 100.0)
    for k in range(100):  # ten seconds: something else after three, and again 100 ms later
        why = 1 if k < 30 else 2 if k < 31 else 7
        progress.step(Thing(now=k * 100_000, body=body, contact=contact, decisions=[Thing(why=why, af=300, ar=-55, v=108)]))
    times = [line.split()[0] for line in shown[2:]]
    assert times == ["0.0", "2.0", "3.0", "3.3", "5.3", "7.3", "9.3"]
    assert shown[2].split()[5:9] == ["30", "-6", "108", "way"]


def test_a_picture_marks_where_it_turned_back_and_was_nearest_to_a_wall():
    import numpy as np

    from host.twin import courses, load_config
    from host.twin.picture import reversals, tightest
    from host.twin.vehicle import Vehicle

    y = np.concatenate([np.arange(0, 300, 5), np.arange(300, 100, -5), np.arange(100, 110, 5), np.arange(110, 90, -5), np.arange(90, 500, 5)])
    track = np.column_stack([np.arange(len(y)) / 10, 225 + 0 * y, y, 0 * y])
    assert [int(track[k, 2]) for k in reversals(track)] == [300, 90]  # a push of 10 mm is none
    from types import SimpleNamespace as Thing

    track[70, 1] = 205  # 80 mm from the left wall, 100 from the right one before
    at, place = tightest(Thing(track=track, layout=courses.make("Z", 450), vehicle=Vehicle.from_settings(load_config())))
    assert at == 70 and place[0] == pytest.approx(80)


def test_picture(twin, tmp_path):
    path = tmp_path / "run.png"
    _, out, _ = twin(STRAIGHT, "Z", "--picture", str(path))
    assert path.read_bytes().startswith(b"\x89PNG")
    assert str(path) in out


@pytest.mark.parametrize(
    "arguments, says",
    [
        (["Q"], "courses are Z, U, S"),
        (["Z", "--width", "20"], "260 to 3000"),
        (["Z", "--width", "wide"], "invalid float value"),
        (["Z", "--engine", "pypy"], "'micropython', 'micropython64', 'cpython'"),
        (["Z", "--mode", "4ws"], "'aws', 'naws'"),
        (["Z", "--speed", "0"], "0.01 to 1000 or max"),
        (["Z", "--seed", "-1"], "whole numbers from 0"),
        (["Z", "--config", "missing.json"], "missing.json cannot be read"),
        (["random", "--gap", "5"], "100 to 1500"),
        (["bend", "--angle", "200"], "20 to 120"),
        (["Z", "--picture", "missing/run.png"], "no folder missing"),
        (["Z", "--picture", "run.jpg"], ".png, .svg or .pdf"),
        (["Z", "--picture", "tests"], ".png, .svg or .pdf"),
        (["Z", "--gap", "300"], "a gap is for random"),
        (["random", "--width", "600"], "a width is for the passages"),
        (["Z", "--angle", "60"], "an angle is for the bend"),
        (["Z", "--record", "pyproject.toml"], "exists already"),
        (["Z", "--record", "run.rec", "--no-record"], "not allowed with"),
        ([], "COURSE"),
    ],
)
def test_bad_arguments_say_what_is_accepted(arguments, says, capsys):
    try:
        code = cli.main(arguments)
    except SystemExit as end:
        code = end.code
    out, error = capsys.readouterr()
    assert code == 2
    assert says in error
    assert not out


def test_bad_robot_json_names_the_key(tmp_path, capsys):
    (tmp_path / "robot.json").write_text('{"lidar": {"bawd": 1}}')
    assert cli.main(["Z", "--config", str(tmp_path / "robot.json")]) == 2
    assert "bawd" in capsys.readouterr().err


@pytest.mark.parametrize(
    "robot, says",
    [
        ({"robot": {"width": 1000}}, "1000 mm wide does not fit into Z with its 550 mm"),
        ({"axles": {"first": 700}}, "400 mm ahead of the nose"),
        ({"lidar": {"rx": None}}, "lidar.rx = null: a GPIO is needed"),
        ({"i2c": {"sda": None}}, "i2c.sda = null: a GPIO is needed"),
    ],
)
def test_a_robot_that_cannot_be_is_refused_before_it_drives(robot, says, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sys.modules["host.twin.run"], "Process", None)  # nothing may be started
    (tmp_path / "robot.json").write_text(json.dumps(robot))
    assert cli.main(["Z", "--config", str(tmp_path / "robot.json")]) == 2
    assert says in capsys.readouterr().err


@pytest.mark.parametrize("kind, begins", [("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_a_picture_for_print(twin, tmp_path, kind, begins):
    path = tmp_path / f"run.{kind}"
    twin(STRAIGHT, "Z", "--picture", str(path))
    assert path.read_bytes().startswith(begins)


def test_a_picture_that_fails_does_not_lose_the_result(twin, tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", full)
    code, out, error = twin(STRAIGHT, "random", "--gap", "1500", "--json", "--picture", str(tmp_path / "run.png"))
    assert code == 0 and json.loads(out)["result"] == "pass"
    assert "No space left" in error and error.count("\n") == 1


def test_a_full_disk_ends_the_recording_and_not_the_run(tmp_path):
    (tmp_path / "main.py").write_text(STRAIGHT)
    command = f"ulimit -f 12; exec {sys.executable} -m host.twin random --gap 1500 --json --firmware {tmp_path} --record {tmp_path}/run.rec"
    done = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and json.loads(done.stdout)["result"] == "pass"
    assert "broke off after" in done.stderr and "Traceback" not in done.stderr
    assert list(recording.Reader(tmp_path / "run.rec"))  # what is there can be read


def test_a_full_disk_is_seen_before_the_run(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("shutil.disk_usage", lambda _: SimpleNamespace(free=3_000_000))
    assert cli.main(["Z", "--record", str(tmp_path / "run.rec")]) == 2
    assert "has 3 MB left" in capsys.readouterr().err


def test_whoever_reads_it_may_stop_reading(tmp_path):
    (tmp_path / "main.py").write_text(STRAIGHT)
    command = f"{sys.executable} -m host.twin random --gap 1500 --no-record --firmware {tmp_path} | head -1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr, done.stdout.count("\n")) == (0, "", 1)


def test_ctrl_c_ends_cleanly_with_what_it_has(tmp_path):
    (tmp_path / "main.py").write_text(STANDS)
    command = [sys.executable, "-m", "host.twin", "Z", "--speed", "1", "--json", "--no-record", "--firmware", str(tmp_path)]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        time.sleep(1.5)
        os.kill(child.pid, signal.SIGINT)
        out, error = child.communicate(timeout=10)
    result = json.loads(out)
    assert (child.returncode, result["reason"], error) == (1, "interrupted", "")
    assert 0.2 < result["time_s"] < 3
