"""Runs a recording through the firmware again: `python -m host.replay FILE`.

tape      the recorded lidar and inputs in place of the world
rerun     the firmware's own code against the tape, in lockstep
compare   what was decided and written then and now
"""
