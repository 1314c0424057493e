"""The robot: built from robot.json, run for as long as there is power, and switched off whatever ends it."""

import sys
from time import sleep_ms

sys.path.append("/lib")

from core.start import build

robot = build()
del build  # with it goes the code that only the start needs

try:
    while True:
        if not robot.step():
            sleep_ms(1)
finally:
    robot.off()
