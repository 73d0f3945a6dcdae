"""Functions as parts of others: what is compiled of them, for what, and what is kept."""

import os
import subprocess
import sys

import numpy as np
import pytest
from numba.core import config

from sebody.compiler.decorators import compiled


@pytest.fixture(autouse=True)
def nothing_compiled(tmp_path, monkeypatch):
    """Callers that were compiled in an earlier run of the tests would be read, not compiled."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))


@compiled
def doubled(x):
    return 2 * x


@compiled
def with_one(x):
    return doubled(x) + 1


@compiled
def chosen(x, negative):
    return -x if negative else x


@compiled
def both(x):
    return chosen(x, True), chosen(x, False)


@compiled
def filled(out, row, k):
    out[k] = row[k] + out[1] * k
    return out[k]


@compiled
def all_filled(out, row):
    total = 0.0
    for k in range(out.size):
        total += filled(out, row, k)
    return total


def test_a_callee_has_machine_code_only_where_python_calls_it():
    assert with_one(3) == 7
    assert len(doubled.callee.overloads) == 1 and not doubled.overloads
    assert doubled(4) == 8
    assert len(doubled.overloads) == 1
    assert with_one(3.5) == 8.0
    assert len(doubled.callee.overloads) == 2 and len(doubled.overloads) == 1


def test_one_callee_serves_all_constants():
    assert both(3.0) == (-3.0, 3.0)
    assert len(chosen.callee.overloads) == 1


def test_operations_are_looked_up_for_every_type():
    """Sums and elements of whole numbers and of floats, one after the other, in one process."""
    for kinds in ((int, int), (float, int), (int, float), (float, float)):
        out, row = (np.array([4, 5, 6], dtype=kind) for kind in kinds)
        expected, other = out.copy(), row.copy()
        total = sum(filled.py_func(expected, other, k) for k in range(3))
        assert all_filled(out, row) == total
        assert out.tolist() == expected.tolist()
    assert len(filled.callee.overloads) == 4


PROGRAM = """
import sys
from sebody.compiler.decorators import compiled

@compiled
def half(x):
    if x < 0.0:
        raise ValueError("negative")
    return 0.5 * x

@compiled
def quarter(x):
    return half(half(x))

@compiled
def whole(x):
    return half(x) + half(x)

function = {"quarter": quarter, "whole": whole}[sys.argv[1]]
print(function(6.0), sum(half.callee.stats.cache_hits.values()))
try:
    function(-1.0)
except ValueError as error:
    print(error)
"""


def test_what_another_process_has_kept_serves_other_callers(tmp_path):
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    said = [subprocess.run([sys.executable, program, name], text=True, capture_output=True,
                           env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}, check=True).stdout
            for name in ("quarter", "whole", "whole")]
    assert said == ["1.5 0\nnegative\n", "6.0 1\nnegative\n", "6.0 0\nnegative\n"]
