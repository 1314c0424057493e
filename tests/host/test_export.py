"""What is exported is read back with the formats' own readers."""

import csv
import json
import struct
from cmath import rect
from math import atan2, degrees, inf, pi

import pytest

from host.export import __main__ as command_line
from host.export import frames, scans
from host.recording import Decision, Header, Pose, Stream, Writer
from link import frames as whole_frames
from link import protocol

REASONS = ("waiting", "way ahead is free")
ROBOT = json.dumps({"robot": {"width": 250, "length": 600}, "lidar": {"x": 10, "y": 20}})
POINTS = 38
TELEMETRY = [
    whole_frames.frame(protocol.POINTS, struct.pack("<IH2h2hBB", 5, 2, -125, 1000, 300, 0, 2, 4)),
    whole_frames.frame(protocol.POSE, struct.pack(protocol.POSE_FORMAT, 5, 256 * 100, 256 * 200, 90_000)),
    whole_frames.frame(protocol.LOG, b"\x02" + "zu heiß".encode()),
    whole_frames.frame(protocol.DECISION, struct.pack(protocol.DECISION_FORMAT, 7, 5, 1, 1, 0, 0, 99, 0, 255, 0, 32767, 32767, 0, 0)),
]


def lidar_frame(start: int, distance) -> bytes:
    """A Delta frame from `start` deg on; distance(bearing) in mm."""
    points = b""
    for n in range(POINTS):
        mm = distance(start + 22.5 * n / POINTS)
        points += struct.pack(">BH", 50 if mm else 0, round(mm * 4))
    body = struct.pack(">BHBBBHBhH", 0xAA, 13 + len(points), 1, 0x61, 0xAD, 5 + len(points), 123, 0, round(start * 100)) + points
    return body + struct.pack(">H", sum(body) & 0xFFFF)


def wall_on_the_right(bearing: float) -> float:
    """1 m at 80 to 100 deg, 3 m at 180 to 270, nothing elsewhere."""
    return 1000 if 80 <= bearing < 100 else 3000 if 180 <= bearing < 270 else 0


def write(path, decisions=True, clock="robot"):
    with Writer(path, Header("1.0", ROBOT, "twin:z?width=550", clock, REASONS)) as writer:
        writer.write(Stream.POSE, 0, Pose(300, -50, 0).pack())
        for turn in range(2):
            for sector in range(16):
                data = lidar_frame(22.5 * sector, wall_on_the_right)
                writer.write(Stream.LIDAR, turn * 160_000 + sector * 10_000, data[:50])
                writer.write(Stream.LIDAR, turn * 160_000 + sector * 10_000 + 2_000, data[50:])
        for data in TELEMETRY:
            writer.write(Stream.TELEMETRY, 400_000, b"text between " + data)
        writer.write(Stream.POSE, 450_000, Pose(1500, 700, 90).pack())
        if decisions:
            writer.write(Stream.DECISION, 500_000, Decision(3, -120, 60, 108, 4, 3, 9, 650, -20, 310, 1).pack())
            writer.write(Stream.DECISION, 540_000, Decision(4, 0, 0, 90, 4, 0, 255, 0, 32767, 32767, 0).pack())
        writer.event(600_000, "touched a wall")
    return path


@pytest.fixture
def exported(tmp_path):
    """The messages of the exported MCAP file, {topic: [(time ns, schema, message)]}, and its reader's extras."""
    make_reader = pytest.importorskip("mcap.reader", reason="needs the extra [export]").make_reader
    factory = pytest.importorskip("mcap_protobuf.decoder", reason="needs the extra [export]").DecoderFactory

    assert command_line.main([str(write(tmp_path / "a.rec")), str(tmp_path / "a.mcap")]) == 0
    topics = {}
    with open(tmp_path / "a.mcap", "rb") as file:
        reader = make_reader(file, decoder_factories=[factory()])
        for schema, channel, message in reader.iter_messages():
            decoded = json.loads(message.data) if channel.message_encoding == "json" else factory().decoder_for("protobuf", schema)(message.data)
            topics.setdefault(channel.topic, []).append((message.log_time, schema.name, decoded))
        topics["metadata"] = [dict(record.metadata) for record in reader.iter_metadata()]
        topics["attachments"] = {record.name: record.data for record in reader.iter_attachments()}
    return topics


