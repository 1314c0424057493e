"""The arm's kinematics, dynamics and trajectories: against what they must be by their definition."""

import json
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from host.arm import clearance, dynamics, kinematics, model, scenes, trajectory
from host.arm.errors import ArmError

PAPER = model.load("paper-3r")


def _arm(lengths, masses=None):
    joints = [{"length_mm": 1000 * v, "mass_kg": 1, "low_deg": -360, "high_deg": 360, "speed_deg_s": 180, "torque_nm": 50} for v in lengths]
    arm = model.read({"joints": joints})
    return arm if masses is None else arm.with_masses(masses)


@settings(max_examples=150, deadline=None)
@given(st.lists(st.floats(0.05, 2), min_size=2, max_size=6), st.data())
def test_inverse_undoes_forward(lengths, data):
    arm = _arm(lengths)
    q = np.array(data.draw(st.lists(st.floats(-3, 3), min_size=len(lengths), max_size=len(lengths))))
    x, y, angle = kinematics.pose(arm, q)
    found = kinematics.inverse(arm, x, y, angle)
    assume(found or arm.joints < 4)  # the numeric solution may miss what lies at the rim
    assert found
    for other in found:
        ox, oy, turned = kinematics.pose(arm, other)
        assert math.hypot(ox - x, oy - y) < 1e-6
        assert arm.joints < 3 or abs(math.remainder(turned - angle, 2 * math.pi)) < 1e-9
    if arm.joints in (2, 3):
        assert min(max(abs(math.remainder(a - b, 2 * math.pi)) for a, b in zip(other, q)) for other in found) < 1e-4


def test_both_branches_of_the_papers_poses():
    start = [np.degrees(q) for q in kinematics.inverse(PAPER, *scenes.scene("paper-1").start)]
    assert start[0] == pytest.approx([104.744, -72.025, 67.281], abs=1e-3)
    assert start[1] == pytest.approx([32.719, 72.025, -4.744], abs=1e-3)
    end = kinematics.within(PAPER, kinematics.inverse(PAPER, *scenes.scene("paper-1").end)[0])
    assert np.degrees(end) == pytest.approx([194.744, -72.025, 67.281], abs=1e-3)  # not wrapped to -165


@pytest.mark.parametrize("joints", range(1, 7))
def test_torques_are_lagranges(joints):
    """d/dt dL/dq' - dL/dq, L from positions and speeds alone, by differences."""
    random = np.random.default_rng(joints)
    arm = _arm(random.uniform(0.2, 1.2, joints), random.uniform(0.2, 2, joints))
    q, qd, qdd = random.uniform(-2, 2, (3, joints))

    def lagrangian(q, qd):
        kinetic, potential = dynamics.energy(arm, q, qd)
        return kinetic - potential

    def momentum(q, qd):
        steps = 1e-3 * np.eye(joints)
        return np.array([(lagrangian(q, qd + e) - lagrangian(q, qd - e)) / 2e-3 for e in steps])  # exact: L is quadratic in q'

    h = 1e-4
    rate = (momentum(q + h * qd + h * h / 2 * qdd, qd + h * qdd) - momentum(q - h * qd + h * h / 2 * qdd, qd - h * qdd)) / (2 * h)
    slope = np.array([(lagrangian(q + e, qd) - lagrangian(q - e, qd)) / (2 * h) for e in h * np.eye(joints)])
    found = dynamics.torques(arm, *(np.cumsum(v)[:, None] for v in (q, qd, qdd)))[:, 0]
    assert found == pytest.approx(rate - slope, rel=1e-6, abs=1e-5)
    inertia, coriolis, gravity = dynamics.matrices(arm, q, qd)
    assert found == pytest.approx(inertia @ qdd + coriolis @ qd + gravity, rel=1e-12, abs=1e-12)


