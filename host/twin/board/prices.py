"""What the firmware's methods take on the ESP32, in instructions. Written by `python -m host.bench --calibrate --write`; see charge.py."""

IMPORT = 20_000
IMPORT_BYTE = 3_000
FILE_BYTE = 200  # of a file that is read as it is
COLLECT = 1_000_000
# {method: (a call, each of the first kind of work in 16ths, each of the second)}
OF = {}
