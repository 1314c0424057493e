"""The candidates of envelope.py and room for their tables, once at the start. What fills them: envelope_arcs.py, envelope_rings.py, envelope_strips.py."""

from array import array
from math import pi, tan

from micropython import const

_BINS = const(24)
_LENGTHS = const(5)
_STRIDE = const(13)
_SECONDS = const(15)  # bytes for each arc: enough for the usual body with any margin; for others it grows
_STRIP_STRIDE = const(8)


def prepare(env, config):
    """Every attribute of the Candidates that does not change while the robot runs, and the arrays."""
    env.half_width = config.robot_width // 2
    env.half_length = config.robot_length // 2
    env.wheelbase = sum(config.axles_spacings)
    env.first_axle = config.axles_first
    env.half_track = config.axles_track / 2
    # A last axle that stays straight is the first one of the mirror in which backward moves are tabulated.
    all_wheels = config.mode == "AWS"
    pairs = _pairs(env, all_wheels)
    strips = (0, 6, 12, 20, 32, 50, 70, 90) if all_wheels else (0,)
    env.arcs = len(pairs)
    env.ahead_end = env.arcs if all_wheels else env.arcs // 2
    env.astern_first = 0 if all_wheels else env.arcs // 2
    env.count = env.arcs + len(strips)
    env.af = array("h", [p[0] * 10 for p in pairs] + [a * 10 for a in strips])
    env.ar = array("h", [p[1] * 10 for p in pairs] + [a * 10 for a in strips])
    env.lengths = array("H", [0] * _LENGTHS)
    env.consts = array("i", bytes(4 * env.arcs * _STRIDE))
    env.table = bytearray(2 * env.arcs * _BINS * 2)  # 16-bit words for the viper functions
    env.seconds = array("H", bytes(_SECONDS * env.arcs))
    env.strips = array("i", bytes(4 * _STRIP_STRIDE * len(strips)))
    env.ends = array("H", bytes(2 * env.count * _LENGTHS * 2))
    env.turns = array("h", bytes(2 * env.count * _LENGTHS))


def _pairs(env, all_wheels):
    """(AF, AR) of the arcs, degrees."""
    if not all_wheels:
        angles = (3, 6, 9, 12, 15, 18, 21, 25, 29, 33, 37, 41, 45, 50, 55, 60)
        return [(front, 0) for front in angles] + [(0, -rear) for rear in angles]
    angles = (0, 6, 12, 20, 28, 37, 47, 60)
    pairs = []
    for i, front in enumerate(angles):
        for j, rear in enumerate(angles):
            if (i or j) and (j == 0 or -4 <= i - j <= 4) and _beside(env, front, -rear):
                pairs.append((front, -rear))
    pairs.extend(((25, 10), (45, 25), (45, 10), (-10, -25), (-25, -45), (-10, -45)))
    return pairs


def _beside(env, front, rear):
    """A centre under the body is left to spinning: its rings enter the outline on every side."""
    r = env.wheelbase / (tan(front * pi / 180) - tan(rear * pi / 180))
    return r > env.half_width + 16
