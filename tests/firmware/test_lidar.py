"""lidar.py: frames of the Delta family out of any stream of bytes."""

import micropython

from lidar import Lidar

FRAME_A = (  # vendor's Delta-2A example: 6.50 r/s, 270 deg, 47 points
    "AA009A0161AD00928200876978000000462 13A54237800 0000000000913360823 2F79332EB6D32E05121880000"
    "005D21886621 8D6821BF4132D4863302 4D32E089514 88E5148925148 8C514863501 96D51487C5164925164895148"
    "905164895148935 1644B532D5759BA432F78412EE4000000542EDE6B2EE46B2F50582EE47E2F645D2F783F5A0B5A"
    "5BFD575BD35B5C28595C28595BFD5E5E3235BC"
)
FRAME_B = (  # nominal 38 points, 6.15 r/s, 45 deg; point n: (800 + 13 n) mm + 0.25 mm, nothing where n % 7 == 0
    "AA007F0161AD00777B0000119400000029 0CB52A0CE92B0D1D2C0D512D0D852E0DB9000000"
    "300E21310E55320E89330EBD340EF1350F25000000370F8D380FC1390FF53A10293B105D3C"
    "10910000003E10F93F112D40116141119542 11C94311FD00000045126546129947 12CD481 3"
    "01491335 4A13690000004C13D14D14051DB6"
)
FRAME_C1_SUM = "AA00130161AD000B7BFFF608CA320FA000000005FA"  # 22.5 deg: 1000 mm, no return
FRAME_C0_SUM = "AA00130061AD000B7BFFF608CA320FA000000005F9"
FRAME_C0_CRC = "AA00130061AD000B7BFFF608CA320FA00000004484"
FRAME_D0_SUM = "AA00090061AE000169022C"  # speed fault, 5.25 r/s
FRAME_D0_CRC = "AA00090061AE000169C949"
FRAME_D1_SUM = "AA00090161AE000169022D"
PERIOD = 10_000


def frame_bytes(text):
    return bytes.fromhex(text.replace(" ", ""))


class Config:
    lidar_baud = 230400
    lidar_rxbuf = 2048
    lidar_frames = 16
    lidar_offset = 0
    lidar_mirrored = False
    lidar_speed20 = 120


class Uart:
    """A UART whose bytes are all there already, given out at most `most` at a time; allocates nothing in readinto."""

    def __init__(self, data=b"", most=4096):
        self.data = bytearray(data)
        self.at = 0
        self.most = most

    def give(self, data):
        self.data = bytearray(data)
        self.at = 0

    def any(self):
        return len(self.data) - self.at

    def readinto(self, buffer):
        count = min(len(buffer), len(self.data) - self.at, self.most)
        if not count:
            return None
        i = 0
        while i < count:
            buffer[i] = self.data[self.at + i]
            i += 1
        self.at += count
        return count


class Motor:
    def __init__(self):
        self.duty = None

    def duty_u16(self, duty):
        assert 0 <= duty <= 65535
        self.duty = duty


def make_frame(start=0, points=((4000, 50), (0, 0)), speed20=120, version=1):
    """A measurement frame; start in 0.01 deg, points (quarter mm, signal); version 0 gets the sum."""
    count = 5 + 3 * len(points)
    data = bytearray([0xAA, 0, 8 + count, version, 0x61, 0xAD, 0, count, speed20, 0, 0, start >> 8, start & 255])
    for distance, signal in points:
        data += bytes([signal, distance >> 8, distance & 255])
    check = sum(data) & 0xFFFF
    return bytes(data) + bytes([check >> 8, check & 255])


def turn(frames=16, **kw):
    """Frames of one revolution and on, one after the other."""
    return [make_frame(start=2250 * (k % 16), **kw) for k in range(frames)]


def read(data, config=Config, most=4096):
    """(lidar, frames) after all of data was read; a frame is (bearings, distances)."""
    lidar = Lidar(Uart(data, most), None, config)
    frames = []
    while lidar.poll(1000):
        n = lidar.n
        frames.append((list(lidar.bearings[:n]), list(lidar.distances[:n])))
    return lidar, frames


