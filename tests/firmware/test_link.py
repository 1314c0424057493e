"""link.py and commands.py: who may drive, when driving by hand ends, and what the robot tells."""

import gc
import json
import struct
import sys
from array import array

import micropython

from link import protocol, requests
from link.auth import Signer
from link.frames import decode, frame
from link.link import Link
from link.telemetry import Decoder, Encoder, copy
from safety.faults import STOP_BUTTON

SESSION = b"sessions"
KEY = b"k" * 32


class Config:
    lidar_frames = 16
    axles = 1
    servos_trims = array("h", [0, -15])
    live = ("avoid_margin", "b")
    limits = array("h", [0, 100, 0, 2])
    avoid_margin = 15
    b = 1

    def get(self, key):
        return 15


class Steering:
    n = 5
    angles = array("h", range(-5, 5))
    shares = array("h", [16384] * 10)
    folded = 3


class Candidates:
    count = 2
    af = array("h", [100, 300])
    ar = array("h", [0, -300])


class Part:
    """Everything the link reads of the other parts of the robot."""

    decisions = 0
    mode, af, ar, v, window, zone, free, block_x, block_y, why = 1, -300, 300, 108, 4, 1, 512, 10, -20, 2
    points_x = array("H", [8192 + 100, 8192 - 200, 8192 + 300])
    points_y = array("H", [8192 - 1, 8192 + 2, 8192 - 3])
    points_window = bytearray([1, 2, 3])
    points_count = 3
    points_ordered = True
    candidates = Candidates
    free_of = [array("H", [k, k + 10]) for k in range(4)]
    v256 = -4608
    steering = Steering
    x, y, heading = -256, 512, 359999
    ok = True
    speed20 = 120
    frames, errors, speed_faults = 1000, 2, 3
    fault = ""
    battery_low = lost = False
    uptime_ms, heap_free, worst_us, battery_mv = 5000, 60000, 4000, 7400
    stops = told_v256 = 0
    n = 38
    frame_us = 77
    bearings = array("H", range(38))
    distances = array("H", [4000] * 38)

    def stop(self):
        self.stops += 1

    def point(self, wheel, angle):
        return False  # as one that drives


class Safety:
    """What the link asks of safety.Safety; it lets everything drive but under the stop button."""

    state = protocol.AUTO
    fault = 0

    def start(self, state):
        if self.fault != STOP_BUTTON:
            self.state = state
        return self.state == state

    def stop(self):
        self.state = protocol.STOPPED


class Robot:
    took_us = 1234

    def __init__(self):
        self.goal = None
        self.avoid = self.drive = self.odometry = self.lidar = Part()
        self.health = Part()
        self.safety = Safety()
        self.feed = self.keep = bool
        self.note = bytearray(8)
        self.is_off = False

    def off(self):
        self.is_off = True


class Settings:
    """What requests.py makes of a config, a drive and what was changed; writes down what it is asked."""

    tuned = None

    def __init__(self, config, drive, changed):
        pass

    def tune(self, key, value):
        if key != "avoid.margin":
            raise ValueError("unknown key %s" % key)
        self.tuned.append((key, value))
        return "counts from the next start"

    def keep(self):
        self.tuned.append("kept")

    def point(self, wheel, angle):
        self.tuned.append((wheel, angle))


class Line:
    """A carrier in memory."""

    def __init__(self, signed=False):
        self.signed = signed
        self.decoder = Decoder(200)
        self.out = bytearray(60_000)
        self.used = 0
        self.waiting = b""
        self.full = self.fails = False
        self.announced = 0
        self.answered = 0
        self.valid = 0
        self.shunned = 0

    def update(self, now_us):
        pass

    def take(self, now_us):
        if self.decoder.take():
            return True
        while self.waiting:
            byte = self.waiting[0]
            self.waiting = self.waiting[1:]
            if self.decoder.add(byte):
                return True
        return False

    def send(self, encoder):
        if self.fails:
            return False
        copy(encoder.data, 0, encoder.size, self.out, self.used)
        self.used += encoder.size
        return True

    def announce(self, encoder):
        self.announced += 1

    def idle(self):
        return not self.full

    def heard(self, now_us):
        self.valid += 1

    def shun(self, now_us):
        self.shunned += 1

    def answer(self, encoder):
        self.answered += 1
        self.send(encoder)

    def close(self):
        pass

    def receive(self, data):
        self.waiting += data

    def sent(self):
        found = decode(bytes(self.out[: self.used]))
        self.used = 0
        return found


