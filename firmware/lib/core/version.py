"""Version of the firmware, as the hello tells it."""

VERSION = "0.1.0"
