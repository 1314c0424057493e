"""How fast a steering may be driven."""

from perception.windows import RED
from planner.plan import STANDING


def choose_speed(plan, soft, near, urgent, config):
    """V of a plan, 0..180 with 90 standing.

    soft: mm until the steering gets narrow, if less than `near` it goes slower; urgent: the most urgent window that has a point.
    """
    way = min(plan.free, plan.limit)
    if way <= 0:
        return STANDING
    cruise = config.drive_cruise - STANDING
    # Stop within the free way: it takes about speed / 10 mm.
    v = min((60 + way * 3) * 90 // config.motors_full_speed, cruise)
    if soft < near:
        v = min(v, cruise * 4 // 5)
    if 0 < urgent <= RED:
        v = min(v, cruise // 2)
    v = max(v, 4)
    return STANDING - v if plan.mirroring & 2 else STANDING + v
