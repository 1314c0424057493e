"""trig.py against the floating point functions."""

from array import array
from math import atan2, cos, degrees, radians, sin, sqrt

from trig import SIN, cos14, isqrt, polar, sin14


def _numbers(count, seed=1):
    for _ in range(count):
        seed = (seed * 1103515245 + 12345) & 0x7FFFFFFF
        yield seed >> 8


def test_table_is_exact_to_its_last_bit():
    assert len(SIN) == 901 and SIN[0] == 0 and SIN[900] == 2**30 - 1
    for k in range(901):
        assert abs(SIN[k] - sin(radians(k / 10)) * (2**30 - 1)) < 0.5001, k


def test_sine_and_cosine_of_any_angle():
    for a in range(-4000, 7600, 7):
        assert abs(sin14(a) - 16384 * sin(radians(a / 10))) <= 0.5, a
        assert abs(cos14(a) - 16384 * cos(radians(a / 10))) <= 0.5, a


def test_sine_and_cosine_at_the_quadrants():
    assert [sin14(a) for a in (0, 900, 1800, 2700, 3600)] == [0, 16384, 0, -16384, 0]
    assert [cos14(a) for a in (0, 900, 1800, 2700, 3600)] == [16384, 0, -16384, 0, 16384]
    assert sin14(-900) == -16384 and cos14(-1800) == -16384
    assert sin14(3600 * 100000 + 300) == 8192 and cos14(-3600 * 100000 + 600) == 8192


def test_polar_of_the_axes_and_the_origin():
    out = array("i", (7, 7))
    for x, y, radius, angle in ((0, 5, 5, 0), (5, 0, 5, 900), (0, -5, 5, 1800), (-5, 0, 5, 2700), (0, 0, 0, 0), (3, 4, 5, 369), (-7, 7, 10, 3150)):
        polar(x, y, out)
        assert (out[0], out[1]) == (radius, angle), (x, y, out)


def test_polar_of_short_and_long_vectors():
    out = array("i", (0, 0))
    numbers = _numbers(3 * 1300)
    for x in numbers:
        y = next(numbers)
        scale = 1 << (next(numbers) % 29)  # up to 2**28
        x = x % (2 * scale + 1) - scale
        y = y % (2 * scale + 1) - scale
        polar(x, y, out)
        radius = sqrt(x * x + y * y)
        assert abs(out[0] - radius) <= 1 + radius / 2**20, (x, y, out)
        if x or y:
            error = (out[1] - 10 * degrees(atan2(x, y)) + 1800) % 3600 - 1800
            assert abs(error) < 0.53 and 0 <= out[1] < 3600, (x, y, out)


def test_polar_of_the_largest_vector_it_takes():
    out = array("i", (0, 0))
    for x in (-(2**28), 2**28):
        for y in (-(2**28), 2**28):
            polar(x, y, out)
            assert abs(out[0] - 2**28 * sqrt(2)) < 400
            assert out[1] == {(1, 1): 450, (1, -1): 1350, (-1, -1): 2250, (-1, 1): 3150}[(1 if x > 0 else -1, 1 if y > 0 else -1)]


def test_mirrored_vectors_have_mirrored_directions():
    one, other = array("i", (0, 0)), array("i", (0, 0))
    numbers = _numbers(400)
    for x in numbers:
        y = next(numbers) - 4000000
        polar(x, y, one)
        polar(-x, y, other)
        assert one[0] == other[0] and (one[1] + other[1]) % 3600 == 0


def test_integer_square_root():
    for n in range(2000):
        assert isqrt(n) ** 2 <= n < (isqrt(n) + 1) ** 2
    for r in list(_numbers(500)) + [32767]:
        r %= 32768
        assert isqrt(r * r) == r
        if r:
            assert isqrt(r * r - 1) == r - 1
    assert isqrt(2**30 - 1) == 32767
