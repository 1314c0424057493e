"""perception/scan_trust.py: scans that can be trusted, and the ways in which a lidar answers and sees nothing."""

from array import array

from perception.scan_trust import ScanTrust

FRAMES = 16
BEAMS = 38
SCAN = 12


class Config:
    lidar_returns = 20
    robot_width = 250
    lidar_left_out = ()
    lidar_near = 200
    lidar_far = 8000
    lidar_x = lidar_y = 0
    lidar_mirrored = False
    robot_length = 600
    lidar_frames = FRAMES


class Odometry:
    travel256 = x = y = heading = 0


class Lidar:
    """Frames of a scan whose ranges waver, `mm` on the average."""

    def __init__(self, frames=FRAMES):
        self.frames = frames
        self.n = self.missed = 0
        self.place = frames - 1
        self.bearings = array("H", bytes(160))
        self.distances = array("H", bytes(160))
        self.random = 1
        self.mm = 1000

    def turn(self):
        """The next frame."""
        self.place = (self.place + 1) % self.frames

    def see(self, n=BEAMS, returns=BEAMS):
        self.n = n
        for i in range(n):
            self.bearings[i] = (3600 * (self.place * n + i) // (n * self.frames)) % 3600
            self.random = (self.random * 75 + 74) % 65537
            self.distances[i] = 4 * self.mm + self.random % 17 if i < returns else 0


class Bench:
    """A trust that hears frames. Each call of the methods is one revolution."""

    def __init__(self, v256=0, **changes):
        config = Config()
        for name in changes:
            setattr(config, name, changes[name])
        self.lidar = Lidar(config.lidar_frames)
        self.trust = ScanTrust(config)
        self.odometry = Odometry()
        self.v256 = v256
        self.place = self.lidar.place

    def hear(self):
        """As the lidar's reader does: what lies between two frames is missing; one that comes again has gone round."""
        lidar = self.lidar
        lidar.missed += (lidar.place - self.place - 1) % lidar.frames
        self.place = lidar.place
        self.trust.frame(self.lidar, self.odometry, self.v256)
        return self.trust.fault

    def look(self, change=None, revolutions=1, until=None):
        """change(lidar): True when the frame is not to be heard. until: frames. Returns the number of frames until a fault, None if there was none."""
        frames = until or revolutions * self.lidar.frames
        for i in range(frames):
            self.lidar.turn()
            self.lidar.see()
            if change is None or not change(self.lidar):
                if self.hear():
                    return i + 1
        return None


def trusting(mm=1000, **changes):
    bench = Bench(**changes)
    bench.lidar.mm = mm
    for _ in range(4 * bench.lidar.frames):
        bench.look(until=1)
    assert bench.trust.fault == 0
    return bench


def test_trust_is_earned_by_a_whole_revolution():
    bench = Bench()
    assert bench.trust.fault == SCAN
    heard = 0
    while bench.look(until=1):
        heard += 1
        assert heard <= 3 * FRAMES
    assert heard >= FRAMES - 1


def test_good_scans_stay_trusted():
    for frames in (8, 15, 16, 32):
        assert trusting(lidar_frames=frames).look(revolutions=300) is None


def test_every_gap_is_found_within_one_and_a_half_revolutions():
    gaps = [{place} for place in range(FRAMES)]
    gaps += [set(range(8)), {0, 15}, set(range(0, 16, 2)), set(range(16)) - {3}, set(range(16)) - {0, 8}, set(range(16)) - {0, 4, 8, 12}]
    for gap in gaps:
        for first in (0, 5):
            bench = trusting()
            for _ in range(first):
                bench.look(until=1)
            # A frame that is the only one is heard of once in a revolution
            most = 2 * FRAMES + 1 if len(gap) == 1 else FRAMES * 3 // 2 + 1 if len(gap) < 12 else 2 * FRAMES
            assert bench.look(lambda lidar: lidar.place in gap, 4) <= most, gap


def test_a_lone_frame_may_be_missing_once_a_revolution_and_not_the_same_one_twice():
    for place in (0, 1, 7, 15):
        bench = trusting()
        lost = []

        def lose(lidar, wait):
            lost.append(lidar.place == place and lost.count(True) * wait <= len(lost))
            return lost[-1]

        assert bench.look(lambda lidar: lose(lidar, 2 * FRAMES), 40) is None and lost.count(True) >= 19
        bench = trusting()
        assert bench.look(lambda lidar: lidar.place == place, 1) is None
        assert bench.look(lambda lidar: lidar.place == (place + 5) % FRAMES, 2) is not None  # another in less than a revolution
        bench = trusting()
        assert bench.look(lambda lidar: lidar.place in (place, (place + 1) % FRAMES), 2) <= FRAMES + 2  # two side by side


def test_what_is_missing_stays_a_fault_and_a_whole_revolution_mends_it():
    bench = trusting()
    half = lambda lidar: lidar.place < 8  # noqa: E731
    bench.look(half, 4)
    for _ in range(3 * FRAMES):
        bench.look(half, until=1)
        assert bench.trust.fault == SCAN
    for k in range(3 * FRAMES):
        bench.look(until=1)
        assert k >= FRAMES - 2 or bench.trust.fault
    assert bench.trust.fault == 0


def test_one_frame_again_and_again():
    bench = trusting()
    bench.lidar.turn()
    bench.lidar.see()
    frames = 1
    while not bench.hear():
        frames += 1
        assert frames <= FRAMES * 3 // 2


def kept(lidar, store):
    """The first revolution again and again."""
    if lidar.place in store:
        lidar.distances[:] = store[lidar.place]
    else:
        store[lidar.place] = array("H", lidar.distances)


def test_one_revolution_again_and_again():
    bench = trusting()
    store = {}
    assert bench.look(lambda lidar: kept(lidar, store), 5) == 2 * FRAMES


def test_fifteen_frames_alike_are_no_fault():
    bench = trusting()
    store = {}
    bench.look(lambda lidar: kept(lidar, store), until=2 * FRAMES - 1)
    assert bench.trust.fault == 0
    assert bench.look(until=1) is None


def test_bytes_that_never_change():
    for counts in (0, 799, 32000, 65535):
        bench = trusting()

        def alike(lidar, counts=counts):
            for i in range(lidar.n):
                lidar.distances[i] = counts

        assert bench.look(alike, 3) <= FRAMES
    bench = trusting()

    def same(lidar):
        for i in range(lidar.n):
            lidar.distances[i] = 800

    assert bench.look(same, 3) <= FRAMES, "all at one distance"


def test_the_limits_of_the_range():
    for low, high, seen in ((800, 801, 1), (798, 799, 0), (31998, 31999, 1), (32000, 32001, 0), (31999, 32000, 0)):
        bench = trusting()

        def two(lidar, low=low, high=high):
            for i in range(lidar.n):
                lidar.distances[i] = low if i & 1 else high
            lidar.distances[0] = low if lidar.random & 1 else high

        bench.look(two, until=FRAMES)
        assert (bench.trust.fault == 0) == seen, (low, high)


def test_share_of_the_beams():
    for share in (10, 20, 50, 100):
        just = share // 2  # of 50 beams
        for fewer, well in ((0, 1), (1, 0)):
            bench = trusting(lidar_returns=share)
            bench.look(lambda lidar: lidar.see(n=50, returns=24), until=FRAMES)  # most of them lost at once is another matter
            for _ in range(4 * FRAMES):
                bench.look(lambda lidar, fewer=fewer, just=just: lidar.see(n=50, returns=just - (fewer if lidar.place == 3 else 0)), until=1)
            assert (bench.trust.fault == 0) == well, (share, fewer)


def test_open_halls():
    bench = trusting(lidar_returns=0)
    assert bench.look(lambda lidar: lidar.see(returns=0), 50) is None
    assert bench.trust.most == 90
    assert max(bench.lidar.distances[: bench.lidar.n]) == 0, "nothing is put there"
    # one pillar, which wavers
    assert bench.look(lambda lidar: lidar.see(returns=BEAMS if lidar.place == 3 else 0), 100) is None


def test_frames_without_points():
    assert trusting().look(lambda lidar: lidar.see(n=0), 2) == 1


def glass(*places):
    return lambda lidar: lidar.see(returns=0 if lidar.place in places else BEAMS)


def test_slow_towards_the_unknown_and_not_away_from_it():
    for places, ahead, behind in (((0,), 6, 90), ((15,), 6, 90), ((1,), 6, 90), ((7,), 90, 6), ((8,), 90, 6), ((4, 12), 90, 90), ((0, 8), 6, 6)):
        bench = trusting(700, v256=10)
        bench.look(glass(*places), 3)
        assert (bench.trust.most, bench.trust.fault) == (ahead, 0), places
        bench.v256 = -10
        bench.look(glass(*places))
        assert bench.trust.most == behind, places
        bench.v256 = 0
        bench.look(glass(*places))
        assert bench.trust.most == min(ahead, behind), places
        bench.look(revolutions=2)
        assert bench.trust.most == 90


def test_slow_near_the_border_only():
    for mm, most in ((750, 6), (755, 6), (760, 90), (765, 90)):
        bench = trusting(mm, v256=10)
        bench.look(glass(0), 3)
        assert bench.trust.most == most, mm


def test_one_empty_frame_is_not_unknown():
    bench = trusting(700, v256=10)
    bench.look(glass(0))
    assert bench.trust.most == 90
    bench.look()
    assert bench.trust.most == 90


def border(bench):
    """mm, as it lies in the next frame of place 0, with glass there and on both sides for the second time at least; all its beams agree."""
    for _ in range(2):
        bench.look(glass(15, 0, 1), until=1)
        while bench.lidar.place:
            bench.look(glass(15, 0, 1), until=1)
    ranges = set(bench.lidar.distances[: bench.lidar.n])
    assert len(ranges) == 1
    return ranges.pop() // 4


def test_the_border_is_where_it_was_seen_free_last():
    bench = trusting(v256=10)
    bench.odometry.travel256 = (1 << 26) - 50 * 256
    bench.look()
    assert 1000 <= border(bench) <= 1005
    bench.odometry.travel256 = 250 * 256  # 300 mm on, over the end of the counter
    assert 700 <= border(bench) <= 705
    bench.odometry.travel256 = 5000 * 256
    assert border(bench) == 360, "in front of the body, and no nearer"
    bench.odometry.travel256 = 70_000 * 256 & 0x3FFFFFF
    assert border(bench) == 360


def test_what_a_place_beside_it_has_seen_serves_as_well():
    bench = trusting(500, v256=10)
    bench.lidar.mm = 900
    bench.look(glass(0), 3)
    bench.look(glass(0), until=1)
    assert bench.lidar.place == 0 and 900 <= bench.lidar.distances[0] // 4 <= 905


def test_never_seen_is_no_way():
    bench = Bench(v256=10)
    bench.look(glass(15, 0, 1), until=1)
    for _ in range(4 * FRAMES):
        bench.look(glass(15, 0, 1), until=1)
    assert (bench.trust.fault, bench.trust.most) == (0, 6)
    assert border(bench) == 360


def test_a_few_returns_are_not_enough_to_know():
    for returns, most in ((BEAMS // 8, 6), (BEAMS // 8 + 1, 90)):
        bench = trusting(700, v256=10)
        bench.look(lambda lidar, returns=returns: lidar.see(returns=returns if lidar.place == 0 else BEAMS), 3)
        assert bench.trust.most == most, returns
