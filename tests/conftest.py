"""One thread for linear algebra: matrices of tests are small, and every core runs tests already."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
