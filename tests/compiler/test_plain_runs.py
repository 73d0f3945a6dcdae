"""Whole runs with both ways of compiling: twenty seconds of compilation for the plain one.

Skipped unless ``SEBODY_PLAIN=1``: continuous integration runs it so, see ``.ci/plain``.
"""

import os

import pytest
from plain_numbers import FUNCTIONS, compared
from readings import TABLE

from sebody.compiler.choice import VARIABLE

pytestmark = pytest.mark.skipif(os.environ.get(VARIABLE) != "1", reason=f"{VARIABLE} is not 1")
# rounding of kernels' numbers, 1e-15 of them, in 40 steps whose residuals are solved to 1e-6 or so
SAME = 1e-10


def test_runs_are_those_of_the_fast_way(tmp_path):
    """Of scenes with flexible bodies and a rigid one, of Python functions, and of the table."""
    models = [name for name, row in TABLE.items() if row.plain]
    differences, _ = compared(tmp_path, "planar-hinged-beam", "heavy-top", FUNCTIONS, *models)
    assert len(differences) == 4 + len(models)
    assert max(differences.values()) < SAME
