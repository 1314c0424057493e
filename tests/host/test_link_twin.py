"""The link in the whole firmware, in the twin's own time: driving by hand, stop, what the robot tells."""

import itertools
import math
import struct

import pytest

from host.link import messages
from host.twin import Observer, run
from link import frames as whole_frames
from link import protocol


class Hand(Observer):
    """Sends commands at given times (s) and notes the speed of the body and the messages of the robot."""

    def __init__(self, plan):
        self.plan = sorted(plan, key=lambda item: item[0])
        self.sent = 0
        self.now = 0.0
        self.speeds = []
        self.frames = whole_frames.FrameReader()
        self.messages = []

    def step(self, simulation):
        self.now = simulation.now / 1e6
        vx, vy, w = simulation.body.twist
        self.speeds.append((self.now, math.hypot(vx, vy) + 200 * abs(w)))

    def commands(self):
        data = b""
        while self.plan and self.plan[0][0] <= self.now:
            _, kind, payload = self.plan.pop(0)
            self.sent += 1
            data += whole_frames.frame(kind, payload, self.sent)
        return data

    def serial(self, data):
        for kind, _, payload in self.frames.read(data):
            self.messages.append((self.now, messages.decode(kind, payload)))

    def fastest(self, start, end):
        return max(speed for time, speed in self.speeds if start <= time < end)

    def told(self, kind):
        return [message for _, message in self.messages if message and message["type"] == kind]


def drive(what, af=0, ar=0, v=90):
    return protocol.DRIVE, messages.drive(1, what, af, ar, v)


def test_a_lost_hand_stops_the_robot_within_300_ms():
    held = [(1.0 + 0.08 * k, *drive("manual", v=110)) for k in range(13)]  # the last at 1.96 s
    watch = Hand([(0.5, *drive("stop")), *held])
    run("Z", 620, watch=watch, limit_s=3, record=False)
    assert watch.fastest(0.9, 1.0) < 1
    assert watch.fastest(1.5, 1.96) > 200
    # Stopped is what the motors are told; the wheels run out after it with their own time constant.
    stopped = [time for time, message in watch.messages if message and message["type"] == "decision" and message["state"] == "stopped" and time > 1.9]
    assert 2.15 < stopped[0] < 2.35
    assert watch.fastest(2.7, 3) < 2


@pytest.mark.parametrize("af, ar, mode", [(30, -30, 1), (0, -30, 2), (30, 0, 3), (90, -90, 4), (60, 60, 5)])
def test_five_modes_by_hand(af, ar, mode):
    """Each mode moves the body the way it should; the twin knows nothing of AF and AR."""
    watch = Hand([(0.5, *drive("stop")), *[(0.8 + 0.1 * k, *drive("manual", af, ar, 100)) for k in range(20)]])
    twists = []
    watch.step = lambda simulation, step=watch.step: (step(simulation), twists.append((watch.now, *simulation.body.twist)))
    run("random", gap=900, seed=0, watch=watch, limit_s=2.4, record=False)
    _, vx, vy, w = twists[-1]
    if mode == 4:
        assert w > 0.2 and math.hypot(vx, vy) < 15
    elif mode == 5:
        assert abs(w) < 0.03 and math.degrees(math.atan2(vx, vy)) == pytest.approx(60, abs=3)
    else:
        assert w > 0.05 and vy > 50
    assert watch.told("decision")[-1]["mode"] == mode


def test_stop_and_auto():
    watch = Hand([(1.0, *drive("stop")), (2.0, *drive("auto"))])
    run("Z", 620, watch=watch, limit_s=3, record=False)
    assert watch.fastest(0.9, 1.0) > 100 and watch.fastest(1.5, 2.0) < 2 and watch.fastest(2.5, 3) > 100
    assert [reply["status"] for reply in watch.told("reply")] == ["ok", "ok"]


def test_the_button_on_the_robot_stops_it_until_told_to_go_on():
    watch = Hand([(2.6, *drive("auto"))])
    step = watch.step

    def press(simulation):
        step(simulation)
        simulation.electronics.stop_pressed = 1.0 < watch.now < 1.2

    watch.step = press
    run("Z", 620, watch=watch, limit_s=3.6, record=False)
    assert watch.fastest(0.9, 1.0) > 100 and watch.fastest(1.5, 2.6) < 2 and watch.fastest(3.0, 3.6) > 100
    assert "stopped by its button" in watch.told("log")[0]["text"]


