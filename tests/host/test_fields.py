"""Fields of cylinders: the generator, and a few of them driven. All 300: python -m host.experiments.fields."""

import numpy as np

from host.twin import best, fields, load_config, run
from host.twin.vehicle import Vehicle


def test_the_same_seed_gives_the_same_field_and_others_differ():
    assert np.array_equal(fields.cells(3), fields.cells(3))
    assert not np.array_equal(fields.cells(3), fields.cells(4))
    course = fields.field(3)
    assert len(course.boxes) == fields.cells(3).sum() > 20
    centres = course.boxes.mean(axis=1)
    assert np.allclose(np.hypot(*(course.boxes - centres[:, None]).T).T, fields.RADIUS * fields.SCALE)
    assert np.allclose(centres[:, 0] / (fields.CELL * fields.SCALE) % 1, 0.5)  # on the grid


def test_a_field_that_can_be_passed_is(tmp_path, seed=1):
    course = fields.field(seed)
    vehicle = Vehicle.from_settings(load_config())
    assert np.isfinite(best.best(course, vehicle, tmp_path).from_pose(*course.start, best.outer_wheels(vehicle)))
    result = run(course, seed=seed + 1, record=False)
    assert (result.result, result.contacts) == ("pass", 0)
