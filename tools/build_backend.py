"""Builds nothing: the firmware goes on a board and the tools run from the checkout. Only the editable install of `make setup` is let through."""

from setuptools.build_meta import build_editable, get_requires_for_build_editable, prepare_metadata_for_build_editable

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
]

_REFUSAL = "gapseeker is used from its checkout and has nothing to install: run `make setup` in it, then `make demo`"


def get_requires_for_build_wheel(config_settings=None):
    raise SystemExit(_REFUSAL)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    raise SystemExit(_REFUSAL)


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit(_REFUSAL)
