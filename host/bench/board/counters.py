"""The counters of the firmware's blocks (see host/bench/blocks.py)."""

from array import array

COUNTERS = array("i", bytes(4 * 8192))
