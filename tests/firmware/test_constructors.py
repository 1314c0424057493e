"""constructors.py: what only the start needs is let go."""

import sys

from core.constructors import drop


class Part:
    def __init__(self):
        self.value = 1


class Plain:
    value = 2


class Robot:
    def __init__(self):
        self.parts = [Part(), (Plain(), None)]
        self.itself = self


class Other:
    def __init__(self):
        self.value = 3


def test_what_the_robot_is_made_of_cannot_be_made_again_on_the_board():
    robot = Robot()
    drop(robot)
    for kind in (Robot, Part):
        try:
            kind()
            made = True
        except TypeError:
            made = False
        assert made == (sys.implementation.name != "micropython")
    assert robot.parts[0].value == 1 and Plain().value == 2 and Other().value == 3
