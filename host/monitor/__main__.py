"""`python -m host.monitor`: see `host.monitor.cli`."""

import sys

from .cli import main

sys.exit(main())
