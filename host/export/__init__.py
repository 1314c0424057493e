"""Turns a recording into a file that other programs open: `python -m host.export FILE out.mcap` or `out.csv`.

frames     the robot's conventions -> those of the standard schemas
scans      recorded lidar bytes -> whole revolutions
timeline   everything else, as messages in order of time
shapes     what the robot says, in Foxglove's schemas
topics     the topics of an MCAP file
to_mcap    a recording as MCAP
to_csv     a recording as a table: one row per decision
"""


class ExportError(Exception):
    """The recording cannot be exported; the text says what to do."""
