"""The lidar's bytes, read by an independent decoder."""

import numpy as np
import pytest
from lds2d.drivers.threeirobotix_delta_2a import decode_delta

from host.twin import courses
from host.twin.delta2b import Delta2B, check, fault, frame
from host.twin.line import Line
from host.twin.vehicle import Vehicle
from host.twin.world import World

VEHICLE = Vehicle.from_settings({})


def standing(x, y, heading):
    """Poses of a body that does not move."""
    return lambda times: (np.full(len(times), float(x)), np.full(len(times), float(y)), np.full(len(times), float(heading)))


def running(version=1, settings=None, course="Z", duty=0.62):
    """A lidar up to speed."""
    vehicle = Vehicle.from_settings(settings or {})
    lidar = Delta2B(vehicle.lidar, World(courses.make(course, 550).segments), np.random.default_rng(1), version)
    lidar.spin(0, duty)
    while lidar.due < 3e6 or lidar.sector:
        lidar.take(standing(275, -50, 0))
    return lidar


def test_known_frame():
    # 6.15 r/s, start 22.50 deg, 1000 mm with signal 50 and a point without return; sum over the bytes before it.
    data = frame(6.15, 2250, np.array([50, 0]), np.array([4000, 0]))
    assert data.hex(" ") == "aa 00 13 01 61 ad 00 0b 7b 00 00 08 ca 32 0f a0 00 00 00 04 05"


def test_known_speed_faults():
    assert fault(5.25).hex(" ") == "aa 00 09 01 61 ae 00 01 69 02 2d"
    assert fault(5.25, version=0).hex(" ") == "aa 00 09 00 61 ae 00 01 69 c9 49"  # CRC, high byte first


def test_check_of_a_whole_frame_by_crc():
    data = running(version=0).take(standing(275, -50, 0))
    assert data[3] == 0
    assert check(data[:-2], 0) == int.from_bytes(data[-2:], "big")


def test_a_revolution_shows_the_walls_to_an_independent_decoder():
    lidar = running()
    data = bytearray().join(lidar.take(standing(275, -50, 0)) for _ in range(16))
    (frames) = list(decode_delta(data))
    assert len(frames) == 16
    points = [point for _, scan in frames for point in scan]
    assert 560 <= len(points) <= 660
    for angle, expected in ((90, 275), (270, 275), (180, 650), (0, 1115)):
        near = [p.dist_mm for p in points if abs((p.angle_deg - angle + 180) % 360 - 180) < 3 and p.dist_mm]
        assert np.mean(near) == pytest.approx(expected, abs=3)
    assert frames[0][0] == pytest.approx(lidar.speed, abs=0.05)


def test_noise_dropouts_and_steps():
    lidar = running()
    ranges = []
    for _ in range(160):
        ((_, points),) = decode_delta(bytearray(lidar.take(standing(275, -50, 0))))
        ranges += [p.dist_mm for p in points if abs(p.angle_deg - 90) < 3]
    ranges = np.array(ranges)
    assert 0 <= (ranges == 0).mean() < 0.04
    assert np.std(ranges[ranges > 0]) == pytest.approx(4, abs=1)


def test_too_near_and_too_far_give_no_return():
    lidar = running()
    for x, bearing in ((150, 270),):
        data = bytearray().join(lidar.take(standing(x, -50, 0)) for _ in range(16))
        near = [p for _, scan in decode_delta(data) for p in scan if abs(p.angle_deg - bearing) < 30]
        assert near and all(p.dist_mm == 0 and p.quality == 0 for p in near)
    lidar = Delta2B(VEHICLE.lidar, World([(-50_000, 8100, 50_000, 8100)]), np.random.default_rng(1))
    lidar.spin(0, 0.62)
    while lidar.speed < 6:
        data = lidar.take(standing(0, 0, 0))
    assert data[5] == 0xAD
    assert not any(data[13:-2])


def test_speed_faults_until_up_to_speed_and_points_by_speed():
    lidar = Delta2B(VEHICLE.lidar, World([(-500, 500, 500, 500)]), np.random.default_rng(1))
    commands = [lidar.take(standing(0, 0, 0))[5] for _ in range(3)]
    assert commands == [0xAE] * 3
    lidar.spin(lidar.began, 0.62)
    while lidar.due < 3e6:
        commands.append(lidar.take(standing(0, 0, 0))[5])
    assert commands[-1] == 0xAD
    counts = {}
    for duty in (0.52, 0.62, 0.8):
        lidar.spin(lidar.began, duty)
        for _ in range(1600):
            data = lidar.take(standing(0, 0, 0))
        counts[round(lidar.speed)] = (len(data) - 15) // 3
    assert list(counts.values()) == sorted(counts.values(), reverse=True)
    assert counts[9 if 9 in counts else max(counts)] == pytest.approx(4000 / 16 / max(counts), abs=4)


def test_every_point_is_measured_where_the_body_was_then():
    lidar = running()
    start = lidar.began

    def fast(times):  # 1 m/s to the right
        return 275 + (times - start) / 1e3, np.full(len(times), -50.0), np.zeros(len(times))

    frames = [lidar.take(fast) for _ in range(16)]
    ((_, right),) = decode_delta(bytearray(frames[4]))  # begins at 90 deg: the right wall, a quarter turn later
    ((_, left),) = decode_delta(bytearray(frames[12]))
    quarter = 1 / lidar.speed / 4 * 1000
    assert np.median([p.dist_mm for p in right[:4]]) == pytest.approx(275 - quarter, abs=6)
    assert np.median([p.dist_mm for p in left[:4]]) == pytest.approx(275 + 3 * quarter, abs=6)


def test_offset_and_mirror_of_the_mounting():
    lidar = running(settings={"lidar": {"offset": 90, "mirrored": True}})
    data = bytearray().join(lidar.take(standing(275, -50, 0)) for _ in range(16))
    points = [p for _, scan in decode_delta(data) for p in scan if p.dist_mm]
    # Its zero looks to the robot's right and its angles grow to the left: straight ahead is at 90.
    ahead = [p.dist_mm for p in points if abs(p.angle_deg - 90) < 3]
    assert np.mean(ahead) == pytest.approx(1115, abs=3)


def test_bytes_take_their_time_on_the_line():
    line = Line(230400)
    line.send(1000, b"a" * 100)
    line.send(2000, b"b" * 10)  # the line is busy until 5340
    (first, a), (second, b) = line.take(1e6, 4, 1000)
    assert first == pytest.approx(1000 + 10e6 / 230400, abs=1)
    assert second == pytest.approx(1000 + 101 * 10e6 / 230400, abs=1)
    assert (len(a), len(b)) == (100, 10)
    assert line.first_arrival() is None


def test_a_line_hands_out_no_more_than_there_is_room_for():
    line = Line(230400)
    for _ in range(6):
        line.send(0, b"x" * 300)
    assert [len(data) for _, data in line.take(1e6, 4, 700)] == [300, 300]
    assert len(line.take(1e6, 4, 10_000)) == 4
