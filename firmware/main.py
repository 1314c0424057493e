"""The robot: built from robot.json, run for as long as there is power, and switched off whatever ends it."""

import sys
from time import sleep_ms

sys.path.append("/lib")


def start():
    """The Robot, or None where a person has asked for the prompt, if only by holding the stop button. What only the start needs goes with this
    function's frame."""
    from safety import first

    held = first.stop()  # whatever a former life left turning
    note = first.load()
    if held:
        print("gapseeker: its stop button is held: the prompt; let go and reset the board to start the robot")
    if held or note == first.PROMPT:
        return None
    from core.start import build

    return build(note)


robot = start()
del start

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
