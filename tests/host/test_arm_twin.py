"""The arm through the whole firmware: commands as bytes on the line, the servos' chip as registers, the arm's servos behind them."""

import json
import math

import numpy as np
import pytest

from host.arm import board, kinematics, model, reach, rehearse, scenes
from host.arm.errors import ArmError
from host.twin import Observer, run
from host.twin.arm import Arm as Servos
from host.twin.check import check as look_over

PAPER = model.load("paper-3r")
# Plans for the paper's two experiments: start, node, end; as `python -m host.arm plan` writes them
NODE = {
    "paper-1": (1.2123, (136.6, -108.2, 67.3), (62.7, -42.1, 0.0)),
    "paper-2": (1.2100, (136.5, -108.0, 67.3), (62.5, -42.0, 0.0)),
}


def _plan(name):
    """A trajectory of experiment I or II from what a person would write down of it: the node's angles and speeds, without accelerations."""
    scene = scenes.scene(name)
    ends = [kinematics.within(PAPER, kinematics.inverse(PAPER, *pose)[0]) for pose in (scene.start, scene.end)]
    when, angles, speeds = NODE[name]
    q = np.array([ends[0], np.radians(angles), ends[1]])
    qd = np.radians([(0, 0, 0), speeds, (0, 0, 0)])
    return reach.from_points(PAPER, scene.obstacles, (0, when, 3.9), q, qd)


@pytest.mark.parametrize("name", ["paper-1", "paper-2"])
def test_the_servos_follow_both_experiments_within_a_degree(name):
    played = rehearse.rehearse(_plan(name))
    assert len(played.times) > 150 and np.ptp(played.angles[:, 0]) > 80  # it moved
    assert played.rms <= 1.0
    assert np.abs(played.angles[-1] - played.wanted[-1]).max() < 1.0
    assert played.overloaded == ()


def test_a_servo_that_is_too_weak_gives_way():
    whole = reach.as_dict(_plan("paper-1"))
    for joint in whole["arm"]["joints"]:
        joint["torque_nm"] = 5
    played = rehearse.rehearse(reach.from_dict(json.loads(json.dumps(whole))))
    assert 0 in played.overloaded and played.rms > 5


class _Interferes(rehearse.Stage):
    """As the rehearsal, but one second into the play something happens."""

    def __init__(self, plan, what):
        super().__init__(plan)
        self._what = what
        self._acted = None
        self.frozen = None
        self.later = None

    def _plays(self):
        """The end of the playing is not the end of this."""

    def step(self, simulation):
        super().step(simulation)
        if self.began_us is None:
            return
        if self._acted is None and simulation.now - self.began_us > 1e6:
            self._acted = simulation.now
            if self._what == "button":
                simulation.electronics.stop_pressed = True
            elif self._what == "silence":
                self._counter = 0  # from now on nothing is said
        if self._acted is not None:
            for name, after in (("frozen", 0.7e6), ("later", 1.7e6)):
                if getattr(self, name) is None and simulation.now - self._acted > after:
                    setattr(self, name, simulation.electronics.arm.angles.copy())
            if self.later is not None:
                simulation.stop("pass", "")


@pytest.mark.parametrize("what", ["button", "silence"])
def test_stop_button_and_a_lost_link_freeze_it_where_it_is(what):
    stage = _Interferes(_plan("paper-2"), what)
    run("Z", changes={"drive.autostart": False}, watch=stage, arm=PAPER.source, limit_s=30, record=False)
    start, end = (np.degrees(q) for q in (_plan("paper-2").q[0], _plan("paper-2").q[-1]))
    assert stage.frozen[0] - start[0] > 10 and end[0] - stage.frozen[0] > 10  # on its way
    assert np.abs(stage.later - stage.frozen).max() < 0.01  # it holds: limp it would fall to its rest pose
    assert "the arm is frozen where it was" in stage.log


class _Registers(Observer):
    def __init__(self):
        self.writes = []

    def registers(self, time, address, data):
        self.writes.append((time, address, bytes(data)))


