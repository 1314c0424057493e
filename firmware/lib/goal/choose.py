"""Loads the method that is chosen, and lets go of the one before."""

from core.unload import unload


def choose(goal, number):
    """Give the Goal its method: 0 gap, 1 field, 2 behaviour. The robot is to stand: a module is loaded."""
    if goal.method is not None:
        goal.method.end()
        goal.method = None
        unload("goal.gap", "goal.field", "goal.behaviour", "goal.reactive")
    if number == 0:
        from goal.gap import Gap as method
    elif number == 1:
        from goal.field import Field as method
    else:
        from goal.behaviour import Behaviour as method
    goal.method = method(goal.avoid)
    goal.avoid.configure()
    goal.told[2] = number
