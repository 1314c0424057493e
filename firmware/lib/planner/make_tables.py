"""Making the planner's tables, see tables.py. On the board loaded only where their file does not fit, then let go."""

from core.unload import unload


def make(config, part):
    """The arrays of a part of the file."""
    return _make_cost_to_go(config) if part else _make_candidates(config)


def _make_cost_to_go(config):
    from planner import footprint_masks

    cell = config.robot_length * 8 // 12  # of the grid, 1/8 mm
    made = [footprint_masks.masks(config.robot_width, config.robot_length, config.avoid_margin, cell)]
    footprint_masks = None
    unload("planner.footprint_masks")
    if config.mode == "AWS":
        from planner import primitives

        made.append(primitives.steps(config.robot_length, cell))
        made.append(primitives.rim(True))
    else:
        from planner import primitives, primitives_naws

        made.append(primitives_naws.ways(sum(config.axles_spacings), config.axles_first, cell))
        made.append(primitives.rim(False))
    primitives = primitives_naws = None
    unload("planner.primitives", "planner.primitives_naws")
    return made


def _make_candidates(config):
    from planner import candidate_tables

    made = candidate_tables.make(config)
    candidate_tables = None
    unload("planner.candidate_tables")
    return made
