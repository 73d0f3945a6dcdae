"""One thread for linear algebra: matrices of tests are small, and every core runs tests already.

Processes that share the tests find the time loop compiled: cold, each would compile it for itself.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def pytest_sessionstart(session):
    if session.config.getoption("numprocesses", None):      # not in the processes themselves
        from sebody.analysis.first_run import PARTS, compile_missing

        compile_missing((), PARTS)