def make(signed=False, key=KEY, others=()):
    line = Line(signed)
    requests.Settings = Settings
    sys.modules["link.requests"] = requests  # a link before may have let it go
    robot = Robot()
    robot.tuned = Settings.tuned = []
    link = Link(Config(), b'{"firmware": "1"}', Encoder(), [line] + list(others), SESSION, robot.safety, key and Signer(key))
    return link, line, robot


def drive(counter, what, af=0, ar=0, v=90):
    return frame(protocol.DRIVE, struct.pack(protocol.DRIVE_FORMAT, counter, what, af, ar, v))


def sign(plain, key=KEY, session=SESSION):
    kind, sequence, payload = decode(plain)[0]
    body = struct.pack("<BBHH", 1, kind, sequence, len(payload) + 8) + payload
    return frame(kind, payload + Signer(key).tag(session, body), sequence)


def run(link, line, robot, start=0, stop=1_000_000, step=5000):
    """Messages sent between two times, as {type: [payload]}."""
    for now in range(start, stop, step):
        link.update(now, robot)
    kinds = {}
    for kind, _, payload in line.sent():
        kinds.setdefault(kind, []).append(payload)
    return kinds


def test_everything_due_is_told():
    link, line, robot = make()
    robot.avoid.decisions = 7
    kinds = run(link, line, robot)
    hello = kinds[protocol.HELLO][0]
    assert struct.unpack_from(protocol.HELLO_FORMAT, hello) == (SESSION, 0, bytes(8)) and json.loads(hello[20:]) == {"firmware": "1"}
    assert protocol.NAMES not in kinds  # only who asks gets them
    decision = struct.unpack(protocol.DECISION_FORMAT, kinds[protocol.DECISION][0])
    assert decision[0] == 7 and decision[2:] == (protocol.AUTO, 1, -300, 300, 108, 4, 1, 512, 10, -20, 2, 1234)
    assert 18 <= len(kinds[protocol.WHEELS]) <= 20 and len(kinds[protocol.HEALTH]) == 2
    wheels = kinds[protocol.WHEELS][0]
    assert struct.unpack_from(protocol.WHEELS_FORMAT, wheels)[1:] == (-300, 300, -4608, 3, 10)
    assert struct.unpack_from("<20h", wheels, 15) == tuple(range(-5, 5)) + (16384,) * 10
    assert struct.unpack_from("<3h3h3B", kinds[protocol.POINTS][0], 6) == (100, -200, 300, -1, 2, -3, 1, 2, 3)
    assert struct.unpack(protocol.POSE_FORMAT, kinds[protocol.POSE][0])[1:] == (-256, 512, 359999)
    health = struct.unpack(protocol.HEALTH_FORMAT, kinds[protocol.HEALTH][0])
    assert health == (5000, 60000, 4000, 7400, 120, 3, 0, 1000, 2, 3, 0, 0)


def test_one_decision_is_told_once():
    link, line, robot = make()
    robot.avoid.decisions = 1
    assert len(run(link, line, robot)[protocol.DECISION]) == 1


def test_the_payloads_are_those_of_the_protocol():
    link, line, robot = make()
    robot.avoid.decisions = 1
    line.receive(frame(protocol.WATCH, b"\1\0\0\0\3"))
    kinds = run(link, line, robot)
    for kind, form, behind in (
        (protocol.DECISION, protocol.DECISION_FORMAT, 0),
        (protocol.WHEELS, protocol.WHEELS_FORMAT, 40),
        (protocol.POINTS, protocol.POINTS_FORMAT, 15),
        (protocol.HEALTH, protocol.HEALTH_FORMAT, 0),
        (protocol.POSE, protocol.POSE_FORMAT, 0),
        (protocol.CANDIDATES, protocol.CANDIDATES_FORMAT, 12),
        (protocol.REPLY, protocol.REPLY_FORMAT, 0),
        (protocol.HELLO, protocol.HELLO_FORMAT, 17),
    ):
        assert len(kinds[kind][0]) == struct.calcsize(form) + behind, kind


