"""`python -m host.twin`: see `host.twin.cli`."""

import sys

try:
    import numpy  # noqa: F401
except ImportError:
    sys.exit("numpy is not installed for this Python; run `make setup` and use .venv/bin/python")

from .cli import main

sys.exit(main())
