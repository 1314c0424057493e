"""Makes the tables of core/trig.py, and is let go again. In small integers only: larger ones would litter the heap while the robot starts."""

from array import array

# sin of 0, 2 .. 90 deg * (2**30 - 1)
_WHOLE = (
    0, 37473049, 74900443, 112236583, 149435979, 186453311, 223243478, 259761657, 295963357, 331804471, 367241332, 402230767,
    436730145, 470697434, 504091252, 536870912, 568996477, 600428808, 631129608, 661061475, 690187940, 718473517, 745883745, 772385229,
    797945680, 822533957, 846120103, 868675382, 890172314, 910584709, 929887696, 948057758, 965072758, 980911965, 995556082, 1008987268,
    1021189158, 1032146886, 1041847102, 1050277988, 1057429272, 1063292241, 1067859753, 1071126242, 1073087728, 1073741823,
)  # fmt: skip
# sin of 0, 0.4 and 0.8 deg * 2**30, and 1 - cos of them * 2**36
_SIN = (0, 7496071, 14991777)
_ONE_LESS_COS = (0, 1674645, 6698499)


def tables():
    """(sines in steps of 0.4 deg, sines in steps of 2 deg) from 0 to 90 deg, as core/trig.py describes them.

    sin(a + b) = sin(a) - sin(a) (1 - cos(b)) + cos(a) sin(b), a in whole 2 degrees.
    """
    fine = array("H", bytes(2 * 227))
    for k in range(226):
        a = (k + 2) // 5
        b = k - 5 * a
        s = _WHOLE[a] - (_product(_WHOLE[a], _ONE_LESS_COS[abs(b)]) >> 6)
        t = _product(_WHOLE[45 - a], _SIN[abs(b)])
        fine[k] = min((s + t if b >= 0 else s - t) + 8192 >> 14, 65535)
    fine[226] = 65535  # read, but not used, where 90 deg are looked up
    return fine, array("i", _WHOLE)


def _product(a, b):
    """a * b / 2**30, at most 3 too little."""
    high = (a >> 15) * (b >> 15)
    return high + (((a >> 15) * (b & 0x7FFF) + (a & 0x7FFF) * (b >> 15)) >> 15)
