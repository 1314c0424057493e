"""What the faults are called, by number. For the tests and the laptop: the robot does not load this module, as a public name costs it memory; safety.py
has the numbers as constants of its own, and the texts stand in link/reason_texts.py.

Latched: it stands until a person starts it again. The others pass by themselves, half a second after their cause.
"""

NONE = 0
STOP_BUTTON = 1  # while its contact is open or closed the wrong way; that it stopped stays, as the state
LIDAR = 2
CHIPS = 3
BATTERY = 4
SETTLING = 5
SLOW = 6  # two turns of the loop in a row took more than 100 ms, with the motors on
MEMORY = 7
CHIPS_AGAIN = 8  # latched: three times in a minute
FAILED = 9  # latched: an exception in lidar, drive, planner or safety
HUNG = 10  # latched: the watchdog has reset the board
LIMITS = 11  # latched: the wheels' limits leave no steering
SCAN = 12
NOTHING_MOVES = 13
TURNS_WRONG = 14
TOO_SLOW = 15

LATCHED = (MEMORY, CHIPS_AGAIN, FAILED, HUNG, LIMITS)
