"""How long the firmware takes: measured here, modelled for the ESP32 from the instructions it executes.

    python -m host.bench [--quick] [--json]

`scans`     lidar bytes of runs of the twin over the courses, kept as tapes
`blocks`    the firmware's sources cut into basic blocks, each with a counter
`machine_code`, `costs`   what a block costs on the ESP32, in instructions
`board/`    what runs under MicroPython: plays the tapes to the firmware and writes down what each stage took
`baselines/`    what the firmware is compared with, in plain MicroPython
`measure`   puts these together; `stages` turns what was written down into the figures of a stage
"""
