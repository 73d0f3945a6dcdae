"""Whole runs with both ways of compiling: twenty seconds of compilation for the plain one.

Skipped unless ``SEBODY_PLAIN=1``: continuous integration runs it so, see ``.ci/plain``.
"""

import os

import pytest
from plain_numbers import FUNCTIONS, compared

from sebody.compiler.choice import VARIABLE

pytestmark = pytest.mark.skipif(os.environ.get(VARIABLE) != "1", reason=f"{VARIABLE} is not 1")
# rounding of kernels' numbers, 1e-15 of them, in 40 steps whose residuals are solved to 1e-6 or so
SAME = 1e-10


def test_runs_are_those_of_the_fast_way(tmp_path):
    """Of two scenes with flexible bodies and a rigid one, and of a model with Python functions."""
    differences, _ = compared(tmp_path, "planar-hinged-beam", "heavy-top", FUNCTIONS)
    assert len(differences) == 4
    assert max(differences.values()) < SAME