def test_decisions_passed_over_and_frames_not_taken_are_counted():
    link, line, robot = make()
    robot.avoid.decisions = 5
    run(link, line, robot, 0, 100_000)
    line.full = True
    robot.avoid.decisions = 9
    run(link, line, robot, 100_000, 200_000)
    line.full = False
    run(link, line, robot, 200_000, 300_000)
    assert link.dropped == 3
    line.fails = True
    run(link, line, robot, 300_000, 1_000_000)
    assert link.dropped > 20


def test_a_long_message_takes_three_turns():
    link, line, robot = make()
    robot.avoid.decisions = 1
    sent = [0, 0, 0]
    for now in range(0, 1_000_000, 1000):
        sent.append(line.used)
        link.update(now, robot)
        if line.used > sent[-1] and line.out[sent[-1] + 3] == protocol.POINTS:
            assert sent[-3] == sent[-1]  # nothing went out in the two turns before
            return
    raise AssertionError("no points were sent")


def test_a_long_message_is_not_sealed_while_a_command_comes_in():
    link, line, robot = make()
    robot.avoid.decisions = 1
    run(link, line, robot, 0, 100_000)
    robot.avoid.decisions = 2
    line.receive(frame(protocol.LIST, b"\4\0\0\0")[:9])
    assert protocol.POINTS not in run(link, line, robot, 200_000, 300_000)
    line.receive(frame(protocol.LIST, b"\4\0\0\0")[9:])
    assert protocol.POINTS in run(link, line, robot, 300_000, 400_000)


def test_driving_by_hand_ends_within_300_ms():
    link, line, robot = make()
    assert link.state == protocol.AUTO
    line.receive(drive(1, protocol.MANUAL, -100, 200, 120))
    link.update(0, robot)
    assert (link.state == protocol.MANUAL, link.af, link.ar, link.v) == (True, -100, 200, 120)
    link.update(200_000, robot)
    assert link.state == protocol.MANUAL
    line.receive(drive(2, protocol.MANUAL, 0, 0, 120))
    link.update(240_000, robot)
    link.update(485_000, robot)
    assert link.state == protocol.MANUAL
    link.update(500_000, robot)
    assert link.state == protocol.STOPPED and link.v == 90
    line.receive(drive(3, protocol.AUTO))
    link.update(600_000, robot)
    assert link.state == protocol.AUTO


def test_stop_stays_stop():
    link, line, robot = make()
    line.receive(drive(1, protocol.STOPPED))
    run(link, line, robot)
    assert link.state == protocol.STOPPED


def test_a_hand_that_was_stopped_has_to_let_go_first():
    link, line, robot = make()
    line.receive(drive(1, protocol.MANUAL, 0, 0, 120))
    link.update(0, robot)
    link.stop()
    for k in range(1, 20):
        line.receive(drive(1 + k, protocol.MANUAL, 0, 0, 120))
        link.update(k * 80_000, robot)
        assert link.state == protocol.STOPPED
    line.receive(drive(30, protocol.MANUAL, 0, 0, 120))
    link.update(20 * 80_000 + 200_000, robot)
    assert link.state == protocol.MANUAL


def test_a_hand_that_comes_back_after_many_minutes_is_heard():
    for minutes in (5, 9, 12, 17):
        link, line, robot = make()
        line.receive(drive(1, protocol.MANUAL, 0, 0, 120))
        link.update(0, robot)
        link.stop()
        line.receive(drive(2, protocol.MANUAL, 0, 0, 120))
        link.update(minutes * 60_000_000 % 2**30, robot)
        assert link.state == protocol.MANUAL


def test_what_was_told_many_minutes_ago_is_due():
    for minutes in (5, 9, 12, 17):
        link, line, robot = make(signed=True)
        for now, answered in ((0, 1), (minutes * 60_000_000 % 2**30, 2)):
            line.receive(frame(protocol.GREET, b"\1\0\0\0\1"))
            link.update(now, robot)  # here the hello to all is due as well, and comes first
            link.update(now + 1000, robot)
            assert line.answered == answered