def test_energy_stays_in_a_free_swing():
    def state(y):
        inertia, coriolis, gravity = dynamics.matrices(PAPER, y[:3], y[3:])
        return np.concatenate((y[3:], np.linalg.solve(inertia, -coriolis @ y[3:] - gravity)))

    y = np.array([0.4, -0.8, 0.3, 0.0, 1.0, -1.0])
    before = sum(dynamics.energy(PAPER, y[:3], y[3:]))
    h = 0.0005
    least = np.inf
    for _ in range(2000):  # Runge and Kutta's
        k1 = state(y)
        k2 = state(y + h / 2 * k1)
        k3 = state(y + h / 2 * k2)
        k4 = state(y + h * k3)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        least = min(least, dynamics.energy(PAPER, y[:3], y[3:])[1])
    assert sum(dynamics.energy(PAPER, y[:3], y[3:])) == pytest.approx(before, abs=1e-6)
    assert least < before - 10  # it did swing


@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-3, 3), min_size=6, max_size=6))
def test_inertia_is_symmetric_and_its_rate_less_twice_coriolis_skew(values):
    q, qd = np.array(values[:3]), np.array(values[3:])
    h = 1e-5
    inertia, coriolis, _ = dynamics.matrices(PAPER, q, qd)
    rate = (dynamics.matrices(PAPER, q + h * qd, qd)[0] - dynamics.matrices(PAPER, q - h * qd, qd)[0]) / (2 * h)
    skew = rate - 2 * coriolis
    assert np.abs(inertia - inertia.T).max() < 1e-12
    assert np.linalg.eigvalsh(inertia).min() > 0
    assert np.abs(skew + skew.T).max() < 1e-6


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 6), st.integers(1, 3), st.integers(0, 10**6))
def test_trajectories_are_continuous_and_rest_at_both_ends(joints, nodes, seed):
    random = np.random.default_rng(seed)
    start, end = random.uniform(-3, 3, (2, joints))
    genes = np.concatenate((random.uniform(-3, 3, 2 * nodes * joints), random.uniform(1, 8, nodes + 1)))
    angles, speeds, times = trajectory.split(genes[None], joints)
    ends = np.cumsum(times[0])
    state = [np.array(trajectory.at(genes, start, end, t)) for t in (np.array([0.0]), ends[-1:])]
    assert state[0][0, 0] == pytest.approx(start) and state[1][0, 0] == pytest.approx(end, abs=1e-9)
    for one in state:
        assert np.abs(one[1:]).max() < 1e-8
    tiny = 1e-7
    for k, when in enumerate(ends[:-1]):
        before, after = (np.array(trajectory.at(genes, start, end, np.array([when + d])))[:, 0] for d in (-tiny, tiny))
        assert np.abs(before - after).max() < 1e-4
        assert after[0] == pytest.approx(angles[0, k], abs=1e-5) and after[1] == pytest.approx(speeds[0, k], abs=1e-4)
    motion = trajectory.sample(genes, start, end, 8)
    whole = np.array(trajectory.at(genes, start, end, motion.times[0]))
    assert np.abs(np.array([motion.q[0], motion.qd[0], motion.qdd[0]]) - whole.transpose(0, 2, 1)).max() < 1e-6
    h = 1e-4
    middle = np.array([ends[0] / 3])
    q, qd, qdd = (np.array(trajectory.at(genes, start, end, middle + d)) for d in (-h, 0, h))
    assert (qdd[0] - q[0]) / (2 * h) == pytest.approx(qd[1], abs=1e-4)
    assert (qdd[1] - q[1]) / (2 * h) == pytest.approx(qd[2], abs=1e-3)


def _distance(arm, q, *obstacles):
    a = np.cumsum(np.radians(q))[:, None]
    cos, sin = np.cos(a), np.sin(a)
    return float(clearance.least(arm, *clearance.corners(arm, cos, sin), cos, sin, obstacles)[0])


