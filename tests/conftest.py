"""One thread for linear algebra: matrices of tests are small, and every core runs tests already.

Processes that share the tests find the time loop compiled, and the kernels where all tests run:
cold, each process would compile them for itself. Kernels that whoever runs the tests has derived in
the home folder are not seen.
"""

import os
import signal

import pytest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["SEBODY_KERNELS"] = os.path.join(__file__, "none")   # none of whoever runs the tests


@pytest.fixture
def interruptible():
    """Ctrl-C interrupts, though a shell that starts tests in the background has it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def pytest_sessionstart(session):
    config = session.config
    if config.getoption("numprocesses", None):      # not in the processes themselves
        from sebody.catalogue import kernel_files
        from sebody.runs.first_run import PARTS, compile_missing

        compile_missing(kernel_files() if config.args == config.getini("testpaths") else (), PARTS)
