"""The project's version: that of the firmware in this checkout, which the robot's hello tells too."""

from argparse import ArgumentParser

from core.version import VERSION

__all__ = ["VERSION", "add_version"]


def add_version(parser: ArgumentParser) -> None:
    """Give a tool its --version."""
    parser.add_argument("--version", action="version", version=f"gapseeker {VERSION}")
