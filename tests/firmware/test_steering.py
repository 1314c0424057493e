"""steering.py against the exact geometry, and against what the papers print."""

from math import atan2, cos, degrees, radians, sin, sqrt, tan

from core.axles import lay_out
from steering import Steering, mode_of

SPACINGS = (115, 150, 117, 115)
TRACK = 230
ROBOTS = (
    ((115, 150, 117, 115), 230),
    ((300,), 200),
    ((60,), 230),
    ((200, 100), 150),
    ((100, 110, 120, 130, 140, 150, 160), 400),
)

ADVERSE, FIRST_STRAIGHT, LAST_STRAIGHT, SPIN, LATERAL, SAME_PHASE, STRAIGHT = range(1, 8)


def _wheels(spacings, track):
    """(x, y) of every wheel, origin midway between first and last axle."""
    y = sum(spacings) / 2
    places = [(-track / 2, y), (track / 2, y)]
    for spacing in spacings:
        y -= spacing
        places += [(-track / 2, y), (track / 2, y)]
    return places


def _exact(spacings, track, af, ar):
    """[(direction in degrees, speed share)] of every wheel, and (vx, vy, w S/2) of the body, the fastest wheel at 1."""
    span = sum(spacings)
    f, r = radians(af / 10), radians(ar / 10)
    if abs(af) == 900 and ar == -af:
        twist = (0, 0, 2 / span * (1 if af > 0 else -1))
    elif abs(af) == 900 and ar == af:
        twist = (1 if af > 0 else -1, 0, 0)
    else:
        twist = (sin(f + r) / 2, cos(f) * cos(r), sin(f - r) / span)
    vx, vy, w = twist
    velocities = [(vx + w * y, vy - w * x) for x, y in _wheels(spacings, track)]
    speeds = [sqrt(x * x + y * y) for x, y in velocities]
    fastest = max(speeds)
    wheels = [(degrees(atan2(v[0], v[1])), speed / fastest) for v, speed in zip(velocities, speeds)]
    return wheels, (vx / fastest, vy / fastest, w * span / 2 / fastest)


def _steering(spacings, track, first=None):
    return Steering(lay_out(spacings, track, first))


def _compare(steering, af, ar, spacings=SPACINGS, track=TRACK):
    assert steering.solve(af, ar)
    wheels, twist = _exact(spacings, track, af, ar)
    for k, (direction, share) in enumerate(wheels):
        case = (af, ar, k, direction, share, steering.angles[k], steering.shares[k])
        angle = steering.angles[k] / 10
        folded = (steering.folded >> k) & 1
        assert -90 <= angle <= 90, case
        assert (steering.shares[k] < 0) == bool(folded) or steering.shares[k] == 0, case
        assert abs(abs(steering.shares[k]) / 16384 - share) < 0.0005, case
        if share > 0.001:
            error = (angle + 180 * folded - direction + 180) % 360 - 180
            assert abs(error) < 0.1, case
    for value, exact in zip((steering.vx, steering.vy, steering.w), twist):
        assert abs(value / 16384 - exact) < 0.0005, (af, ar, twist, steering.vx, steering.vy, steering.w)


def test_all_steerings_of_robots_with_2_3_5_and_8_axles():
    for spacings, track in ROBOTS:
        steering = _steering(spacings, track)
        for af in range(-900, 901, 60):
            for ar in range(-900, 901, 60):
                _compare(steering, af, ar, spacings, track)


def test_odd_angles():
    steering = _steering(SPACINGS, TRACK)
    seed = 5
    for _ in range(1500):
        seed = (seed * 1103515245 + 12345) & 0x7FFFFFFF
        _compare(steering, (seed >> 8) % 1801 - 900, (seed >> 19) % 1801 - 900)


def test_next_to_the_angles_where_the_general_form_vanishes():
    for spacings, track in ROBOTS:
        steering = _steering(spacings, track)
        for af in (-900, -899, -898, 898, 899, 900):
            for ar in (-900, -899, -898, 898, 899, 900):
                _compare(steering, af, ar, spacings, track)


def test_angles_that_paper_a_gives_for_60_and_65_degrees():
    steering = _steering(SPACINGS, TRACK)
    steering.solve(600, -600)
    assert list(steering.angles[:2]) == [439, 835]  # 43.87, 83.46
    steering.solve(650, -650)
    assert list(steering.angles[:2]) == [471, 898]  # 47.11, 89.80


def test_straight_on():
    steering = _steering(SPACINGS, TRACK)
    assert list(steering.angles) == [0] * 10 and list(steering.shares) == [16384] * 10
    assert (steering.vx, steering.vy, steering.w, steering.folded, mode_of(steering.af, steering.ar)) == (0, 16384, 0, 0, STRAIGHT)


def test_sideways_every_wheel_turns_at_full_speed():
    steering = _steering(SPACINGS, TRACK)
    for angle in (900, -900):
        steering.solve(angle, angle)
        assert list(steering.angles) == [angle] * 10 and list(steering.shares) == [16384] * 10
        assert (steering.vx, steering.vy, steering.w) == (16384 if angle > 0 else -16384, 0, 0)


def test_crab_keeps_all_wheels_parallel():
    steering = _steering(SPACINGS, TRACK)
    for angle in (-800, -355, 1, 450, 899):
        steering.solve(angle, angle)
        assert list(steering.angles) == [angle] * 10 and list(steering.shares) == [16384] * 10