def test_scans(exported):
    scan_messages = exported["/scan"]
    assert len(scan_messages) == 2
    time, schema, scan = scan_messages[0]
    assert (time, schema) == (77_000_000, "foxglove.LaserScan")  # the middle of a revolution of 152 ms
    assert scan.timestamp.ToNanoseconds() == time
    assert scan.frame_id == "body"
    assert (scan.pose.position.x, scan.pose.position.y) == pytest.approx((0.02, -0.01))  # 20 mm forward, 10 mm right
    assert len(scan.ranges) == 16 * POINTS
    step = (scan.end_angle - scan.start_angle) / (len(scan.ranges) - 1)
    near = [degrees(scan.start_angle + step * i) for i, r in enumerate(scan.ranges) if r == pytest.approx(1.0)]
    far = [degrees(scan.start_angle + step * i) % 360 for i, r in enumerate(scan.ranges) if r == pytest.approx(3.0)]
    # the right is at -90, the left rear quarter at 90 to 180
    assert min(near) == pytest.approx(-100, abs=1.2) and max(near) == pytest.approx(-80, abs=1.2)
    assert min(far) == pytest.approx(90, abs=1.2) and max(far) == pytest.approx(180, abs=1.2)
    assert list(scan.ranges).count(inf) == 16 * POINTS - len(near) - len(far)


def test_poses(exported):
    (_, schema, first), (time, _, last) = exported["/pose"]
    assert schema == "foxglove.PoseInFrame" and first.frame_id == "world"
    assert (first.pose.position.x, first.pose.position.y) == (0.3, -0.05)
    assert 2 * degrees_of(first.pose.orientation) == pytest.approx(180)  # heading 0 looks along +y
    assert time == 450_000_000
    assert (last.pose.position.x, last.pose.position.y) == pytest.approx((1.5, 0.7))
    assert degrees_of(last.pose.orientation) == pytest.approx(0)  # heading 90 looks along +x
    (_, _, thought) = exported["/odometry"][0]
    assert (thought.frame_id, thought.pose.position.x, thought.pose.position.y) == ("odometry", 0.1, 0.2)


def degrees_of(orientation):
    return degrees(2 * atan2(orientation.z, orientation.w))


def test_the_frames_are_one_tree_in_which_the_body_is_where_it_truly_is(exported):
    latest = {}
    for _, _, message in exported["/tf"]:
        turn = 2 * atan2(message.rotation.z, message.rotation.w)
        latest[message.child_frame_id] = message.parent_frame_id, complex(message.translation.x, message.translation.y), turn
    assert {child: parent for child, (parent, _, _) in latest.items()} == {"odometry": "world", "body": "odometry"}
    (_, where, turn), (_, body, body_turn) = latest["odometry"], latest["body"]
    assert body == pytest.approx(0.1 + 0.2j)  # as the robot believes
    assert where + rect(1, turn) * body == pytest.approx(1.5 + 0.7j)  # as the twin knows
    assert rect(1, turn + body_turn) == pytest.approx(1)  # heading 90 looks along +x


def test_decisions(exported):
    (time, schema, first), (_, _, second) = exported["/decision"]
    assert (time, schema) == (500_000_000, "gapseeker.decision")
    assert (first["af"], first["ar"], first["v"], first["free"], first["block"]) == (-12.0, 6.0, 108, 650, [-20, 310])
    assert (first["zone"], second["zone"], second["block"]) == (9, None, None)
    assert (first["why"], first["why_number"]) == ("way ahead is free", 1)