def paced(lidar, uart, frames, now=0, period=PERIOD):
    """Give one frame a period, polled as it arrives; the time after the last one."""
    for data in frames:
        now += period
        uart.give(data)
        while lidar.poll(now):
            pass
    return now


def test_vendor_example_gives_47_points():
    lidar, frames = read(frame_bytes(FRAME_A))
    bearings, distances = frames[0]
    assert len(frames) == 1 and len(distances) == 47 and lidar.speed20 == 130
    assert bearings[:4] == [2700, 2705, 2710, 2714] and bearings[46] == 2920
    assert distances[:4] == [0, 8506, 9080, 0] and distances[46] == 24114


def test_nominal_frame_of_38_points():
    lidar, frames = read(frame_bytes(FRAME_B))
    bearings, distances = frames[0]
    assert len(distances) == 38 and lidar.speed20 == 123
    for n in range(38):
        assert distances[n] == (4 * (800 + 13 * n) + 1 if n % 7 else 0)
        assert abs(38 * (bearings[n] - 450) - 225 * n) <= 19


def test_two_points_with_every_check_rule():
    for text in (FRAME_C1_SUM, FRAME_C0_SUM, FRAME_C0_CRC):
        _, frames = read(frame_bytes(text))
        assert frames == [([225, 338], [4000, 0])]


def test_delta_2d_frame_with_end_angle():
    points = ((4000, 9), (5000, 8), (0, 0))
    plain = make_frame(6780, points)
    data = bytearray(plain[:13]) + bytes([0x23, 0x18]) + plain[13:-2]
    data[2] += 2
    data[7] += 2
    data[3] = 0x10
    check = sum(data) & 0xFFFF
    _, frames = read(bytes(data) + bytes([check >> 8, check & 255]))
    assert frames == [([678, 753, 828], [4000, 5000, 0])]


def test_length_that_fits_no_point_is_left_out():
    data = bytearray(make_frame()[:-4])
    data[2] -= 2
    data[7] -= 2
    check = sum(data) & 0xFFFF
    lidar, frames = read(bytes(data) + bytes([check >> 8, check & 255]) + make_frame(9000))
    assert len(frames) == 1 and frames[0][0][0] == 900 and lidar.errors == 0


def test_empty_frame_and_80_points():
    _, frames = read(make_frame(0, ()) + make_frame(2250, [(i, 1) for i in range(80)]))
    assert frames[0] == ([], [])
    assert frames[1][1] == list(range(80)) and max(frames[1][0]) == (225 * 2 * 80 - 225 + 40) // 80


def test_no_signal_is_no_return():
    _, frames = read(make_frame(0, ((3498, 0), (0, 7), (3498, 7))))
    assert frames[0][1] == [0, 0, 3498]


def test_offset_and_mirror():
    class Mounted(Config):
        lidar_offset = 1800

    class Mirrored(Config):
        lidar_offset = -100
        lidar_mirrored = True

    data = make_frame(33750, ((4000, 1),) * 3)
    assert read(data, Mounted)[1][0][0] == [1575, 1650, 1725]
    assert read(data, Mirrored)[1][0][0] == [125, 50, 3575]


def test_bearings_stay_in_the_circle():
    class Turned(Config):
        lidar_offset = 0

    for offset in range(0, 3600, 77):
        for mirrored in (False, True):
            Turned.lidar_offset = offset
            Turned.lidar_mirrored = mirrored
            for start in (0, 1, 17999, 35995, 35999):
                for bearing in read(make_frame(start, ((1, 1),) * 19), Turned)[1][0][0]:
                    assert 0 <= bearing < 3600


def test_fifteen_frames_a_turn():
    class Delta2G(Config):
        lidar_frames = 15

    assert read(make_frame(0), Delta2G)[1][0][0] == [0, 120]


def test_split_at_every_byte():
    data = frame_bytes(FRAME_C1_SUM)
    for cut in range(1, len(data)):
        uart = Uart(data[:cut])
        lidar = Lidar(uart, None, Config)
        assert not lidar.poll(0)
        uart.give(data[cut:])
        assert lidar.poll(100) and not lidar.poll(100)
        assert lidar.distances[0] == 4000 and lidar.skipped == 0
    for most in (1, 2, 7, 31):
        assert len(read(b"".join(turn(20)), most=most)[1]) == 20