def test_everything_is_told_and_little_is_lost():
    plan = [
        (0.4, protocol.GREET, messages.greet(1, True)),
        (0.5, protocol.LIST, messages.plain(1)),
        (0.6, protocol.TUNE, messages.tune(2, "avoid.margin", 999)),
    ]
    watch = Hand([*plan, (0.7, protocol.TUNE, messages.tune(3, "avoid.margin", 18)), (1.0, protocol.WATCH, messages.watch(4, True, True))])
    run("Z", 620, watch=watch, limit_s=4, record=False)
    for kind in ("hello", "names", "decision", "wheels", "points", "pose", "health", "scan", "candidates", "parameter"):
        assert watch.told(kind), kind
    listed = watch.told("parameter")
    assert len(listed) == listed[0]["of"]
    assert [reply["status"] for reply in watch.told("reply")] == ["ok", "ok", "refused", "ok", "ok"]
    assert "0" in watch.told("reply")[2]["text"] and "avoid.margin" in watch.told("reply")[2]["text"]
    decisions = [(time, message["number"]) for time, message in watch.messages if message and message["type"] == "decision" and time > 0.6]
    lost = [(time, after - before - 1) for (_, before), (time, after) in itertools.pairwise(decisions) if after != before + 1]
    # The list of parameters makes way for decisions. Raw scans take all that the line carries: while one is on its way, an eighth of a second, a second decision is lost.
    assert len(decisions) > 20 and all(time > 1.1 and count <= 2 for time, count in lost), lost
    points = watch.told("points")[-1]
    assert len(points["x"]) == len(points["y"]) == len(points["window"]) > 20
    scan = watch.told("scan")[-1]
    assert 500 < len(scan["distances"]) < 700


def test_what_the_chip_spends_its_turns_on():
    watch = Hand([(3.5, protocol.WATCH, messages.watch(1, False, False, True)), (5.6, protocol.WATCH, messages.watch(2, False, False))])
    run("Z", 620, watch=watch, limit_s=6.3, record=False, chip=1.0)
    told = watch.told("turns")
    assert len(told) in (3, 4)
    for before, after in zip(told, told[1:]):
        # All of the time is some part's; taking in frames and deciding take more of it than the chips do.
        assert sum(after["sums"]) == pytest.approx(1000 * (after["time"] - before["time"]), rel=0.03)
        share = dict(zip(after["parts"], after["sums"]))
        assert share["planner"] > 20 and share["lidar"] > share["drive"] > 0 == share["screen"] and after["count"] > 30
        assert all(most <= total for most, total in zip(after["most"], after["sums"]))


def test_margins_and_look_ahead_count_from_the_next_start_and_everything_can_be_kept():
    """In the heap of the emulated board, with all that can be watched."""
    tuned = (("windows.look_ahead", 1000), ("avoid.soft_margin", 40), ("avoid.margin", 15), ("servos.trims.2", 0.5), ("drive.cruise", 110))
    plan = [(0.5, protocol.WATCH, messages.watch(1, True, True)), *[(1.0 + 0.5 * k, protocol.TUNE, messages.tune(1, *one)) for k, one in enumerate(tuned)]]
    watch = Hand([*plan, (3.5, protocol.KEEP, messages.plain(1)), (4.0, protocol.LIST, messages.plain(1))])
    run("random", gap=900, seed=0, watch=watch, limit_s=6, record=False)
    assert [reply["status"] for reply in watch.told("reply")] == ["ok"] * 8
    values = {message["key"]: message["value"] for message in watch.told("parameter")}
    assert all(values[key] == value for key, value in tuned)
    assert max(decision["free"] for decision in watch.told("decision")) == 900  # look_ahead of the start
    assert ["next start" in reply["text"] for reply in watch.told("reply")] == [False, True, True, True, False, False, False, False]
    # It stands while the tables are made, and drives on.
    assert watch.fastest(4.5, 6) > 100
    assert [time for time, message in watch.messages if message and message["type"] == "scan"][-1] > 5.5


def test_one_wheel_is_turned_alone_and_only_while_the_robot_stands():
    point = struct.pack(protocol.POINT_FORMAT, 1, 0, 200)
    watch = Hand([(1.0, protocol.POINT, point), (1.2, *drive("stop")), (2.0, protocol.POINT, point)])
    run("Z", 620, watch=watch, limit_s=2.6, record=False)
    assert [reply["status"] for reply in watch.told("reply")] == ["refused", "ok", "ok"]
    assert "must stand" in watch.told("reply")[0]["text"]


def test_it_restarts_when_told_while_it_stands_with_what_was_kept():
    plan = [(1.0, protocol.RESTART, messages.plain(1)), (1.2, *drive("stop")), (1.3, protocol.TUNE, messages.tune(1, "avoid.margin", 22))]
    plan += [(1.5, protocol.KEEP, messages.plain(1)), (2.0, protocol.RESTART, messages.plain(1)), (4.0, protocol.LIST, messages.plain(1))]
    watch = Hand(plan)
    run("Z", 620, watch=watch, limit_s=6, record=False)
    assert [reply["status"] for reply in watch.told("reply")] == ["refused", "ok", "ok", "ok", "ok", "ok"]
    first, last = watch.told("hello")[0], watch.told("hello")[-1]
    assert first["session"] != last["session"] and last["boot"] == "reset"
    assert [row["value"] for row in watch.told("parameter") if row["key"] == "avoid.margin"] == [22]
    assert watch.fastest(1.9, 2.5) < 2