def test_spin_turns_clockwise_with_af_right_and_back_with_af_left():
    steering = _steering(SPACINGS, TRACK)
    steering.solve(900, -900)
    assert (steering.vx, steering.vy) == (0, 0) and steering.w > 0
    for k, (x, y) in enumerate(_wheels(SPACINGS, TRACK)):
        # clockwise: a wheel at (x, y) moves along (y, -x)
        sign = 1 if steering.shares[k] > 0 else -1
        angle = radians(steering.angles[k] / 10)
        along = sign * (sin(angle) * y - cos(angle) * x) / sqrt(x * x + y * y)
        assert along > 0.9999, (k, along)
    assert [share > 0 for share in steering.shares] == [True, False] * 5
    angles, shares = list(steering.angles), list(steering.shares)
    steering.solve(-900, 900)
    assert steering.w < 0
    assert list(steering.angles) == angles and [-share for share in steering.shares] == shares


def test_all_wheel_normals_meet_in_the_turning_centre():
    steering = _steering(SPACINGS, TRACK)
    span = sum(SPACINGS)
    for af, ar in ((300, -200), (-380, 120), (600, -600), (250, 0), (0, -333), (500, 100), (-100, -450), (700, -650)):
        steering.solve(af, ar)
        slope = tan(radians(af / 10)) - tan(radians(ar / 10))
        radius = span / slope
        behind = radius * tan(radians(af / 10))
        for k, (x, y) in enumerate(_wheels(SPACINGS, TRACK)):
            dx, dy = radius - x, span / 2 - behind - y
            distance = sqrt(dx * dx + dy * dy)
            angle = radians(steering.angles[k] / 10)
            # distance of the centre from the wheel's normal
            miss = abs(dx * sin(angle) + dy * cos(angle))
            assert miss <= distance * 0.0010, (af, ar, k, miss, distance)


def test_left_turns_are_right_turns_in_the_mirror():
    right, left = _steering(SPACINGS, TRACK), _steering(SPACINGS, TRACK)
    for af in range(-900, 901, 180):
        for ar in range(-900, 901, 100):
            right.solve(af, ar)
            left.solve(-af, -ar)
            assert [-angle for angle in left.angles] == [right.angles[k ^ 1] for k in range(10)], (af, ar)
            assert list(left.shares) == [right.shares[k ^ 1] for k in range(10)], (af, ar)
            assert (-left.vx, left.vy, -left.w) == (right.vx, right.vy, right.w), (af, ar)


def test_wheels_fold_from_a_turning_centre_inside_the_track():
    # |tan AF - tan AR| > 2 S / B = 4.32
    steering = _steering(SPACINGS, TRACK)
    for af in range(0, 900, 25):
        for ar in range(-875, 1, 25):
            slope = tan(radians(af / 10)) - tan(radians(ar / 10))
            if abs(slope - 2 * sum(SPACINGS) / TRACK) > 0.05:
                steering.solve(af, ar)
                assert bool(steering.folded) == (slope > 2 * sum(SPACINGS) / TRACK), (af, ar)


def test_no_wheel_folds_within_60_degrees():
    steering = _steering(SPACINGS, TRACK)
    for af in range(-600, 601, 50):
        for ar in range(-600, 601, 50):
            steering.solve(af, ar)
            assert steering.folded == 0


def test_modes_of_the_papers():
    steering = _steering(SPACINGS, TRACK)
    for af, ar, mode in (
        (300, -200, ADVERSE),
        (-10, 10, ADVERSE),
        (900, -899, ADVERSE),
        (0, 200, FIRST_STRAIGHT),
        (-300, 0, LAST_STRAIGHT),
        (900, -900, SPIN),
        (-900, 900, SPIN),
        (900, 900, LATERAL),
        (-900, -900, LATERAL),
        (300, 300, LATERAL),
        (300, 200, SAME_PHASE),
        (-300, -380, SAME_PHASE),
        (0, 0, STRAIGHT),
    ):
        steering.solve(af, ar)
        assert mode_of(steering.af, steering.ar) == mode, (af, ar, mode_of(steering.af, steering.ar))
        assert (steering.af, steering.ar) == (af, ar)


def test_angles_beyond_90_degrees_are_refused_and_change_nothing():
    steering = _steering(SPACINGS, TRACK)
    steering.solve(123, -45)
    angles = list(steering.angles)
    for af, ar in ((901, 0), (0, -901), (-2000, 2000)):
        assert steering.solve(af, ar) is False
        assert list(steering.angles) == angles and (steering.af, steering.ar) == (123, -45)


def test_centre_of_a_body_whose_axles_do_not_lie_about_it():
    # The axles' middle lies 100 mm ahead of the body's centre.
    middle, body = _steering(SPACINGS, TRACK), _steering(SPACINGS, TRACK, 348.5)
    for af, ar in ((400, -300), (900, -900), (0, 300)):
        middle.solve(af, ar)
        body.solve(af, ar)
        assert list(body.angles) == list(middle.angles) and body.vy == middle.vy and body.w == middle.w
        assert abs(body.vx - (middle.vx - middle.w * 100 / 248.5)) < 1.5


def test_impossible_robots_are_refused():
    for spacings, track, part in (
        ((), 230, "two axles"),
        ((100, 0), 230, "spacings"),
        ((100,) * 15, 230, "axles"),
        ((100,), 800, "track"),
        ((100,), 0, "track"),
    ):
        try:
            lay_out(spacings, track)
        except ValueError as error:
            assert part in str(error), error
        else:
            assert False, (spacings, track)
