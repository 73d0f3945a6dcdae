"""A trial of the fast way to compile: ``python -m sebody.compiler.inside.trial``.

It ends with an error if a version of Numba changed what is used of it. A kernel and a function with
a callee are compiled, and compared with what Python makes of them; then they are read from files.
"""

import ctypes
import math
from uuid import uuid4

import numpy as np
from numba import types

from sebody.compiler.inside import entry

_FLOATS = types.CPointer(types.float64)
_SIGNATURE = types.int64(types.int64, _FLOATS, _FLOATS)
_OPTIONS = {"error_model": "numpy"}
_MADE_FROM = uuid4().hex        # nothing of an earlier trial is found


def _scaled(x, k):
    return (x + 1, k * math.sqrt(x)) if x > k else (x, 0.5)


def _summed(values, out):
    total = 0.0
    for i in range(values.size):
        a, b = _scaled(values[i], 2)
        out[i] = a / b
        total += out[i]
    return total


def _kernel(count, x, y):
    total = 0.0
    for i in range(count):
        if x[i] < 0.0:
            return 1
        total += x[i] * x[i]
        y[i] = total - math.sin(x[i])
    return 0


def main() -> None:
    """Compile, compare, and once more from what is kept."""
    values, out = np.linspace(0.5, 4.0, 7), np.zeros(7)
    expected, sums = _summed(values, out), out.copy()
    _kernel(7, values, out)
    of_kernel, python = out.copy(), _scaled
    for kept in (False, True):
        globals()["_scaled"] = entry.function(python, _OPTIONS, _MADE_FROM)
        summed = entry.function(_summed, _OPTIONS, _MADE_FROM)
        assert entry.is_compiled(summed) is kept, "compiled code is not kept"
        total = summed(values, out)
        np.testing.assert_allclose([total, *out], [expected, *sums], rtol=1e-12)
        kernel = entry.kernel(_kernel, _SIGNATURE, _OPTIONS, _MADE_FROM)
        status = kernel.ctypes(7, *(a.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
                                    for a in (values, out)))
        assert status == 0, "a kernel fails"
        np.testing.assert_allclose(out, of_kernel, rtol=1e-12)
        assert sum(summed.stats.cache_hits.values()) == kept, "compiled code is not found"


if __name__ == "__main__":
    main()
