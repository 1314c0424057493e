"""The course house: the robot on an errand, through the whole firmware."""

import pytest

from host.twin import house
from host.twin.cli import main
from host.twin.run import run


def test_a_shut_door_is_an_alarm_before_it_and_nothing_is_touched():
    result = run("house", seed=1, changes={"drive.cruise": 108}, house=house.Plan(door="shut"), record=False)
    facts = result.summary()
    assert (facts["result"], facts["alarm"], facts["contacts"]) == ("alarm", "door shut", 0)
    assert facts["alarm_at_s"] < 60 and facts["goal_error_mm"] > 2000
    assert facts["pose_rms_mm"] < 30 and facts["pose_max_mm"] < 60


def test_the_start_is_as_far_off_as_is_said_and_the_walls_too():
    for seed in range(1, 8):
        built = house.build(house.Plan(), seed)
        x, y, _ = built.course.start
        assert ((x - built.told[0]) ** 2 + (y - built.told[1]) ** 2) ** 0.5 <= house.START_OFF
    exact, moved = (house.build(house.Plan(), seed).course.segments[:12] for seed in (0, 3))
    assert 5 < abs(exact - moved).max() <= house.WALLS_OFF


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["Z", "--walled"], "--walled is for the course house"),
        (["house", "--boxes", "99"], "0 to 40 are accepted"),
        (["house", "--map", "none.json"], "cannot be read"),
        (["house", "--goal", "4650,1000"], "lies in a wall"),
    ],
)
def test_what_cannot_be_is_refused(words, said, capsys):
    assert main([*words, "--json", "--no-record"]) == 2
    assert said in capsys.readouterr().err