def test_window_points(exported):
    ((_, schema, cloud),) = exported["/points"]
    assert schema == "foxglove.PointCloud"
    assert list(struct.iter_unpack("<ff5B3x", cloud.data)) == [
        (pytest.approx(0.3), pytest.approx(0.125), 230, 50, 50, 255, 2),
        (pytest.approx(0.0), pytest.approx(-1.0), 240, 200, 40, 255, 4),
    ]
    assert [(field.name, field.offset) for field in cloud.fields][:2] == [("x", 0), ("y", 4)]


def test_log(exported):
    messages = [m.message for _, _, m in exported["/log"]]
    assert messages == ["zu heiß", "touched a wall"]


def test_scene_shows_body_and_walls(exported):
    entities = {entity.id: entity for _, _, scene in exported["/scene"] for entity in scene.entities}
    size = entities["body"].cubes[0].size
    assert (entities["body"].frame_id, size.x, size.y) == ("body", pytest.approx(0.6), pytest.approx(0.25))
    assert entities["walls"].frame_id == "world" and len(entities["walls"].lines[0].points) >= 8


def test_the_scene_has_the_windows_and_the_plan(tmp_path):
    from host.export import plan, shapes
    from host.export.to_mcap import margins

    (edges,) = shapes.windows(250, 600, margins({"windows": {"red": 30}})(600)).entities
    red, blue, yellow = ({(round(point.x, 3), round(point.y, 3)) for point in line.points} for line in edges.lines)
    assert edges.frame_id == "body" and (0.33, 0.155) in red and (0.345, 0.17) in blue and (1.2, 0.425) in yellow
    (shown,) = shapes.plan(plan.way(0, 0, 120, 500, 497), 250, 600).entities
    way, outline = shown.lines
    assert (way.points[-1].x, way.points[-1].y) == pytest.approx((0.5, 0))
    assert max(point.x for point in outline.points) == pytest.approx(0.8)
    (gone,) = shapes.plan(plan.way(0, 0, 90, 500, 497), 250, 600).entities
    assert gone.id == shown.id and not gone.lines


def test_the_plan_is_the_firmware_s_motion():
    """Against the firmware's own steering, in small steps: left, right, crab, spin, backward."""
    from core.axles import lay_out
    from host.export import plan
    from steering import Steering

    spacings = (115, 150, 117, 115)
    span = sum(spacings)
    solved = Steering(lay_out(spacings, 230))
    for af, ar, v in ((30, -20, 120), (-38, 10, 120), (60, 60, 120), (90, -90, 120), (-90, 90, 60), (90, 90, 120), (0, 25, 60)):
        solved.solve(af * 10, ar * 10)
        vx, vy, w = solved.vx, solved.vy, 2 * solved.w / span
        x, y, heading = plan.way(af, ar, v, 20, span)[-1]
        sign = 1 if v > 90 else -1
        speed = max((vx * vx + vy * vy) ** 0.5, abs(w) * span / 2)
        assert (x, y) == pytest.approx((sign * 20 * vx / speed, sign * 20 * vy / speed), abs=0.6), (af, ar)
        assert heading == pytest.approx(degrees(sign * 20 * w / speed), abs=0.1), (af, ar)


def test_the_layout_asks_for_topics_that_are_there(exported):
    from pathlib import Path

    layout = json.loads((Path(command_line.__file__).parent / "foxglove.json").read_text())
    panels = layout["configById"]
    asked = set(panels["3D!map"]["topics"])
    for panel in panels.values():
        asked.update("/" + path["value"].split(".")[0].strip("/") for path in panel.get("paths", ()))
        asked.update([panel["topicPath"]] if "topicPath" in panel else ())
    assert asked - {"/wheels"} <= set(exported)  # this recording's robot told nothing of its wheels
    placed = json.dumps(layout["layout"])
    assert all(name in placed for name in panels)


