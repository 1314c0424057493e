"""The live parameters that count from the next start: the planner's tables are made for them, and new ones would take seconds, in which the robot stands."""

NEXT_START = ("avoid.margin", "avoid.soft_margin", "windows.look_ahead")