def test_a_drive_is_byte_for_byte_the_same_with_an_arm_on_the_board():
    """Whole firmware, computing takes no time: every register write and its time."""
    runs = []
    for arm in (None, PAPER.source):
        seen = _Registers()
        run("Z", seed=2, watch=seen, arm=arm, limit_s=6, record=False)
        runs.append(seen.writes)
    assert len(runs[0]) > 300
    assert runs[0] == runs[1]


def test_an_arm_without_room_is_refused_before_a_run():
    other = json.loads(json.dumps(PAPER.source))
    other["servos"]["channels"] = [9, 10, 11]
    with pytest.raises(ValueError, match="output 9 of the servos' chip is a wheel's; free are 10, 11"):
        look_over({"course": "Z", "arm": other})
    look_over({"course": "Z", "arm": PAPER.source})


def test_the_board_refuses_a_trajectory_for_another_arm():
    plan = _plan("paper-1")
    other = json.loads(json.dumps(PAPER.source))
    other["joints"][0]["high_deg"] = 205
    stage = rehearse.Stage(plan)
    run("Z", changes={"drive.autostart": False}, watch=stage, arm=other, limit_s=30, record=False)
    assert "for another arm, or for other limits" in stage.failed


def test_bytes_for_the_board_say_the_same_as_the_plan():
    plan = _plan("paper-2")
    data = board.encode(plan)
    assert data[:4] == b"GR\x01\x03" and len(data) == 8 + 14 * (data[6] | data[7] << 8) + 2
    knots = np.frombuffer(data[8:-2], "<i2").reshape(-1, 7).astype(float)
    times = np.cumsum(knots[:, 0]) / 1000
    q, qd, _ = plan.at(times)
    assert times[-1] == pytest.approx(plan.total, abs=1e-3)
    assert np.abs(knots[:, 1::2] / 100 - np.degrees(q)).max() < 0.04
    assert np.abs(knots[:, 2::2] / 10 - np.degrees(qd)).max() < 0.2
    # what the board makes of it between the knots
    k = np.linspace(0, plan.total, 997)
    i = np.clip(np.searchsorted(times, k, side="right") - 1, 0, len(times) - 2)
    h = (times[i + 1] - times[i])[:, None]
    s = (k - times[i])[:, None] / h
    a, b = knots[i], knots[i + 1]
    cubic = a[:, 1::2] / 100 + (3 * s**2 - 2 * s**3) * (b - a)[:, 1::2] / 100
    cubic += h * ((s**3 - 2 * s**2 + s) * a[:, 2::2] + (s**3 - s**2) * b[:, 2::2]) / 10
    assert np.abs(cubic - np.degrees(plan.at(k)[0])).max() < 0.05


def test_what_the_board_cannot_take_is_said():
    plan = _plan("paper-1")
    with pytest.raises(ArmError, match="no servos"):
        board.encode(reach.from_points(model.read({k: v for k, v in PAPER.source.items() if k != "servos"}), (), plan.times, plan.q, plan.qd))
    with pytest.raises(ArmError, match="8192 is the most"):
        board.encode(reach.from_points(PAPER, (), (0, 50, 100), plan.q, 0 * plan.qd))


def test_a_servo_turns_at_its_rate_and_falls_without_pulses():
    servos = Servos(PAPER.source)
    assert servos.angles.tolist() == [90, 0, 0]
    servos.take_pulses(0, [1500 + (120 - 88.8) * 2000 / 330, 1500, 1500], True)
    servos.advance(50_000)
    assert servos.angles[0] == pytest.approx(90 + 1.25 * 171.9 * 0.05, rel=1e-3)
    servos.advance(1e6)
    assert servos.angles[0] == pytest.approx(120)
    assert servos.holding()[0] == pytest.approx(9.81 * math.cos(math.radians(120)) * (3 + 2 + 0.5))
    servos.take_pulses(1e6, [0, 1500, 1500], True)
    servos.advance(1.1e6)
    assert servos.angles[0] == pytest.approx(120 - 12)
    servos.take_pulses(1.1e6, [1800, 1500, 1500], False)  # output enable is off
    servos.advance(3e6)
    assert servos.angles.tolist() == [90, 0, 0]
