"""The windows that the robot tells go with the points that it tells, whatever order its checks have put these in."""

import numpy as np

from host.link.playback import story
from host.recording import Reader
from host.twin import run

HALF_WIDTH, HALF_LENGTH = 125, 300
GREEN, RED, BLUE, YELLOW = 1, 2, 3, 4


def windows(x, y):
    """As paper A has them, for the sizes in robot.json."""
    across, along = np.abs(x) - HALF_WIDTH, np.abs(y) - HALF_LENGTH
    gap = np.maximum(across, along)
    beyond = np.where((across < 300) & (along < 900), YELLOW, 0)
    return np.where(gap >= 45, beyond, np.where(gap <= 0, GREEN, np.where(gap < 20, RED, BLUE)))


def test_each_point_has_its_own_window(tmp_path):
    path = tmp_path / "run.rec"
    run("Z", 450, seed=2, limit_s=12, record=path)
    told = [message for _, message in story(Reader(path)) if message["type"] == "points"]
    assert len(told) > 10
    for message in told:
        assert message["window"] == windows(np.array(message["x"]), np.array(message["y"])).tolist()
    assert len({window for message in told for window in message["window"]}) >= 3
