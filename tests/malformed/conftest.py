"""No case takes long, whatever it is given."""

import time

import pytest

LONGEST = 10.0      # seconds of this process: what others compile for it does not count


@pytest.fixture(autouse=True)
def ends_soon():
    """Refuse cases that nearly hang."""
    began = time.process_time()
    yield
    assert time.process_time() - began < LONGEST
