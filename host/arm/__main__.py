"""python -m host.arm"""

import os
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are small: a second thread only costs time

from .cli import main

if __name__ == "__main__":
    sys.exit(main())
