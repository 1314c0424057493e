"""The goal layer: the search against Dijkstra, the pose, doors, the map's file."""

import struct
from array import array

from core.crc16 import crc16
from goal import pose, route
from goal.build import build, load
from params.config import Config

CELL = 300
SPACING = 250


class _Plan:
    moves = 0


class _Decision:
    backward = 150

    class cost_to_go:
        goal = None
        rim = None
        laid = ux = uy = 0


class Avoid:
    def __init__(self):
        self.decision = _Decision()
        self.plan = _Plan()

    def configure(self):
        pass


class Random:
    """Numbers that both interpreters agree on."""

    def __init__(self, seed):
        self.state = seed * 7919 + 17

    def below(self, n):
        self.state = (self.state * 1103515245 + 12345) & 0x3FFFFFFF
        return (self.state >> 8) % n


def house(rows, doors=(), spacing=SPACING):
    """The bytes of a map.bin; rows of 0, 1, x, the first the top. The field is exact for walls along the cells, limited to 254 mm."""
    rows = rows[::-1]
    height, width = len(rows), len(rows[0])
    nodes_x, nodes_y = (width * CELL + spacing - 1) // spacing + 1, (height * CELL + spacing - 1) // spacing + 1

    def wall(x, y):
        return not (0 <= x < width * CELL and 0 <= y < height * CELL) or rows[y // CELL][x // CELL] == "1"

    def far(x, y):
        inside = wall(x, y)
        best = 254
        for row in range(y // CELL - 1, y // CELL + 2):
            for col in range(x // CELL - 1, x // CELL + 2):
                if wall(col * CELL, row * CELL) != inside:
                    dx = max(col * CELL - x, x - col * CELL - CELL, 0)
                    dy = max(row * CELL - y, y - row * CELL - CELL, 0)
                    best = min(best, int((dx * dx + dy * dy) ** 0.5))
        return -best if inside else best

    field = bytes([128 + far(i * spacing, j * spacing) // 2 for j in range(nodes_y) for i in range(nodes_x)])
    kinds = [{"1": 0, "0": 1, "x": 2}[letter] for row in rows for letter in row]
    kinds += [0] * (-len(kinds) % 4)
    cells = bytes([kinds[k] | kinds[k + 1] << 2 | kinds[k + 2] << 4 | kinds[k + 3] << 6 for k in range(0, len(kinds), 4)])
    data = struct.pack("<4sBBBBHBBHHii", b"GSMP", 1, height, width, len(doors), CELL, nodes_y, nodes_x, spacing, 0, 0, 0)
    for door in doors:
        data += struct.pack("<4H", *door)
    data += cells + field
    return data + struct.pack("<H", crc16(data, 0, len(data)))


def goal_of(rows, doors=()):
    with open("map.bin", "wb") as file:
        file.write(house(rows, doors))
    return build(Config(), Avoid(), load())


def search(goal, x, y, at_x, at_y):
    """Length of the way to (x, y) from (at_x, at_y), in fifths of a cell."""
    goal.told[9], goal.told[10] = x, y
    goal.numbers[24], goal.numbers[25] = at_x << 8, at_y << 8
    goal.numbers[44] = 0
    for _ in range(3000):
        if route.search(goal):
            return goal.told[13]
    assert False, "the search does not end"


def dijkstra(rows, start):
    """Distances from a cell, 5 and 7 a step, no diagonal past a closed corner."""
    rows = rows[::-1]
    size = len(rows)
    free = {(r, c) for r in range(1, size - 1) for c in range(1, size - 1) if rows[r][c] != "1"}
    far = {start: 0}
    edge = [start]
    while edge:
        edge.sort(key=lambda cell: -far[cell])
        r, c = edge.pop()
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                there = r + dr, c + dc
                if there in free and (not dr or not dc or (r + dr, c) in free and (r, c + dc) in free):
                    d = far[r, c] + (7 if dr and dc else 5)
                    if d < far.get(there, 9999):
                        far[there] = d
                        edge.append(there)
    return far


def test_the_search_finds_the_exact_lengths_on_random_grids():
    size = 14
    for seed in range(12):
        random = Random(seed)
        share = 20 + random.below(25)
        rows = ["".join("1" if random.below(100) < share else "0" for _ in range(size)) for _ in range(size)]
        rows[1] = "10" + rows[1][2:]
        goal = goal_of(rows)
        far = dijkstra(rows, (size - 2, 1))
        middle = CELL // 2
        search(goal, CELL + middle, (size - 2) * CELL + middle, CELL + middle, (size - 2) * CELL + middle)
        for r in range(1, size - 1):
            for c in range(1, size - 1):
                cell = goal.cells[r * size + c]
                if cell < 0x8000:
                    assert cell & 4095 == far.get((r, c), 4095), (seed, r, c)


def test_the_way_is_followed_and_a_walled_goal_has_none():
    rows = ["1111111", "1000001", "1011101", "1010101", "1011101", "1000001", "1111111"]
    goal = goal_of(rows)
    assert search(goal, 450, 450, 1650, 1650) == 40  # round the block: no diagonal past its corners
    assert search(goal, 1050, 1050, 450, 450) == -1


def test_points_found_close_cells_and_beams_open_them_again():
    rows = ["1" * 12] + ["1" + "0" * 10 + "1"] * 10 + ["1" * 12]
    goal = goal_of(rows)
    n = goal.numbers
    n[24], n[25] = 1650 << 8, 1650 << 8
    at = route.cell_at(n, 1650, 2250)
    for _ in range(3):
        goal.px[0], goal.py[0], n[7], n[61] = 1650, 2120, 1, 1
        goal.look()
    assert goal.cells[at] >= 0x8000 and n[47]  # closed, and a search is due
    n[47] = 0
    for _ in range(4):
        goal.px[0], goal.py[0], n[7], n[61] = 1650, 3300, 1, 1  # a beam through its middle, to the wall
        goal.look()
    assert goal.cells[at] < 0x8000 and n[47]


class Lidar:
    """A lidar in a room: frames of its points."""

    distances = array("H", bytes(160))
    bearings = array("H", bytes(160))
    n = 38

    def look(self, frame, x, y, heading, room):
        """room: left, bottom, right, top."""
        from math import cos, pi, sin

        for k in range(self.n):
            bearing = (frame * 225 + k * 225 / self.n) % 3600
            a = (bearing / 10 + heading) * pi / 180
            s, c = sin(a), cos(a)
            ways = [(room[2] - x) / s if s > 1e-6 else 1e9, (room[0] - x) / s if s < -1e-6 else 1e9]
            ways += [(room[3] - y) / c if c > 1e-6 else 1e9, (room[1] - y) / c if c < -1e-6 else 1e9]
            self.bearings[k] = int(bearing)
            self.distances[k] = int(min(ways) * 4)


class Odometry:
    x = y = heading = step_heading = now_us = 0


def test_the_pose_comes_back_to_where_the_walls_are():
    rows = ["1" * 14] + ["1" + "0" * 12 + "1"] * 9 + ["1" * 14]
    room = 300, 300, 13 * 300, 10 * 300
    for dx, dy, turn in ((40, -30, 1.5), (-60, 50, -2.0), (0, 0, 0)):
        goal = goal_of(rows)
        n = goal.numbers
        goal.told[3] = 2
        x, y, heading = 1700, 1500, 25.0
        n[24], n[25], n[26] = (x + dx) << 8, (y + dy) << 8, int((heading + turn) * 1000)
        lidar = Lidar()
        for _ in range(2):
            for frame in range(16):
                lidar.look(frame, x, y, heading, room)
                pose.advance(goal, lidar, Odometry)
            while pose.match(goal):
                pass
            pose.again(n)
        assert abs((n[24] >> 8) - x) <= 6 and abs((n[25] >> 8) - y) <= 6, (n[24] >> 8, n[25] >> 8)
        assert abs(n[26] - heading * 1000) < 400
        assert goal.told[8] > 90 and goal.told[7] < 30  # it fits, and says so


def test_a_pose_that_does_not_fit_is_said_to_be_lost():
    rows = ["1" * 14] + ["1" + "0" * 12 + "1"] * 9 + ["1" * 14]
    goal = goal_of(rows)
    goal.told[3] = 2
    goal.numbers[24], goal.numbers[25] = 1700 << 8, 1500 << 8
    lidar = Lidar()
    random = Random(5)
    for _ in range(13):
        for frame in range(16):
            lidar.look(frame, 1700, 1500, 0, (300, 300, 3900, 3000))
            for k in range(lidar.n):
                lidar.distances[k] = 1200 + random.below(4500)  # no walls anywhere: foliage
            pose.advance(goal, lidar, Odometry)
        while pose.match(goal):
            pass
        pose.again(goal.numbers)
    assert goal.told[3] == 3


class Points:
    def __init__(self, places):
        self.x = array("H", [8 * x & 0xFFFF for x, _ in places])
        self.y = array("H", [8 * y & 0xFFFF for _, y in places])
        self.count = len(places)


def test_a_door_is_measured_and_shuts_and_opens():
    rows = ["1" * 12] + ["1" + "0" * 4 + "1" + "0" * 5 + "1"] * 3 + ["10000x000001"] * 3 + ["1" + "0" * 4 + "1" + "0" * 5 + "1"] * 3 + ["1" * 12]
    goal = goal_of(rows, ((1650, 1650, 900, 900),))
    n = goal.numbers
    n[24], n[25] = 1000 << 8, 1650 << 8
    odometry = Odometry()
    odometry.x, odometry.y = 1000 << 8, 1650 << 8
    half = Points([(1500, y) for y in range(1200, 1501, 20)])

    def measure(points):
        while True:
            done = route.measure(goal, 0, odometry, points)
            if done:
                return done

    assert measure(half) == 1
    assert abs(goal.told[16] - 600) <= 20 and abs(goal.told[17] + 150) <= 15  # to the left, along +x: the upper part is open
    shut = Points([(1500, y) for y in range(1200, 2101, 20)])
    assert [measure(shut) for _ in range(3)] == [1, 1, 2]
    assert search(goal, 2500, 1650, 1000, 1650) == -1
    assert [measure(half) for _ in range(3)] == [1, 1, 2]
    assert search(goal, 2500, 1650, 1000, 1650) > 0


def refusal(data):
    with open("map.bin", "wb") as file:
        file.write(data)
    try:
        load()
    except ValueError as error:
        return str(error)
    return None


def test_damaged_maps_are_refused_and_say_why():
    good = house(["1111", "1001", "1001", "1111"])
    assert refusal(good) is None
    assert "is no map" in refusal(b"")
    assert "is no map" in refusal(b"PNG" + good)
    assert "bytes" in refusal(good[:-5])
    assert "bytes" in refusal(good + b"\0")
    assert "damaged" in refusal(good[:40] + bytes([good[40] ^ 1]) + good[41:])
    other = bytearray(good)
    other[4] = 2
    assert "version 2" in refusal(bytes(other))
    large = house(["1" * 41] * 41)
    assert "41 x 41 cells" in refusal(large)


def test_a_slice_of_the_steady_state_allocates_nothing():
    import gc

    import micropython

    rows = ["1" * 14] + ["1" + "0" * 12 + "1"] * 9 + ["1" * 14]
    goal = goal_of(rows)
    n = goal.numbers
    n[24], n[25] = 1700 << 8, 1500 << 8
    goal.told[3] = 2
    lidar = Lidar()
    lidar.look(0, 1700, 1500, 0, (300, 300, 3900, 3000))
    odometry = Odometry()
    gc.collect()
    for locked in (False, True):
        goal.told[9], goal.told[10], n[44] = 3000, 2500, 0
        if locked:
            micropython.heap_lock()
        try:
            for _ in range(16):
                pose.advance(goal, lidar, odometry)
            pose.match(goal)
            for _ in range(200):
                if route.search(goal):
                    break
            n[61] = n[7]
            while n[61]:
                goal.look()
            pose.again(n)
        finally:
            if locked:
                micropython.heap_unlock()