def test_scans_of_a_run_lie_on_the_walls_while_it_turns(tmp_path):
    """Placed by the file's own frames at their stamps."""
    make_reader = pytest.importorskip("mcap.reader", reason="needs the extra [export]").make_reader
    factory = pytest.importorskip("mcap_protobuf.decoder", reason="needs the extra [export]").DecoderFactory
    import numpy as np

    from host.twin import courses, run

    run("Z", width=600, limit_s=18, record=tmp_path / "z.rec")
    assert command_line.main([str(tmp_path / "z.rec"), str(tmp_path / "z.mcap")]) in (0, 1)
    found, poses = [], []
    with open(tmp_path / "z.mcap", "rb") as file:
        for _, channel, message, told in make_reader(file, decoder_factories=[factory()]).iter_decoded_messages(topics=["/scan", "/pose"]):
            if channel.topic == "/scan":
                found.append((message.log_time / 1e9, told.start_angle, told.end_angle, np.array(told.ranges)))
            else:
                turn = 2 * np.arctan2(told.pose.orientation.z, told.pose.orientation.w)
                poses.append((message.log_time / 1e9, told.pose.position.x, told.pose.position.y, turn))
    poses = np.array(poses)
    poses[:, 3] = np.unwrap(poses[:, 3])
    walls = courses.make("Z", 600).segments / 1000
    off = []
    for time, first, last, ranges in found:
        x, y, heading = (np.interp(time, poses[:, 0], poses[:, i]) for i in (1, 2, 3))
        before, after = (np.interp(time + d, poses[:, 0], poses[:, 3]) for d in (-0.05, 0.05))
        if abs(after - before) < 0.02:
            continue
        angle = np.linspace(first, last, len(ranges))[np.isfinite(ranges)] + heading
        beam = ranges[np.isfinite(ranges)]
        places = np.stack([x + beam * np.cos(angle), y + beam * np.sin(angle)], 1)
        start, side = walls[:, :2], walls[:, 2:] - walls[:, :2]
        along = np.clip(((places[:, None] - start) * side).sum(2) / (side * side).sum(1), 0, 1)
        off.append(np.hypot(*(places[:, None] - start - along[..., None] * side).transpose(2, 0, 1)).min(1).mean() * 1000)
    assert len(off) > 10 and np.mean(off) < 8, np.mean(off)  # 12.8 mm at their end, about 6 in their middle


def test_the_file_says_where_it_comes_from(exported):
    assert exported["metadata"] == [{"source": "twin:z?width=550", "firmware": "1.0", "clock": "robot"}]
    assert exported["attachments"]["robot.json"] == ROBOT.encode()


def test_csv(tmp_path, capsys):
    assert command_line.main([str(write(tmp_path / "a.rec")), str(tmp_path / "a.csv")]) == 0
    with open(tmp_path / "a.csv", newline="") as file:
        first, second = csv.DictReader(file)
    assert (first["time"], first["af"], first["zone"], first["block_y"], first["why"]) == ("0.500000", "-12.0", "9", "310", "way ahead is free")
    assert (first["x"], first["y"], first["heading"]) == ("1500.0", "700.0", "90.0")
    assert (second["zone"], second["block_x"]) == ("", "")
    assert "2 decisions" in capsys.readouterr().out


def test_without_decision_records_those_of_the_telemetry_count(tmp_path):
    path = write(tmp_path / "a.rec", decisions=False, clock="host")
    assert command_line.main([str(path), str(tmp_path / "a.csv")]) == 0
    with open(tmp_path / "a.csv", newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["number"], row["v"], row["why"]) == ("7", "99", "waiting")


def test_a_cut_recording_is_exported_up_to_the_cut(tmp_path, capsys):
    path = write(tmp_path / "a.rec")
    path.write_bytes(path.read_bytes()[:-60])
    assert command_line.main([str(path), str(tmp_path / "a.csv")]) == 1
    assert "cut off at byte" in capsys.readouterr().out


def test_what_cannot_be_exported(tmp_path, capsys):
    path = write(tmp_path / "a.rec")
    assert command_line.main([str(path), str(tmp_path / "a.bag")]) == 2
    assert ".mcap" in capsys.readouterr().err
    assert command_line.main([str(tmp_path / "none.rec"), str(tmp_path / "a.csv")]) == 2
    assert command_line.main([str(path), str(tmp_path / "no" / "folder" / "a.csv")]) == 2
    assert "choose a folder" in capsys.readouterr().err