def test_the_stop_button_is_told_once_and_refuses_to_let_it_drive():
    link, line, robot = make()
    robot.safety.fault = STOP_BUTTON
    robot.safety.stop()  # as safety does
    assert len(run(link, line, robot, 0, 500_000)[protocol.LOG]) == 1
    status, text = reply_to(link, line, robot, drive(5, protocol.AUTO))
    assert status == protocol.REFUSED and "button" in text and link.state == protocol.STOPPED
    robot.safety.fault = 0
    assert reply_to(link, line, robot, drive(6, protocol.AUTO))[0] == protocol.OK and link.state == protocol.AUTO


def test_one_hand_at_a_time():
    other = Line(False)
    link, line, robot = make(others=(other,))
    line.receive(drive(1, protocol.MANUAL, 0, 0, 120))
    link.update(0, robot)
    other.receive(drive(2, protocol.MANUAL, 0, 0, 60))
    link.update(100_000, robot)
    assert link.v == 120 and link.refused == 1
    other.receive(drive(3, protocol.STOPPED))  # which anybody may
    link.update(200_000, robot)
    assert link.state == protocol.STOPPED
    other.receive(drive(4, protocol.MANUAL, 0, 0, 60))
    link.update(500_000, robot)
    assert link.state == protocol.MANUAL and link.v == 60


def reply_to(link, line, robot, data):
    """(status, text) of the reply to a command."""
    line.receive(data)
    (reply,) = run(link, line, robot, 0, 50_000)[protocol.REPLY]
    return reply[5], bytes(reply[6:]).decode()


def test_what_cannot_be_is_refused_with_a_text():
    link, line, robot = make()
    status, text = reply_to(link, line, robot, drive(5, protocol.MANUAL, 1000, 0, 120))
    assert status == protocol.REFUSED and "AF 1000" in text
    for payload in (b"\1\0\0\0", b"\1\0\0\0avoid.margin", b"\1\0\0\0avoid.margin=x", b"\1\0\0\0other=1"):
        status, text = reply_to(link, line, robot, frame(protocol.TUNE, payload))
        assert status == protocol.REFUSED and text
    for data in (drive(6, 9), frame(protocol.DRIVE, b"\1\0\0\0")):
        assert reply_to(link, line, robot, data)[0] == protocol.REFUSED
    assert robot.tuned == [] and link.state == protocol.AUTO


def test_names_are_told_to_who_asks():
    link, line, robot = make()
    run(link, line, robot)
    assert robot.drive.stops == 0
    line.receive(frame(protocol.GREET, b"\1\0\0\0\1"))
    (names,) = run(link, line, robot)[protocol.NAMES]
    assert robot.drive.stops  # the motors are off while code is loaded
    assert len(json.loads(names)["reasons"]) > 10 and len(json.loads(names)["faults"]) > 4


def test_what_finds_no_memory_is_said_and_the_robot_goes_on():
    def no_room(now_us, robot, name=""):
        raise MemoryError

    link, line, robot = make()
    rare, link.rare = link.rare, no_room
    line.receive(frame(protocol.GREET, b"\1\0\0\0\1") + frame(protocol.LIST, b"\2\0\0\0"))
    told = run(link, line, robot)
    assert protocol.NAMES not in told and protocol.PARAMETER not in told and len(told[protocol.WHEELS]) > 10
    assert any("no memory" in str(bytes(text), "utf-8") for text in told[protocol.LOG])
    assert "no memory" in reply_to(link, line, robot, frame(protocol.TUNE, b"\3\0\0\0drive.cruise=100"))[1]
    link.rare = rare
    line.receive(frame(protocol.GREET, b"\4\0\0\0\1"))
    assert protocol.NAMES in run(link, line, robot)


class Machine:
    """The module machine."""

    resets = 0

    @classmethod
    def reset(cls):
        cls.resets += 1


def test_it_restarts_only_while_it_stands_and_after_the_reply():
    sys.modules["machine"] = Machine
    link, line, robot = make()
    status, text = reply_to(link, line, robot, frame(protocol.RESTART, b"\1\0\0\0"))
    assert status == protocol.REFUSED and "stop" in text and not link.restarting
    robot.drive.v256 = 0
    line.receive(frame(protocol.RESTART, b"\2\0\0\0"))
    link.update(100_000, robot)
    link.update(200_000, robot)
    assert Machine.resets == 0 and link.state == protocol.STOPPED
    assert [payload[5] for kind, _, payload in line.sent() if kind == protocol.REPLY] == [protocol.OK]
    link.update(400_000, robot)
    assert Machine.resets == 1 and robot.is_off


