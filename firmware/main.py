"""The robot: built from robot.json, run for as long as there is power, and switched off whatever ends it."""

import sys
from time import sleep_ms

sys.path.append("/lib")

from safety import first

first.stop()  # whatever a former life left turning
note = first.load()
robot = None

if note != first.PROMPT:
    from core.start import build

    robot = build(note)
    del build  # with it goes the code that only the start needs
del first

try:
    while robot is not None:
        if not robot.step():
            sleep_ms(1)
except KeyboardInterrupt:
    import machine

    from safety.watchdog import prompt

    prompt(robot, machine)
finally:
    if robot is not None:
        robot.off()
