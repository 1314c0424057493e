"""Fixtures of the tests that open the monitor's page."""

from open_page import browser, monitor  # noqa: F401