def test_what_counts_from_the_next_start_is_said():
    link, line, robot = make()
    status, text = reply_to(link, line, robot, frame(protocol.TUNE, b"\1\0\0\0avoid.margin=20"))
    assert status == protocol.OK and text == "counts from the next start"
    line.receive(frame(protocol.LIST, b"\2\0\0\0"))
    rows = [json.loads(payload) for payload in run(link, line, robot)[protocol.PARAMETER]]
    assert [row["restart"] for row in rows] == [True, False, False, False]


def test_tune_keep_point_and_list():
    link, line, robot = make()
    line.receive(frame(protocol.TUNE, b"\1\0\0\0avoid.margin=20") + frame(protocol.KEEP, b"\2\0\0\0"))
    robot.drive.v256 = 0
    line.receive(frame(protocol.POINT, struct.pack(protocol.POINT_FORMAT, 3, 4, -25)) + frame(protocol.LIST, b"\4\0\0\0"))
    kinds = run(link, line, robot)
    assert robot.tuned == [("avoid.margin", 20), "kept", (4, -25)]
    parameters = [json.loads(payload) for payload in kinds[protocol.PARAMETER]]
    assert [row["key"] for row in parameters] == ["avoid.margin", "b", "servos.trims.0", "servos.trims.1"]
    assert parameters[0]["high"] == 100 and parameters[3]["value"] == -1.5 and parameters[0]["of"] == 4


def test_scans_on_request():
    link, line, robot = make()
    for _ in range(20):
        link.frame(robot.lidar)
    assert protocol.SCAN not in run(link, line, robot)
    line.receive(frame(protocol.WATCH, b"\1\0\0\0\1"))
    link.update(1_000_000, robot)
    for _ in range(16):
        link.frame(robot.lidar)
    (scan,) = run(link, line, robot, 1_000_000, 2_000_000)[protocol.SCAN]
    assert len(scan) == 16 * (9 + 2 * 38)
    assert struct.unpack_from(protocol.SCAN_FORMAT, scan) == (77, 0, 37, 38)


def test_candidates_on_request():
    link, line, robot = make()
    line.receive(frame(protocol.WATCH, b"\1\0\0\0\2"))
    rows = run(link, line, robot)[protocol.CANDIDATES]
    assert len(rows) == 4
    left, right = rows[:2]
    assert struct.unpack_from("<BBB4h2H", left, 4) == (1, 1, 2, 100, 300, 0, -300, 1, 11)
    assert struct.unpack_from("<BBB", right, 4) == (0, 255, 2)


def test_what_turns_are_spent_on_is_told_on_request():
    from link import turns

    link, line, robot = make()
    kept = []
    robot.keep = keep = kept.append
    now = [1000]
    turns.ticks_us, before = lambda: now[0], turns.ticks_us
    try:
        line.receive(frame(protocol.WATCH, b"\1\0\0\0\4"))
        link.update(1_000_000, robot)
        assert robot.keep is not keep
        for part, spent in ((1, 300), (4, 50), (1, 700), (2, 2000), (1, 0)):
            robot.keep(bytes((71, 83, part, 0)))
            now[0] += spent
        told = run(link, line, robot, 1_000_000, 1_900_000)[protocol.TURNS]
        count, *values = struct.unpack(protocol.TURNS_FORMAT, told[0])[1:]
        assert count == 3 and values == [0, 0, 1000, 700, 2000, 2000, 0, 0, 50, 50, 0, 0]
        assert [note[2] for note in kept] == [1, 4, 1, 2, 1]
        # Told anew each time; and as it was once nobody asks any more.
        assert not any(struct.unpack(protocol.TURNS_FORMAT, told[1])[1:])
        line.receive(frame(protocol.WATCH, b"\2\0\0\0\0"))
        link.update(2_000_000, robot)
        assert robot.keep is keep and protocol.TURNS not in run(link, line, robot, 2_000_000, 3_000_000)
    finally:
        turns.ticks_us = before


