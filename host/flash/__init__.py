"""Puts MicroPython and the firmware on an ESP32: `python -m host.flash`.

ports     which serial port
image     the stock MicroPython image, with its hash
tools     runs esptool and mpremote, and says what to do when they fail
chip      what kind of ESP32 it is, and which pins it needs for itself
rom       the chip's ROM loader: erase, write, read
board     the board's MicroPython: what is on it, copy, compare
keep      what survives: robot.json, the network key
rescue    robot.json out of a board that does not answer
hello     restart, and wait for the firmware's first words
flow      the steps in their order
"""
