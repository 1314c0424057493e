"""The laptop side of the robot: twin, monitor, recording, flashing, measuring."""