def test_what_is_told_once_waits_for_room():
    link, line, robot = make()
    line.full = True
    line.receive(frame(protocol.LIST, b"\4\0\0\0") + frame(protocol.GREET, b"\5\0\0\0\1"))
    link.log(0, "hello")
    run(link, line, robot)
    line.full = False
    kinds = run(link, line, robot, 1_000_000, 1_200_000)
    assert len(kinds[protocol.REPLY]) == 2 and len(kinds[protocol.LOG]) == len(kinds[protocol.NAMES]) == 1
    assert len(kinds[protocol.PARAMETER]) == 4


def test_log_lines():
    link, line, robot = make()
    link.log(1, "battery low")
    assert run(link, line, robot)[protocol.LOG] == [b"\1battery low"]


def test_signed_commands_only():
    link, line, robot = make(signed=True)
    for data in (
        drive(1, protocol.STOPPED),
        sign(drive(2, protocol.STOPPED), key=b"x" * 32),
        sign(drive(3, protocol.STOPPED), session=b"another."),
        sign(drive(4, protocol.STOPPED))[:-3] + b"123",
    ):
        line.receive(data)
        link.update(0, robot)
        assert link.state == protocol.AUTO and line.valid == 0
    line.receive(sign(drive(5, protocol.STOPPED)))
    link.update(0, robot)
    assert link.state == protocol.STOPPED and line.valid == 1


def test_a_repeated_command_moves_nothing_but_an_old_stop_stops():
    link, line, robot = make(signed=True)
    stop, go = sign(drive(1, protocol.STOPPED)), sign(drive(2, protocol.AUTO))
    line.receive(go)
    link.update(0, robot)
    line.receive(stop)
    link.update(0, robot)
    assert link.state == protocol.STOPPED
    line.receive(go)
    link.update(0, robot)
    assert link.state == protocol.STOPPED and line.valid == 1


class CountingSigner(Signer):
    checked = 0

    def signed(self, session, covered, tag):
        self.checked += 1
        return super().signed(session, covered, tag)


def test_the_tag_is_looked_at_last_as_it_takes_longest():
    link, line, robot = make(signed=True)
    link.signer = signer = CountingSigner(KEY)
    line.receive(sign(drive(5, protocol.AUTO)))
    link.update(0, robot)
    assert signer.checked == 1 and line.shunned == 0 and link.state == protocol.AUTO
    cheap = (frame(0x40, bytes(12)), frame(0x4F, bytes(12)), frame(protocol.DRIVE, bytes(11)), sign(drive(5, protocol.AUTO)), sign(drive(4, protocol.MANUAL)))
    for k, data in enumerate(cheap):
        line.receive(data)
        link.update(5000 * (k + 1), robot)
        assert signer.checked == 1 and link.refused == k + 1 == line.shunned, k
    line.receive(sign(drive(3, protocol.STOPPED), key=bytes(32)))
    link.update(50_000, robot)
    assert signer.checked == 2 and link.state == protocol.AUTO and line.shunned == 6
    line.receive(sign(drive(3, protocol.STOPPED)))
    link.update(60_000, robot)
    assert signer.checked == 3 and link.state == protocol.STOPPED


def test_at_most_two_datagrams_are_taken_in_a_turn():
    link, line, robot = make(signed=True)
    link.signer = signer = CountingSigner(KEY)
    line.receive(b"".join(sign(drive(counter, protocol.AUTO)) for counter in range(1, 9)))
    for turn in range(1, 5):
        link.update(turn * 5000, robot)
        assert signer.checked == 2 * turn


def test_any_bit_of_a_signed_command_counts():
    good = sign(drive(1, protocol.MANUAL, 10, 20, 120))
    for at in range(len(good)):
        link, line, robot = make(signed=True)
        broken = bytearray(good)
        broken[at] ^= 4
        # even with the check made right again
        kind, sequence, length = struct.unpack_from("<BHH", broken, 3)
        line.receive(bytes(broken))
        line.receive(frame(kind, bytes(broken[8:-2]), sequence))
        link.update(0, robot)
        genuine = 8 <= at < len(good) - 2 or 3 <= at < 6
        assert link.state != protocol.MANUAL or not genuine, at


def test_a_greeting_without_the_session_is_answered_once_a_second():
    link, line, robot = make(signed=True)
    for now in range(0, 1_000_000, 100_000):
        line.receive(frame(protocol.GREET, b"\1\0\0\0\1"))
        link.update(now, robot)
    assert line.answered == 1 and line.valid == 0


