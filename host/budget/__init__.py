"""What the firmware takes of the ESP32's memory, and whether it fits: `python -m host.budget`.

trace         runs the firmware on a MicroPython with the board's words and stub devices (board/); the trace of its start
chip_memory   the model of the chip's memory, which a trace is played against
rooms         what each package takes: arrays, code, names, machine code
peak          the most it needs while everything is asked of it at once
targets       what is to be reached, and what is kept free for later
report        all figures of a robot.json, measured
"""