def test_garbage_before_between_and_behind():
    noise = bytes((i * 37 + 11) & 255 for i in range(700)) + b"\xaa\xaa\xaa\x00\xaa"
    good = make_frame(2250)
    lidar, frames = read(noise + good + noise + good + noise)
    assert len(frames) == 2 and frames[0][1] == [4000, 0]
    assert lidar.skipped >= 2 * len(noise)


def test_a_corrupted_byte_anywhere_costs_one_frame():
    before, hit, after = turn(3)
    for at in range(len(hit)):
        for flip in (0x01, 0x80, 0xFF):
            broken = bytearray(hit)
            broken[at] ^= flip
            lidar, frames = read(before + bytes(broken) + after * 12)
            bearings = [frame[0][0] for frame in frames]
            assert bearings[0] == 0 and bearings[1:] == [450] * 12, (at, flip)


def test_a_frame_inside_what_looked_like_one():
    inner = make_frame(4500)
    lidar, frames = read(b"\xaa\x00\x40\x01\x61\xad\x00\x38" + inner * 8)
    assert len(frames) == 8 and lidar.errors == 1


def test_version_0_locks_on_to_the_rule_that_passes():
    crc, total = frame_bytes(FRAME_C0_CRC), frame_bytes(FRAME_C0_SUM)
    lidar, frames = read(crc * 3 + total + crc * 4 + total + crc)
    assert len(frames) == 9 and lidar.errors == 1
    lidar, frames = read(total * 4 + crc + total)
    assert len(frames) == 5 and lidar.errors == 1


def test_version_1_never_takes_the_crc():
    from core.crc16 import crc16

    data = bytearray(frame_bytes(FRAME_C1_SUM)[:-2])
    check = crc16(data, 0, len(data))
    lidar, frames = read(bytes(data) + bytes([check >> 8, check & 255]))
    assert frames == [] and lidar.errors == 1


def test_crc_of_the_vendor():
    from core.crc16 import crc16

    assert crc16(frame_bytes(FRAME_C0_CRC), 0, 19) == 0x4484
    assert crc16(b"123456789", 0, 9) == 0x4B37


def test_speed_faults_are_counted_and_give_the_speed():
    for text in (FRAME_D0_SUM, FRAME_D0_CRC, FRAME_D1_SUM):
        lidar, frames = read(frame_bytes(text))
        assert frames == [] and lidar.speed_faults == 1 and lidar.speed20 == 105 and lidar.errors == 0


def test_trusted_after_several_frames_and_lost_with_them():
    uart = Uart()
    lidar = Lidar(uart, None, Config)
    now = paced(lidar, uart, turn(7))
    assert not lidar.ok
    now = paced(lidar, uart, turn(1), now)
    assert lidar.ok
    uart.give(b"")
    lidar.poll(now + 80_000)
    assert lidar.ok
    lidar.poll(now + 120_000)
    assert not lidar.ok
    paced(lidar, uart, turn(7), now + 120_000)
    assert not lidar.ok


def test_time_out_is_learned_from_the_rate():
    uart = Uart()
    lidar = Lidar(uart, None, Config)
    now = paced(lidar, uart, turn(16, speed20=200), period=6250)
    uart.give(b"")
    lidar.poll(now + 70_000)
    assert not lidar.ok


def test_trust_and_frame_times_hold_past_the_wraps_of_ticks():
    for wrap in (2**29, 2**30):
        uart = Uart()
        lidar = Lidar(uart, None, Config)
        now = wrap - 1_000_000
        before = None
        for k in range(200):
            now = (now + PERIOD) % 2**30
            uart.give(make_frame(2250 * (k % 16)))
            while lidar.poll(now):
                if before is not None:
                    assert abs((lidar.frame_us - before) % 2**30 - PERIOD) < 1500, (wrap, k)
                before = lidar.frame_us
            assert lidar.ok == (k >= 7), (wrap, k)
        uart.give(b"")
        lidar.poll((now + 400_000) % 2**30)
        assert not lidar.ok


def test_speed_faults_alone_are_no_trust():
    uart = Uart()
    lidar = Lidar(uart, None, Config)
    now = paced(lidar, uart, turn(16))
    assert lidar.ok
    paced(lidar, uart, [frame_bytes(FRAME_D1_SUM)] * 16, now)
    assert not lidar.ok