def test_distances_by_hand():
    arm = _arm((1.0, 1.0))
    assert _distance(arm, (0, 90), scenes.Disc(0.5, 0.7, 0.2)) == pytest.approx(0.3)  # from the second link, which stands at x = 1
    assert _distance(arm, (0, 90), scenes.Disc(1.0, 1.5, 0.2)) == pytest.approx(0.3)  # beyond its end
    assert _distance(arm, (0, 90), scenes.Disc(1.05, 0.5, 0.2)) == pytest.approx(-0.15)
    assert _distance(arm, (0, 90), scenes.Box(1.5, 0.5, 0.4, 0.2)) == pytest.approx(0.3)
    assert _distance(arm, (0, 90), scenes.Box(1.1, 0.5, 0.4, 2.0)) == pytest.approx(-0.1)
    assert _distance(arm, (0, 90), scenes.Box(1.5, 1.5, 0.4, 0.4)) == pytest.approx(math.hypot(0.3, 0.3))
    assert _distance(arm, (0, 90), scenes.Box(1.5, 0.5, 0.4, 0.4, math.radians(45))) == pytest.approx(0.5 - 0.2 * math.sqrt(2))
    assert _distance(arm, (0, 90), scenes.HalfPlane(0, 1.2, math.radians(-90))) == pytest.approx(0.2)  # a ceiling
    assert _distance(arm, (0, 90), scenes.HalfPlane(0, 0, math.radians(90))) == pytest.approx(0)  # what it stands on; its first link lies on it
    assert _distance(arm, (90, -90), scenes.HalfPlane(0, 0, math.radians(90))) == pytest.approx(1)
    assert _distance(arm, (90, 180 - 1e-9), scenes.HalfPlane(0, 0.5, math.radians(90))) == pytest.approx(-0.5)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_distance_of_a_box_is_that_of_its_points(seed):
    """Against thousands of points along the links."""
    random = np.random.default_rng(seed)
    arm = _arm((0.6, 0.5))
    q = np.degrees(random.uniform(-3, 3, 2))
    box = scenes.Box(*random.uniform(-1, 1, 2), *random.uniform(0.05, 0.8, 2), random.uniform(-3, 3))
    assume(clearance.distance_of_point(box, 0, 0) > 0.02)
    ends = kinematics.points(arm, np.radians(q)) @ (1, 1j)
    along = np.concatenate([ends[k] + np.linspace(0, 1, 4001) * (ends[k + 1] - ends[k]) for k in range(2)])
    local = (along - complex(box.x, box.y)) * np.exp(-1j * box.angle)
    x, y = np.abs(local.real) - box.width / 2, np.abs(local.imag) - box.height / 2
    distance = (np.hypot(np.maximum(x, 0), np.maximum(y, 0)) + np.minimum(np.maximum(x, y), 0)).min()
    assert _distance(arm, q, box) == pytest.approx(distance, abs=3e-4)


def test_arms_that_come_with_the_project():
    arm = model.load("mt-arm")
    assert (1000 * arm.lengths).tolist() == [298.5, 330, 320] and len(arm.extra) == 2 and len(arm.servos.channels) == 5
    assert PAPER.lengths.tolist() == [1, 1, 0.5] and PAPER.torques.tolist() == [45, 20, 45]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"joints": []}, "1 .. 6"),
        ({"joints": [{"length_mm": 100}]}, "mass_kg = nothing"),
        ({"elbow": 0}, "elbow"),
        ({"colour": 1}, "unknown key colour"),
        ({"name": ""}, "name"),
        ({"servos": {"channels": [1, 1, 2], "rest_deg": [90, 0, 0]}}, "each once"),
        ({"servos": {"channels": [10, 11, 12], "rest_deg": [90, 0, 0]}}, "its servo reaches -90 .. 90"),
        ({"servos": {"channels": [10, 11], "rest_deg": [90, 0, 0]}}, "list of 3"),
    ],
)
def test_an_arm_that_cannot_be_is_refused_with_its_key(change, words, tmp_path):
    path = tmp_path / "arm.json"
    path.write_text(json.dumps(PAPER.source | change))
    with pytest.raises(ArmError, match=words) as caught:
        model.load(path)
    assert str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_arm_files_that_are_none(tmp_path):
    for text, words in (("{", "line 1"), ('{"joints": NaN}', "NaN is no number"), ("[]", "one object")):
        (tmp_path / "arm.json").write_text(text)
        with pytest.raises(ArmError, match=words):
            model.load(tmp_path / "arm.json")
    with pytest.raises(ArmError, match="mt-arm, paper-3r"):
        model.load("none-such")