@pytest.mark.parametrize("robot", ["", "{", "[]", '{"robot": 5}', '{"robot": {"width": "wide"}}', '{"avoid": {"margin": "x"}}'])
def test_a_recording_without_its_robot_json_is_exported_and_says_so(tmp_path, capsys, robot):
    pytest.importorskip("mcap", reason="needs the extra [export]")
    with Writer(tmp_path / "a.rec", Header("1", robot, "serial:/dev/ttyUSB0", "host")) as writer:
        for data in TELEMETRY:
            writer.write(Stream.TELEMETRY, 400_000, data)
        writer.write(Stream.LIDAR, 400_000, b"\xaa" * 100)
    assert command_line.main([str(tmp_path / "a.rec"), str(tmp_path / "a.mcap")]) == 0
    assert "it lacks scans" in (told := capsys.readouterr().out) and "it lacks the true pose" in told
    assert (tmp_path / "a.mcap").stat().st_size > 500


def test_a_damaged_recording_is_exported_with_what_follows(tmp_path, capsys):
    path = write(tmp_path / "a.rec")
    whole = path.read_bytes()
    path.write_bytes(whole[:3000] + b"\x55" * 40 + whole[3040:])
    assert command_line.main([str(path), str(tmp_path / "a.csv")]) == 1
    assert "damaged at byte" in capsys.readouterr().out
    assert (tmp_path / "a.csv").read_text().count("\n") == 3


@pytest.mark.parametrize("bearing, angle", [(0, 0), (90, -pi / 2), (270, pi / 2), (180, -pi), (359.9, 0.1 * pi / 180)])
def test_bearings(bearing, angle):
    assert frames.body_angle(bearing) == pytest.approx(angle)


def test_points_of_the_body():
    assert frames.body_point(-125, 300) == pytest.approx((0.3, 0.125))  # left front: x forward, y left


def test_two_points_in_one_place_give_the_nearer():
    ranges, signals = scans.evenly(scans.Scan([10.0, 11.0, 200.0], [900.0, 500.0, 0.0], [5, 6, 0]))
    assert sorted(ranges) == [0.5, inf, inf] and max(signals) == 6


def test_wheels_stand_where_the_robot_has_them():
    from host.export.to_mcap import wheel_places

    assert wheel_places({"spacings": [100, 200], "track": 230}) == [(-115, 150), (115, 150), (-115, 50), (115, 50), (-115, -150), (115, -150)]
    assert wheel_places({"spacings": [100], "track": 200, "first": 80})[::2] == [(-100, 80), (-100, -20)]
    assert wheel_places({}) == wheel_places({"spacings": [1], "track": None}) == []


def test_wheels_are_seen_turned_to_their_angles():
    from host.export import shapes

    (entity,) = shapes.wheels([(-115, 150), (115, 150)], [30, 0]).entities
    left, right = entity.cubes
    assert (entity.frame_id, left.pose.position.x, left.pose.position.y) == ("body", pytest.approx(0.15), pytest.approx(0.115))
    assert degrees_of(left.pose.orientation) == pytest.approx(-30) and degrees_of(right.pose.orientation) == pytest.approx(0)


def test_a_scan_has_the_signals_that_the_lidar_sent(tmp_path):
    from host.recording import Reader

    reader = scans.ScanReader(ROBOT)
    found = [scan for record in Reader(write(tmp_path / "a.rec")) if record.stream == Stream.LIDAR for scan in reader.take(record)]
    assert len(found) == 2
    for scan in found:
        assert len(scan.signals) == len(scan.distances) > 100
        assert all((signal == 50) == (distance > 0) for signal, distance in zip(scan.signals, scan.distances, strict=True))
        assert 0 < sum(distance > 0 for distance in scan.distances) < len(scan.distances)