def test_missing_frames_and_overflow_are_counted():
    frames = turn(16)
    lidar, got = read(b"".join(frames[:5] + frames[7:]))
    assert lidar.missed == 2 and len(got) == 14 and lidar.overflows == 0
    lidar, got = read(b"".join(turn(160)))
    assert lidar.overflows == 1 and len(got) == 160


def test_frame_time_is_the_last_point_not_the_read():
    uart = Uart()
    lidar = Lidar(uart, None, Config)
    period = 20_000_000 // 16 // 120
    sent = 0
    times = []
    for k in range(64):
        sent += period
        data = make_frame(2250 * (k % 16), ((4000, 50),) * 38)
        uart.give(data)
        late = (k * k * 7919) % 4000 if k else 0  # read up to 4 ms after it came
        assert lidar.poll(sent + late)
        times.append(lidar.frame_us - (sent - 129 * 10_000_000 // 230400))
        assert not lidar.poll(sent + late)
    assert max(times) - min(times) < 1600, times
    assert lidar.period_us == period


def test_frame_time_counts_what_came_behind_it():
    uart = Uart()
    lidar = Lidar(uart, None, Config)
    frames = turn(2)
    uart.give(frames[0] + frames[1])
    assert lidar.poll(50_000)
    first = lidar.frame_us
    assert first == 50_000 - (2 * len(frames[0]) * 43402) // 1000
    assert lidar.poll(50_000)
    assert lidar.frame_us == 50_000 - (len(frames[1]) * 43402) // 1000


class Spinner:
    """A lidar motor: speed follows 11 r/s x duty with a time constant of 0.4 s, 20 ms a step."""

    def __init__(self):
        self.speed = 0.0

    def step(self, duty):
        self.speed += (11.0 * duty / 65535 - self.speed) * 0.02 / 0.4
        return int(self.speed * 20)


def spin(seconds, gain=1.0, held=None):
    """Speeds (1/20 r/s) over time with the motor under control."""
    uart, motor, spinner = Uart(), Motor(), Spinner()
    lidar = Lidar(uart, motor, Config)
    lidar.poll(25_000)
    speeds = []
    now = 25_000
    for k in range(int(seconds * 50)):
        now += 20_000
        speed20 = spinner.step(motor.duty * gain if held is None or k > held else 0)
        speeds.append(speed20)
        uart.give(make_frame(2250 * (k % 16), speed20=max(speed20, 1)))
        while lidar.poll(now):
            pass
    return speeds, motor


def test_motor_starts_at_0_6_and_stays_there_while_nothing_is_heard():
    motor = Motor()
    lidar = Lidar(Uart(), motor, Config)
    for now in range(20_000, 1_000_000, 20_000):
        lidar.poll(now)
        assert motor.duty == 39322
    lidar.stop()
    assert motor.duty == 0


def test_motor_starts_whatever_the_clock_shows():
    for start in (0, 2**29 - 1_000_000, 2**29, 2**29 + 1_000_000, 2**30 - 30_000):
        motor = Motor()
        lidar = Lidar(Uart(), motor, Config)
        for k in range(3):
            lidar.poll((start + k * 20_000) % 2**30)
        assert motor.duty == 39322


def test_motor_speed_is_held():
    for gain in (0.7, 1.0, 1.5):
        speeds, _ = spin(20, gain)
        assert all(abs(speed - 120) <= 2 for speed in speeds[-200:]), (gain, speeds[-1])


def test_motor_does_not_wind_up_while_it_is_held():
    speeds, _ = spin(30, held=500)
    assert max(speeds) <= 120 * 1.25, max(speeds)


def test_polling_allocates_nothing():
    uart = Uart(b"".join(turn(16)) + b"noise" + b"".join(turn(16)))
    motor = Motor()
    lidar = Lidar(uart, motor, Config)
    assert lidar.poll(20_000)
    micropython.heap_lock()
    try:
        k = 0
        while k < 40:
            lidar.poll(20_000 + k * 10_000)
            k += 1
    finally:
        micropython.heap_unlock()
    assert lidar.frames == 32