def hello_tag(hello, nonce, key=KEY):
    return Signer(key).digest(nonce, bytes((protocol.VERSION, protocol.HELLO)), hello[:12], hello[20:])[:8]


def test_the_answer_to_a_greeting_proves_whose_it_is():
    """Who does not know the session yet is answered, and who knows it; the tag covers all that is told, and the greeting's nonce."""
    for greeting in (frame(protocol.GREET, b"\1\0\0\0\1nonce..1"), sign(frame(protocol.GREET, b"\1\0\0\0\1nonce..1"))):
        link, line, robot = make(signed=True)
        run(link, line, robot, 0, 100_000)
        line.receive(greeting)
        (hello,) = run(link, line, robot, 100_000, 200_000)[protocol.HELLO]
        assert hello[12:20] == hello_tag(hello, b"nonce..1") != hello_tag(hello, b"nonce..2")


def test_a_hello_that_answers_nobody_has_no_tag():
    for greeting in (b"", frame(protocol.GREET, b"\1\0\0\0\1nonce..1")):
        link, line, robot = make(signed=True, key=None)
        line.receive(greeting)
        for hello in run(link, line, robot, 0, 3_000_000)[protocol.HELLO]:
            assert hello[12:20] == bytes(8)


def test_strangers_who_keep_asking_hold_up_nothing():
    link, line, robot = make(signed=True)
    robot.avoid.decisions = 1
    for now in range(0, 1_000_000, 5000):
        line.receive(frame(protocol.GREET, b"\1\0\0\0\1"))
        link.update(now, robot)
    assert protocol.POINTS in [kind for kind, _, _ in line.sent()]


def test_what_should_not_be_missed_is_logged_once():
    link, line, robot = make()
    robot.health.battery_low = True
    robot.drive.fault = "no answer from 0x41"
    logs = [bytes(payload) for payload in run(link, line, robot)[protocol.LOG]]
    assert logs == [b"\2no answer from 0x41", b"\1battery is low: it drives slowly; charge it soon"]


def test_without_a_key_no_signed_command_counts():
    link, line, robot = make(signed=True, key=None)
    line.receive(sign(drive(1, protocol.STOPPED)))
    link.update(0, robot)
    assert link.state == protocol.AUTO


def test_hello_tells_the_counter():
    link, line, robot = make(signed=True)
    line.receive(sign(drive(41, protocol.AUTO)))
    link.update(0, robot)
    hello = run(link, line, robot, 1_000_000, 1_100_000)[protocol.HELLO][0]
    assert struct.unpack_from(protocol.HELLO_FORMAT, hello) == (SESSION, 41, bytes(8)) and line.announced >= 2


def test_telling_allocates_nothing():
    link, line, robot = make()
    line.receive(frame(protocol.WATCH, b"\1\0\0\0\3"))
    for now in range(0, 300_000, 5000):
        link.update(now, robot)
        link.frame(robot.lidar)
    part = robot.avoid
    part.decisions = 1  # an attribute of its own, made before the heap is locked
    run(link, line, robot, 300_000, 3_000_000)  # what was loaded for them is let go
    micropython.heap_lock()
    try:
        now = 3_000_000
        while now < 3_600_000:
            part.decisions += 1
            link.frame(part)
            link.update(now, robot)
            now += 5000
    finally:
        micropython.heap_unlock()
    assert len(line.sent()) > 60


def test_what_is_loaded_when_used_leaves_the_heap_as_it_was():
    link, line, robot = make()
    gc.collect()
    taken = [0] * 12  # the list must not grow itself
    now = 0
    for k in range(12):
        line.receive(frame(protocol.WATCH, b"\1\0\0\0\3") + frame(protocol.LIST, b"\2\0\0\0") + frame(protocol.GREET, b"\3\0\0\0\1"))
        for _ in range(20):
            now += 5000
            link.update(now, robot)
            link.frame(robot.lidar)
        line.receive(frame(protocol.WATCH, b"\4\0\0\0\0"))
        run(link, line, robot, now, now + 4_000_000, 50_000)
        now += 4_000_000
        gc.collect()
        taken[k] = gc.mem_alloc()
    # What a word on the stack happens to look like keeps a dead object now and then; what really stayed would be there in each later round.
    assert min(taken[7:]) == min(taken[2:7]), taken
